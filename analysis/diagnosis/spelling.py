"""Numbers and lists as words: the units a reader thinks in, and no digit that is not known."""

from collections.abc import Mapping, Sequence
from math import floor, log10

_UNITS: Mapping[str, tuple[float, str]] = {
    "m": (1e3, "mm"),
    "m/s": (1e3, "mm/s"),
    "m/N": (1e3, "mm/N"),
    "N/m2": (1e-6, "N/mm²"),
    "N/m3": (1e-9, "N/mm³"),
    "N s/m2": (1e-6, "N s/mm²"),
    "N s2/m2": (1.0, "N s²/m²"),
    "N/rad2": (1.0, "N/rad²"),
    "m2": (1.0, "m²"),
    "N m s2": (1.0, "N m s²"),
    "1": (1.0, ""),
    "rad": (180.0 / 3.141592653589793, "deg"),
}

_TIMES = frozenset({"weight_share", "forcing_share"})
"""Shares that are multiples of what the rig file says, not small parts of it."""


def scaled(name: str, value: float, unit: str) -> tuple[float, str]:
    """A factor and a unit that make a number of everyday size.

    Parameters
    ----------
    name
        Of the parameter: a share is told in percent.
    value, unit
        Of it; the unit as in a rig file.
    """
    if unit == "1" and name.endswith("_share") and name not in _TIMES:
        return 100.0, "%"
    if unit == "s":
        return (1.0, "s") if abs(value) >= 1.0 else (1e3, "ms")
    if unit == "kg":
        return (1.0, "kg") if abs(value) >= 1.0 else (1e3, "g")
    return _UNITS.get(unit, (1.0, unit))


def size_of(name: str, value: float, unit: str) -> str:
    """A size to two digits, such as "0.21 N"; parameters as for `scaled`."""
    factor, spelled = scaled(name, value, unit)
    return f"{factor * value:.2g} {spelled}".strip()


def number(name: str, value: float, sigma: float, unit: str) -> str:
    """A value with its uncertainty, such as "0.21 ± 0.02 N".

    Parameters
    ----------
    name
        Of the parameter.
    value, sigma, unit
        Of it; a sigma of 0 is not told.
    """
    factor, spelled = scaled(name, value, unit)
    value, sigma = factor * value, factor * sigma
    after = f" {spelled}" if spelled else ""
    if sigma <= 0.0:
        return f"{value:.3g}{after}"
    # Two digits of a sigma that starts with a 1, else one.
    lead = floor(log10(sigma))
    digits = -lead + (1 if sigma / 10.0**lead < 2.0 else 0)
    if digits >= 0:
        return f"{value:.{digits}f} ± {sigma:.{digits}f}{after}"
    return f"{round(value, digits):.0f} ± {round(sigma, digits):.0f}{after}"


def listed(items: Sequence[object], word: str = "and") -> str:
    """Items with commas and a last word: "1, 2 and 4"."""
    texts = [str(one) for one in items]
    if len(texts) < 2:
        return "".join(texts)
    return f"{', '.join(texts[:-1])} {word} {texts[-1]}"


def cables(numbers: Sequence[int], *, all_of: int = 8) -> str:
    """Cables in words: "cable 3", "cables 1 and 2", "all cables"."""
    if len(numbers) == all_of:
        return "all cables"
    if not numbers:
        return "the cables"
    return f"cable{'s' if len(numbers) > 1 else ''} {listed(numbers)}"


def odds(log_odds: float) -> str:
    """Odds against something, from their logarithm: "20 to 1", "more than a million to 1"."""
    if log_odds > 13.8:
        return "more than a million to 1"
    ratio = 2.718281828459045**log_odds
    return f"{float(f'{ratio:.2g}'):,.0f} to 1" if ratio >= 2.0 else "about even"


def percent(probability: float) -> str:
    """A probability that never reads as certainty: "97 %", "above 99 %", "below 1 %"."""
    if probability > 0.99:
        return "above 99 %"
    if probability < 0.01:
        return "below 1 %"
    return f"{100.0 * probability:.0f} %"


def sentence(text: str) -> str:
    """With a capital and a full stop."""
    text = text.strip()
    return text[:1].upper() + text[1:] + ("" if text.endswith((".", ":", "?")) else ".")
