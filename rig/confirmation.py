"""A value that jumped is asked again before it is believed.

What the line does to a request is not seen in the answer: without a parity bit one turned bit makes
``S01;`` into ``S03;``, and another amplifier's value comes in good order. Bus mode carries no
address, so the only witness is a second reading (docs/recording.md, "What is not believed").
"""

from dataclasses import dataclass

from rig.amplifier.scaling import Scaling
from rig.station import Value

JUMP_OF_NOMINAL = 0.01
"""A change from one value to the next by more than this part of the cell's range is doubted."""

KEPT_OF_JUMP = 0.5
"""A second reading confirms a jump where it differs from it by less than this part of it: one
exchange later a moving signal has gone on by a fraction, while another amplifier's value is gone.
"""


@dataclass
class _Course:
    """One cable's values so far: the last ones believed, and those that are doubted."""

    believed: Value | None = None
    before: Value | None = None
    doubted: Value | None = None
    first: Value | None = None

    def expects(self, value: Value, limit: float) -> bool:
        """Whether a value is near the last one, or near where the last two were heading."""
        last, before = self.believed, self.before
        if last is None:
            return False
        change = value.reading.digits - last.reading.digits
        if abs(change) <= limit:
            return True
        if before is None:
            return False
        slope = (last.reading.digits - before.reading.digits) / (last.sampled_s - before.sampled_s)
        return abs(change - slope * (value.sampled_s - last.sampled_s)) <= limit

    def begin(self, doubted: Value, value: Value, limit: float) -> list[tuple[Value, bool]]:
        """Where nothing was believed before, three values in one line confirm each other."""
        first, self.first = self.first, doubted
        if first is None:
            self.doubted = value
            return []
        began = _Course(believed=doubted, before=first)
        if not began.expects(value, limit):
            self.doubted = value
            return [(first, False)]
        self.before, self.believed, self.first = doubted, value, None
        return [(first, True), (doubted, True), (value, True)]

    def believe(self, value: Value) -> None:
        """Go on from a value."""
        if self.believed is None or value.sampled_s > self.believed.sampled_s:
            self.before, self.believed = self.believed, value


class Confirmation:
    """Which values are believed, by cable."""

    def __init__(self) -> None:
        self._courses: dict[int, _Course] = {}

    def doubts(self, cable: int) -> bool:
        """Whether a value of this cable waits for a second reading."""
        course = self._courses.get(cable)
        return course is not None and course.doubted is not None

    def judge(self, cable: int, scaling: Scaling, value: Value) -> list[tuple[Value, bool]]:
        """Values that are settled now, in order of time, and whether each is believed."""
        course = self._courses.setdefault(cable, _Course())
        limit = JUMP_OF_NOMINAL * abs(scaling.digits(scaling.nominal_force_n) - scaling.digits(0.0))
        doubted, expected = course.doubted, course.expects(value, limit)
        settled: list[tuple[Value, bool]] = []
        if doubted is not None:
            course.doubted = None
            change = abs(value.reading.digits - doubted.reading.digits)
            last = course.believed
            if last is None and change > limit:
                return course.begin(doubted, value, limit)
            if course.first is not None:
                settled.append((course.first, False))
                course.first = None
            jump = 0 if last is None else abs(doubted.reading.digits - last.reading.digits)
            confirmed = change <= max(limit, KEPT_OF_JUMP * jump)
            settled.append((doubted, confirmed))
            if confirmed:
                course.believe(doubted)
                expected = True
        if expected:
            course.believe(value)
            settled.append((value, True))
        else:
            course.doubted = value
        return settled

    def forget(self, cable: int) -> list[tuple[Value, bool]]:
        """Start anew with a cable; a value that is doubted still is not believed."""
        course = self._courses.pop(cable, _Course())
        return [(value, False) for value in (course.first, course.doubted) if value is not None]
