"""Events that are known beforehand, written when their time has come."""

import math
from dataclasses import dataclass
from datetime import datetime

from cdpr8.clock import Clock
from cdpr8.rigfile import Excitation
from cdpr8.runfolder import EventKind
from rig.scribe import Scribe
from rig.streams import Span
from rig.taps import Taps

ANCHOR_EVERY_S = 10.0
"""Clock anchors (run's time against wall time) are noted this often."""


@dataclass(frozen=True)
class Announcement:
    """An event that is known beforehand; t_s of the run."""

    t_s: float
    kind: EventKind
    detail: str


class AnnouncementStream:
    """Writes events when their time has come: the motion's start and end, clock anchors.

    Parameters
    ----------
    announcements
        In order of time.
    clock
        Its time is waited for.
    scribe
        Takes the events.
    span
        Of the run.
    taps
        Where the user's sync taps come in.
    """

    name = "announcements"

    def __init__(
        self,
        announcements: tuple[Announcement, ...],
        clock: Clock,
        scribe: Scribe,
        span: Span,
        taps: Taps | None = None,
    ) -> None:
        self._taps = taps
        self._wall_ahead_s: float | None = None
        self._waiting = list(announcements)
        self._clock = clock
        self._scribe = scribe
        self._span = span

    @property
    def due_s(self) -> float:
        """When the next one is due."""
        return self._span.origin_s + self._waiting[0].t_s if self._waiting else self._span.end_s

    def step(self) -> bool:
        """Wait a little, or write the next one."""
        now_s = self._clock.monotonic_s()
        self._look_at_the_wall(now_s)
        while self._taps is not None and not self._taps.empty():
            tapped_s = self._taps.get() - self._span.origin_s
            self._scribe.event(tapped_s, EventKind.SYNC_TAP, "Enter was pressed")
        if not self._waiting and self._taps is not None and now_s < self._span.end_s:
            self._clock.sleep_until(min(self._span.end_s, now_s + _PATIENCE_S))
            return True
        if not self._waiting or self.due_s > self._span.end_s:
            return False
        if now_s < self.due_s:
            self._clock.sleep_until(min(self.due_s, now_s + _PATIENCE_S))
            return True
        announced = self._waiting.pop(0)
        detail = announced.detail
        if announced.kind is EventKind.CLOCK_ANCHOR:
            detail = _spoken(self._clock.wall())
        self._scribe.event(announced.t_s, announced.kind, detail)
        return True

    def _look_at_the_wall(self, now_s: float) -> None:
        """Note a step of the wall clock; the run's own times do not move with it."""
        ahead_s = self._clock.wall().timestamp() - now_s
        if self._wall_ahead_s is None:
            self._wall_ahead_s = ahead_s
        step_s = ahead_s - self._wall_ahead_s
        if abs(step_s) > STEP_S:
            self._scribe.event(
                now_s - self._span.origin_s,
                EventKind.CLOCK_STEP,
                f"the wall clock was stepped by {step_s:+.3f} s",
            )
        self._wall_ahead_s = ahead_s


STEP_S = 0.1
"""A change of the wall clock against the monotonic one by more than this is a step."""

_PATIENCE_S = 0.1
"""A stream looks up this often, so that a stop is not waited for."""


def _spoken(wall: datetime) -> str:
    return wall.isoformat(timespec="microseconds")


def announcements(motion: Excitation, motion_known: bool) -> tuple[Announcement, ...]:
    """What is announced in a run: clock anchors, and the motion where its times are known."""
    count = math.floor(motion.duration_s / ANCHOR_EVERY_S)
    announced = [
        Announcement(number * ANCHOR_EVERY_S, EventKind.CLOCK_ANCHOR, "")
        for number in range(count + 1)
    ]
    if motion_known:
        words = f"{motion.axis} {motion.amplitude_deg:g} deg at {motion.frequency_hz:g} Hz"
        announced += [
            Announcement(motion.start_s, EventKind.MOTION_START, words),
            Announcement(motion.end_s, EventKind.MOTION_END, words),
        ]
    return tuple(sorted(announced, key=lambda each: each.t_s))
