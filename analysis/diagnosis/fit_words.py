"""How well a simulation follows the recording, in words: before and after."""

from collections.abc import Mapping
from typing import Any

from analysis.diagnosis.spelling import listed

FALLS = 0.99
"""An error that comes to less than this share of what it was has fallen."""

FAR_FROM_NOISE = 3.0
"""A simulation that misses by more than this, in units of noise, is not told of as if it fitted."""

KINDS = {"tension": "tensions", "pose": "poses"}

Statement = Mapping[str, Any]


def improvement(said: Statement) -> list[str]:
    """What the simulation misses, before and after, on data that the fit did not use."""
    before, after = said["fit"].get("before", {}), said["fit"].get("after", {})
    if not said["causes"]:
        kinds = before.get("held_out") or before.get("used") or {}
        if not kinds:
            return []
        parts = [f"{value:.3g} for {KINDS.get(kind, kind)}" for kind, value in kinds.items()]
        return [f"What the simulation misses is, in units of the noise, {listed(parts)}."]
    part = _part(said)
    if not before.get(part) or not after.get(part):
        return []
    parts = [
        f"from {value:.3g} to {after[part][kind]:.3g} for {KINDS.get(kind, kind)}"
        for kind, value in before[part].items()
        if kind in after[part]
    ]
    data = "data that the fit did not use" if part == "held_out" else "the data that were fitted"
    worse = any(after[part][kind] > value for kind, value in before[part].items()
                if kind in after[part])  # fmt: skip
    goes = "falls" if falls(said) and not worse else "goes"
    texts = [
        f"On {data}, the error of the simulation {goes} "
        f"{listed(parts)}, in units of the noise (1 is noise alone)."
    ]
    if far_from_noise(said):
        texts.append(
            "That is still well above the noise. What rings after a kick cannot be foretold in its "
            "phase and is not held against a law, so more may hide in it."
        )
    return texts


def _part(said: Statement) -> str:
    """Of the data, on which before and after are compared."""
    both = (said["fit"].get(one, {}).get("held_out") for one in ("before", "after"))
    return "held_out" if all(both) else "used"


def falls(said: Statement) -> bool:
    """Whether the simulation misses less of anything with the causes in, or nobody looked."""
    before, after = said["fit"].get("before", {}), said["fit"].get("after", {})
    part = _part(said)
    kinds = before.get(part, {}).keys() & after.get(part, {}).keys()
    return not kinds or any(after[part][one] < FALLS * before[part][one] for one in kinds)


def far_from_noise(said: Statement) -> bool:
    """Whether the simulation still misses by far more than the noise, causes in."""
    values = [v for kinds in said["fit"].get("after", {}).values() for v in kinds.values()]
    return max(values, default=0.0) > FAR_FROM_NOISE
