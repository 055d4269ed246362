"""Clearance where the cable is hooked to the platform, held by friction until it is overcome."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State
from model.library.smooth import TINY


def _within(play_m: Any, middle_share: Any, way: Any) -> Any:
    """As much of a way as the gap allows."""
    return min(max(way, play_m * (middle_share - 1.0)), play_m * (middle_share + 1.0))


def pull(
    play_m: Any, held_share: Any, middle_share: Any, hook: Any, elongation: Any, stiffness: Any
) -> Any:
    """-k y, y the way the hook has slid, or hangs free."""
    free = _within(play_m, middle_share, elongation)
    slid = free + held_share * (hook - free)
    return -stiffness * slid * (play_m / (play_m + TINY))


def rates(
    play_m: Any,
    hold_n: Any,
    middle_share: Any,
    slide_s: Any,
    hook: Any,
    elongation: Any,
    stiffness: Any,
) -> Any:
    """Give y' = (y_0 - y) / t_h, y_0 where the hold stops it or the gap ends."""
    held_m = hold_n / stiffness
    off = elongation - hook
    beyond = off - min(max(off, -held_m), held_m)
    return (_within(play_m, middle_share, hook + beyond) - hook) / slide_s


def rests(play_m: Any, hold_n: Any, middle_share: Any, elongation: Any, stiffness: Any) -> Any:
    """Y, the way the hook has slid from the middle of its gap as the machine came to hang there."""
    held_m = hold_n / stiffness
    beyond = elongation - np.clip(elongation, -held_m, held_m)
    return np.clip(beyond, play_m * (middle_share - 1.0), play_m * (middle_share + 1.0))


EFFECT = Effect(
    name="anchor_play",
    title="play of the hook at the anchor",
    acts=Acts.CABLE,
    equation="T -= k y, |y - m d| <= d: y' = (y_0 - y)/t_h, y_0 = x -+ F_h/k once k|x - y| > F_h",
    source="friction-held clearance; Nordin & Gutman, Automatica 38 (2002) 1633",
    signature="a plateau of the tension after reversal, once the force exceeds the hold; none "
    "below an amplitude",
    parameters=(
        Parameter("play_m", "m", 2e-4, 0.0, 2e-3, "d", magnitude=True),
        Parameter("hold_n", "N", 0.5, 0.05, 10.0, "F_h"),
        Parameter("held_share", "1", 1.0, 0.0, 1.0, "1: held by friction; 0: hangs free, y = x"),
        Parameter("middle_share", "1", 0.0, -1.0, 1.0, "m: where the gap's middle is, over d"),
        Parameter("slide_s", "s", 1e-3, 4e-4, 2e-2, "t_h, in which it slides home"),
    ),
    states=(State("hook", "m", "y, the way the hook has slid", rests=rests),),
    pull=pull,
    rates=rates,
    longest_step_s=1.6e-3,
    cost="a hook may slide home within 0.4 ms; twice the steps",
)
