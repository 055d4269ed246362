"""A video watched frame by frame, parts of it side by side.

What a tracker must know of the frames before is in the last few, but for the score of both
branches of a pose, and branches are chosen anew once all frames are known (`vision.sequence`). So a
part of a video may be watched by another process, which looks at a few frames before it first.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from cdpr8.crew import Crew
from cdpr8.runfolder.video import read_video
from vision.tracker import Sighting, Tracker

LEAD = 4
"""Frames looked at before a part: where the plate was, how it moved, and what is repeated."""

LEAST = 60
"""Frames of a part: to watch fewer takes no longer than to start a process."""


@dataclass(frozen=True)
class Watched:
    """What was seen of a plate.

    Attributes
    ----------
    sightings
        One a frame.
    stamps
        The container's time of each, s; None where it has none.
    count
        Whole frames of the video, watched or not.
    ids
        Markers that were seen, of the plate or not.
    """

    sightings: Sequence[Sighting]
    stamps: Sequence[float | None]
    count: int
    ids: frozenset[int]


def watch(
    video: Path,
    tracker: Tracker,
    frames: int | None,
    workers: int = 1,
    step: Callable[[], None] | None = None,
) -> Watched:
    """Every frame of a video that shows one plate.

    Parameters
    ----------
    video
        The file.
    tracker
        As it was made; it knows the markers of all frames after it.
    frames
        So many are watched at most, and others counted; None: all, however many there are.
    workers
        Processes.
    step
        Called once a frame.

    Raises
    ------
    DataError
        It is no video, or one of another size than the camera's.
    """
    parts = max(min(workers, (frames or 0) // LEAST), 1)
    ends = [(frames or 0) * k // parts for k in range(1, parts)]
    steps = _Steps(step, parts)
    watcher = _Watcher(video, tracker, frames, steps)
    crew: Crew[tuple[int, int | None], Watched] = Crew(watcher, parts, long=True)
    found = crew.do(list(zip([0, *ends], [*ends, None], strict=True)))
    ids = frozenset[int]().union(*(one.ids for one in found))
    tracker.ids_seen.update(ids)
    sightings = [sighting for one in found for sighting in one.sightings]
    if step is not None:
        for _ in range(len(sightings) - steps.taken):
            step()
    stamps = [stamp for one in found for stamp in one.stamps]
    return Watched(sightings, stamps, found[-1].count, ids)


class _Steps:
    """Progress, told by the process that was asked: of each frame it sees, so many are done."""

    def __init__(self, step: Callable[[], None] | None, times: int) -> None:
        self._step, self._times = step, times
        self.taken = 0

    def __call__(self) -> None:
        """One more frame."""
        if self._step is not None:
            for _ in range(self._times):
                self._step()
                self.taken += 1

    def __reduce__(self) -> tuple[type["_Steps"], tuple[None, int]]:
        """A copy in another process tells nobody."""
        return _Steps, (None, 1)


@dataclass(frozen=True)
class _Watcher:
    """Watches a part of a video."""

    video: Path
    tracker: Tracker
    frames: int | None
    steps: _Steps

    def do(self, work: tuple[int, int | None]) -> Watched:
        """From one frame up to another; None: to the end, which counts all."""
        first, end = work
        tracker = self.tracker.anew()
        sightings: list[Sighting] = []
        stamps: list[float | None] = []
        count = 0
        for image, stamp in islice(read_video(self.video), end):
            tracker.camera.check_size(image, str(self.video))
            count += 1
            if count <= first - LEAD or (self.frames is not None and count > self.frames):
                continue
            seen = tracker.see(image).sightings[0]
            if count > first:
                sightings.append(seen)
                stamps.append(stamp)
                self.steps()
        return Watched(sightings, stamps, count, frozenset(tracker.ids_seen))
