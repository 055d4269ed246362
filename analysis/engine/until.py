"""A system up to some time: what comes after counts for nothing."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from analysis.engine.system import (
    Array,
    Bundle,
    Candidate,
    Nuisance,
    Point,
    Prediction,
    Segment,
    System,
    tones_of,
)


class Until:
    """A system whose recordings are looked at up to a share of their time.

    Parameters
    ----------
    system
        All of it.
    share
        Of the time of each bundle, above 0.
    """

    def __init__(self, system: System, share: float) -> None:
        self.stated = system
        self.share = share
        self.name = system.name
        self.nuisances: Sequence[Nuisance] = system.nuisances
        self.candidates: Sequence[Candidate] = system.candidates
        self.bundles: tuple[Bundle, ...] = tuple(_cut(one, share) for one in system.bundles)

    @property
    def end_s(self) -> float:
        """When the last that counts was recorded."""
        return max(one.end_s for bundle in self.bundles for one in bundle.segments)

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        near = [replace(one, upto=min(one.upto, self.share)) for one in points]
        return self.stated.simulate(near, reduce)

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        return tones_of(self.stated, point)


def _cut(bundle: Bundle, share: float) -> Bundle:
    last_s = float(bundle.t_s[0] + share * (bundle.t_s[-1] - bundle.t_s[0]))
    segments = []
    for group in _together(bundle.segments):
        start_s, end_s = group[0].start_s, group[-1].end_s
        if start_s < last_s:
            # What was parted into used and kept back is so still.
            left = min((last_s - start_s) / (end_s - start_s), 1.0)
            segments += [
                replace(
                    one,
                    start_s=start_s + left * (one.start_s - start_s),
                    end_s=start_s + left * (one.end_s - start_s),
                )
                for one in group
            ]
    return replace(bundle, segments=tuple(segments))


def _together(segments: Sequence[Segment]) -> list[list[Segment]]:
    """Segments, each with what is kept back of the same motion."""
    found: list[list[Segment]] = []
    for one in segments:
        before = found[-1][-1] if found else None
        goes_on = before is not None and one.start_s == before.end_s
        if before is not None and goes_on and one.fundamental_hz == before.fundamental_hz:
            found[-1].append(one)
        else:
            found.append([one])
    return found
