"""Frame times: where they are missing, uneven or late."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cdpr8.runfolder.tables import FrameFlag

LATE_FRAME = 1.5
"""Frame intervals after which a frame was dropped before this one."""

UNEVEN = 0.1
"""Frame intervals that differ by more than this fraction are a variable frame rate."""


def usual_interval(times: Sequence[float], notes: list[str], *, given: bool) -> float:
    """The usual interval between frames, s; NaN where there is none.

    Parameters
    ----------
    times
        One a frame, s; NaN where the container has none.
    notes
        Takes a sentence where times are missing or uneven.
    given
        The frame rate was given by the user.
    """
    if np.isnan(times).any():
        notes.append("the container gives no times: t_s is empty; give the frame rate with --fps")
        return float("nan")
    steps = np.diff(times)
    interval = float(np.median(steps)) if len(steps) else float("nan")
    if not given and interval > 0.0 and np.abs(steps / interval - 1.0).max() > UNEVEN:
        notes.append(
            f"variable frame rate: intervals from {steps.min():.4f} to {steps.max():.4f} s; "
            "t_s is the container's own time of each frame"
        )
    return interval


def flags_of_late_frames(times: Sequence[float], interval: float) -> list[FrameFlag]:
    """DROPPED_BEFORE for each frame that comes late, none for the others.

    Parameters
    ----------
    times
        One a frame, s.
    interval
        The usual one, s.
    """
    steps = np.diff(times, prepend=times[0] if times else 0.0)
    return [
        FrameFlag.DROPPED_BEFORE if step > LATE_FRAME * interval else FrameFlag(0) for step in steps
    ]


def note_if_cut(path: Path, times: Sequence[float], interval: float, notes: list[str]) -> None:
    """Say where a video holds less than its container announces: it was cut short.

    Parameters
    ----------
    path
        The video.
    times
        Of the frames that could be read, s.
    interval
        The usual one, s.
    notes
        Takes the sentence.
    """
    import av

    with av.open(str(path)) as container:
        announced = container.streams.video[0].frames
        duration_s = (container.duration or 0) / av.time_base
    if announced:
        if len(times) < announced:
            notes.append(
                f"the video is cut short: {len(times)} whole frames of the {announced} announced"
            )
    elif times and times[-1] + 2.0 * interval < duration_s:
        notes.append(
            f"the video is cut short: its last whole frame is at {times[-1]:.2f} s "
            f"of the {duration_s:.2f} s announced"
        )
