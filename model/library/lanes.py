"""Where the kernels keep their numbers; in the lane kernel, slots of `LANES` values in flat arrays.

Flat arrays with constant offsets are what the compiler turns into vector instructions
(notes/solver.md).
"""

from collections.abc import Mapping
from types import MappingProxyType

LANES = 16
"""Simulations side by side. Part of the compiled text: the kernel's fingerprint covers it."""


def _slots(sizes: Mapping[str, int]) -> Mapping[str, int]:
    """First slot of each quantity."""
    first, slots = 0, {}
    for name, size in sizes.items():
        slots[name] = first
        first += size
    return MappingProxyType(slots)


WORK = _slots(
    {
        "angles": 6,
        "turn": 9,
        "omega": 3,
        "force": 3,
        "moment": 3,
        "position": 3,
        "velocity": 3,
        "rates": 3,
        "arm": 3,
        "direction": 3,
        "length": 1,
        "elongation": 1,
        "elongation_rate": 1,
        "axial_velocity": 1,
        "anchor_velocity": 3,
        "elastic": 1,
        "pull": 1,
        "behind": 1,
        "mid_span": 1,
        "mid_span_rate": 1,
        "acceleration": 6,
        "end": 0,
    }
)
"""Slots of the room to work in."""

CABLE = _slots(
    {
        "base": 3,
        "anchor": 3,
        "rest_length": 1,
        "stiffness": 1,
        "pretension": 1,
        "line_density": 1,
        "damping": 1,
        "gravity": 1,
        "post_share": 1,
        "rest_direction": 3,
        "values": 0,
    }
)
"""Numbers of one cable, as every law may ask for them; the parameters of the effects follow."""

PLATFORM = _slots(
    {"mass": 1, "gravity": 1, "inertia": 9, "inverse_inertia": 9, "drive_arm": 3, "end": 0}
)
"""Slots of the platform's numbers; they follow those of the last cable."""


def number_of(name: str) -> int:
    """Where a number of a cable stands, by the name a law asks for it."""
    if name in CABLE:
        return CABLE[name]
    vector, axis = name.rsplit("_", 1)
    return CABLE[vector] + "xyz".index(axis)
