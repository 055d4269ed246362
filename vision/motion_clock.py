"""Frames that were lost or doubled without a trace in the stamps: the motion itself tells.

A periodic motion is a clock. Before and after each frame a sine is fitted to the poses; where the
one before and the one after disagree in phase by whole frames, the stamps are wrong there by as
many.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdpr8.runfolder.tables import FrameFlag

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

WINDOW = 10
"""Frames on either side: more than a period at 2.06 Hz and 16 fps."""

NEAR_WHOLE = 0.25
"""A jump must be a whole number of frames to within this."""

GOOD_FIT = 0.15
"""Residuals over amplitude up to which a stretch is a sine."""

FREQUENCIES = 200


@dataclass(frozen=True)
class ClockJump:
    """Where motion and stamps part.

    Attributes
    ----------
    index
        The first frame after it.
    frames
        Frames missing before it; negative for frames too many.
    """

    index: int
    frames: int


def jumps_of_motion(times: Sequence[float], values: Sequence[float]) -> list[ClockJump]:
    """Find where a periodic motion jumps by whole frames.

    Parameters
    ----------
    times
        Stamps, s, evenly spaced but for noted gaps.
    values
        An angle or a coordinate; NaN where not known.

    Returns
    -------
    list
        Empty where nothing jumps, or the motion is no sine.
    """
    t, y = np.asarray(times, dtype=float), np.asarray(values, dtype=float)
    known = np.isfinite(y) & np.isfinite(t)
    index = np.flatnonzero(known)
    t, y = t[known], y[known]
    if len(t) < 3 * WINDOW:
        return []
    interval = float(np.median(np.diff(t)))
    frequency = _frequency(t, y, interval)
    if frequency is None:
        return []
    # Shifts by whole periods look the same: no more than half a period can be told.
    most = int(0.45 / (frequency * interval))
    found: list[tuple[float, ClockJump]] = []
    for k in range(WINDOW, len(t) - WINDOW + 1):
        before = _sine(t[k - WINDOW : k] - t[k], y[k - WINDOW : k], frequency)
        after = _sine(t[k : k + WINDOW] - t[k], y[k : k + WINDOW], frequency)
        if before is None or after is None:
            continue
        turn = (after[0] - before[0] + np.pi) % (2.0 * np.pi) - np.pi
        frames = turn / (2.0 * np.pi * frequency * interval)
        whole = round(frames)
        if whole and abs(whole) <= most and abs(frames - whole) < NEAR_WHOLE:
            misfit = before[1] + after[1]
            found.append((misfit, ClockJump(int(index[k]), int(whole))))
    return _sharpest(found)


def flag_jumps_of_motion(poses: "pd.DataFrame", column: str, notes: list[str]) -> None:
    """Flag, in a table of poses, frames at which the motion jumps against the stamps.

    Parameters
    ----------
    poses
        With ``t_s``, ``flags`` and the column; its flags are added to.
    column
        What moves periodically.
    notes
        Takes a sentence for each jump.
    """
    values = np.where(poses["flags"].to_numpy() & int(FrameFlag.REPEATED), np.nan, poses[column])
    for jump in jumps_of_motion(poses["t_s"].tolist(), values.tolist()):
        row = poses.index[jump.index]
        flag = FrameFlag.DROPPED_BEFORE if jump.frames > 0 else FrameFlag.REPEATED
        poses.loc[row, "flags"] = int(poses.loc[row, "flags"]) | int(flag)
        what = "missing" if jump.frames > 0 else "too many"
        notes.append(
            f"the motion jumps at frame {int(poses.loc[row, 'frame'])}: {abs(jump.frames)} "
            f"frame{'s' if abs(jump.frames) > 1 else ''} {what} there that the stamps do not show"
        )


def _sharpest(found: list[tuple[float, ClockJump]]) -> list[ClockJump]:
    """Of jumps seen from neighbouring frames, the one where both sides fit best."""
    kept: list[tuple[float, ClockJump]] = []
    for misfit, jump in sorted(found, key=lambda one: one[0]):
        if all(abs(jump.index - other.index) > WINDOW // 2 for _, other in kept):
            kept.append((misfit, jump))
    return sorted((jump for _, jump in kept), key=lambda jump: jump.index)


def _frequency(t: Array, y: Array, interval: float) -> float | None:
    """The frequency whose sines fit short stretches best."""
    stretches = [slice(k, k + 2 * WINDOW) for k in range(0, len(t) - 2 * WINDOW + 1, WINDOW)]
    best, least = None, np.inf
    for frequency in np.linspace(0.03, 0.42, FREQUENCIES) / interval:
        total = np.median([_residual(t[s], y[s], frequency) for s in stretches])
        if total < least:
            best, least = float(frequency), float(total)
    return best


def _design(t: Array, frequency: float) -> Array:
    phase = 2.0 * np.pi * frequency * t
    return np.column_stack([np.sin(phase), np.cos(phase), np.ones_like(t)])


def _residual(t: Array, y: Array, frequency: float) -> float:
    design = _design(t, frequency)
    fit = np.linalg.lstsq(design, y, rcond=None)[0]
    return float(((y - design @ fit) ** 2).mean())


def _sine(t: Array, y: Array, frequency: float) -> tuple[float, float] | None:
    """Phase at t = 0, rad, and residual over amplitude; None where it is no sine."""
    design = _design(t, frequency)
    fit = np.linalg.lstsq(design, y, rcond=None)[0]
    amplitude = float(np.hypot(fit[0], fit[1]))
    residual = float(np.sqrt(((y - design @ fit) ** 2).mean()))
    if amplitude <= 0.0 or residual > GOOD_FIT * amplitude:
        return None
    return float(np.arctan2(fit[1], fit[0])), residual / amplitude
