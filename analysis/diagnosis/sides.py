"""On which side something is missing: which of the three residuals sees it, and what that means.

Nothing is said where a run cannot tell: it has no poses or no steady motion, no residual stands out
firmly, or one that does not could not have.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.balance import SEEN, Balance, Residual, balance
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.spelling import cables, listed
from cdpr8.errors import DataError

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

FIRM = 6.0
"""A residual is told from so many sigmas on: rings that a slow camera folds onto the harmonics are
in no sigma, and make 5 in clean runs."""

ALIKE = 0.35
"""Cables whose shares differ by less than this of their mean are off alike."""

UNACCOUNTED = 0.25
"""Of the platform's residual: cables that pull along their columns at rest leave less than
this, for those turn as the platform moves."""

MOST_RUNS = 3


def sides(
    recordings: Sequence[Recording], located: Sequence[dict[str, Any]]
) -> list[dict[str, Any]]:
    """What the three residuals see in the runs that are farthest off.

    Parameters
    ----------
    recordings
        The runs.
    located
        The statement's findings: runs without any are not looked at.

    Returns
    -------
    list of dict
        For each run that can tell: `run`, `residuals` with what they see, and what that `means`.
    """
    off: dict[str, float] = {}
    for one in located:
        off[one["run"]] = max(off.get(one["run"], 0.0), one["sigmas"])
    found = []
    for name in sorted(off, key=lambda run: -off[run])[:MOST_RUNS]:
        recording = next(one for one in recordings if one.run.name == name)
        try:
            seen = side(balance(recording))
        except (DataError, np.linalg.LinAlgError):
            continue
        if seen is not None:
            found.append({"run": name, **seen})
    return found


def in_words(said: Mapping[str, Any]) -> str:
    """What the three residuals say, run by run where they differ; "": nothing."""
    runs: dict[str, list[str]] = {}
    for one in said.get("balance") or []:
        runs.setdefault(one["means"], []).append(one["run"])
    if len(runs) < 2:
        return "".join(runs)
    return " ".join(f"{listed(names)}: {means}" for means, names in runs.items())


def side(found: Balance) -> dict[str, Any] | None:
    """What the three residuals of a run see, and what it means; None: nothing that is firm.

    Parameters
    ----------
    found
        The residuals.
    """
    own, platform, inner = found.cables, found.platform, found.inner
    if not all(np.isfinite(one.significance).all() for one in (own, platform, inner)):
        return None
    stands_out = own.significance > (SEEN if _firm(own) else np.inf)
    pulled = [int(i) + 1 for i in np.flatnonzero(stands_out)]
    felt = -found.structure @ (own.amplitude * stands_out[:, None])
    told = {
        "cables": "yes" if pulled else _cells_could(found),
        "platform": _sees(platform, felt if pulled else None),
        "inner": "yes" if _firm(inner) else "no",
    }
    if "yes" not in told.values():
        return None
    rows = [
        {
            "residual": name,
            "sees": told[name],
            "where": list(one.seen) if told[name] == "yes" else [],
            "sigmas": float(one.significance.max()),
        }
        for name, one in (("cables", own), ("platform", platform), ("inner", inner))
    ]
    return {"residuals": rows, "means": _means(found, told, pulled, felt)}


def _firm(one: Residual) -> bool:
    return bool(one.significance.max() > FIRM)


def _sees(platform: Residual, felt: Complex | None) -> str:
    """Whether the platform's balance sees it; where it does not, whether it could have."""
    if _firm(platform):
        return "yes"
    if felt is not None and platform.against(felt).max() < 2.0 * FIRM:
        return "cannot tell"
    return "no"


def _cells_could(found: Balance) -> str:
    """Whether tensions read wrong, by too little to be seen, would explain the platform's."""
    own, platform = found.cables, found.platform
    pull = np.empty_like(own.amplitude)
    for h, wrench in enumerate(platform.amplitude.T):
        loose = found.structure * own.sigma[:, h] ** 2
        pull[:, h] = -loose.T @ np.linalg.solve(loose @ found.structure.T, wrench)
    return "cannot tell" if _firm(platform) and own.against(pull).max() < FIRM else "no"


def _means(found: Balance, told: dict[str, str], pulled: list[int], felt: Complex) -> str:
    """The truth table, in a sentence."""
    if not pulled:
        return _not_in_cables(told)
    alike = _alike(found) if len(pulled) == len(found.spring) else ""
    if alike:
        return alike
    own = f"pull{'s' if len(pulled) == 1 else ''} otherwise than k ΔL at the measured pose"
    own = f"{cables(pulled).capitalize()} {own}"
    if told["platform"] == "cannot tell":
        return (
            f"{own}; whether the platform feels it, and so on which side of the force cell it is, "
            "cannot be told here."
        )
    if told["platform"] == "no":
        return (
            f"{own}, and the platform moves as the measured tensions make it: what is missing is "
            "in the cable's own law or between frame and force cell, such as friction at the pulley"
            + (", unless the poses are turned or scaled." if _in_phase(found, pulled) else ".")
        )
    if _accounted(found.platform, felt):
        return (
            f"{own}, and the platform does not feel what the cells read: it is between force cell "
            "and platform, or in the cell itself."
        )
    return (
        f"{own}, and the platform's balance is off in other ways too: more than one thing, or what "
        "both rest on, the poses and the clocks."
    )


def _not_in_cables(told: dict[str, str]) -> str:
    """The truth table's rows where no cable stands out."""
    if told["platform"] != "yes":
        return (
            "Only tensions that cancel on the platform are off, in no cable enough to be seen "
            "alone: it is between frame and force cells, and the poses cannot show it."
        )
    cells = ", or force cells that are off by no more than what is known of the stiffnesses"
    return (
        "The platform's balance is off, and no cable stands out: mass and inertia, the drive's "
        "push, drag, or what takes or adds force between force cells and platform"
        + (cells if told["cables"] == "cannot tell" else "")
        + "."
    )


def _in_phase(found: Balance, pulled: list[int]) -> bool:
    """Whether these cables are off with their elongation rather than with its rate."""
    some = np.array(pulled) - 1
    turned = found.cables.amplitude[some, 0] / found.spring[some]
    return bool(np.abs(turned.real).sum() > np.abs(turned.imag).sum())


def _alike(found: Balance) -> str:
    """All cables off by one share of k ΔL or of its rate; "": they are not."""
    share = found.cables.amplitude[:, 0] / found.spring
    with_length, with_speed = share.real, share.imag
    if _one_share(with_length) and np.abs(with_speed).mean() < abs(with_length.mean()):
        return (
            f"All tensions are off by one share of k ΔL, {100.0 * with_length.mean():+.1f} %: the "
            "camera's scale or axis, or one factor on all stiffnesses."
        )
    if _one_share(with_speed) and np.abs(with_length).mean() < abs(with_speed.mean()):
        what = (
            "ahead of the measured elongation: a late camera or damping of the cables"
            if with_speed.mean() > 0.0
            else "behind the measured elongation: late force cells or an early camera"
        )
        return (
            f"All tensions are off in proportion to the speed of their cables, {what}, which the "
            "three residuals do not tell apart."
        )
    return ""


def _one_share(values: Array) -> bool:
    """Whether all cables have about one value."""
    return bool(np.abs(values - values.mean()).max() < ALIKE * abs(values.mean()))


def _accounted(platform: Residual, felt: Complex) -> bool:
    """Whether what the cables' residuals would make is what the platform's balance is off by."""
    rest = platform.against(platform.amplitude - felt).max()
    return bool(rest < max(FIRM, UNACCOUNTED * platform.significance.max()))
