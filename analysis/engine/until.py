"""A system up to some time: what comes after counts for nothing."""

from collections.abc import Sequence
from dataclasses import replace

from analysis.engine.begins import Begins
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.restated import Restated, restatements
from analysis.engine.system import Point, System

FORETOLD = (
    "what was recorded after {until_s:.1f} s does not count: up to there it can be foretold, and "
    "after that not by anything that was tried. A motion that grows of itself, as in a parametric "
    "resonance, does that, cables that stick and slip or go slack do, and so does something that "
    "only begins then; another frequency of the drive tells which"
)

AT_ONCE = (
    "at {at_s:.1f} s something begins at once, loudest in {channel!r}, that nothing tried "
    "explains: what was recorded after {until_s:.1f} s does not count. What slips, a blow, or a "
    "sensor that jumps does that"
)


class Until(Restated):
    """A system whose recordings are looked at up to a share of their time.

    Parameters
    ----------
    stated
        All of it.
    share
        Of the time of each bundle, above 0.
    begins
        What begins at once after that: it was left out, whatever it is.
    by_cause
        A cause foretells so much, and parameters alone do not: something was left out, whatever
        that part says of what it is.
    """

    def __init__(
        self,
        stated: System,
        share: float,
        begins: Begins | None = None,
        *,
        by_cause: bool = False,
    ) -> None:
        super().__init__(stated)
        self.share = share
        self.begins = begins
        self.by_cause = by_cause
        self.bundles = tuple(cut(one, share) for one in stated.bundles)

    @property
    def end_s(self) -> float:
        """When the last that counts was recorded."""
        return max(one.end_s for bundle in self.bundles for one in bundle.segments)

    @property
    def tells(self) -> bool:
        """Whether something was left out, even where nothing was before then."""
        return self.begins is not None or self.by_cause

    @property
    def note(self) -> str:
        """See `Restated`."""
        if self.begins is None:
            return FORETOLD.format(until_s=self.end_s)
        at_s, channel = self.begins
        return AT_ONCE.format(at_s=at_s, channel=channel, until_s=self.end_s)

    def as_stated(self, point: Point) -> Point:
        """See `Restated`."""
        return replace(point, upto=min(point.upto, self.share))


def cut(bundle: Bundle, share: float) -> Bundle:
    """As much of a bundle as lies before a share of its time."""
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


def until_of(system: System) -> Until | None:
    """Up to when a system's recordings are foretold; None: to their end."""
    return next((one for one in restatements(system) if isinstance(one, Until)), None)
