"""What a simulated amplifier makes of its converter's digits before it sends them.

The order is ours, and so is what the coefficients of LIC multiply: the protocol note tells what the
commands are for (section 4), not how the electronics calculate.
"""

from collections.abc import Mapping

from rig.amplifier.frame import DIGITS_PER_MV_PER_V
from rig.simulated.registers import LINEARISATION

FACTORY_SPAN = 2 * DIGITS_PER_MV_PER_V[4]
"""24-bit digits at 2 mV/V and the factory curve; 1 000 000 in the numbers of LDW, LWT and LIC."""

MILLION = 1_000_000

_AS_FROM_THE_FACTORY = {"LDW": 0, "LWT": MILLION, **LINEARISATION}.items()


def converted(digits: int, settings: Mapping[str, int]) -> int:
    """Digits as sent.

    Parameters
    ----------
    digits
        24 bit, at the factory curve.
    settings
        LIC, LDW and LWT, TAS and TAV, NOV and RSN.

    Returns
    -------
    int
        24 bit at NOV=0, else in parts of NOV.
    """
    if not settings.items() >= _AS_FROM_THE_FACTORY:
        zero, span = settings["LDW"], settings["LWT"]
        part = digits / FACTORY_SPAN
        part = sum(settings[f"LIC{power}"] * part**power for power in range(4))
        digits = round(FACTORY_SPAN * (part - zero) / (span - zero))
    if settings["TAS"] == 0:
        digits -= settings["TAV"]
    if settings["NOV"]:
        digits = round(digits * settings["NOV"] / FACTORY_SPAN)
    return digits if settings["RSN"] == 1 else settings["RSN"] * round(digits / settings["RSN"])
