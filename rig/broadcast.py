"""The amplifiers' bus where all measure at one instant: a broadcast trigger, then value by value.

``S98;MSV?;`` has every amplifier measure its next value and hold it; ``Sxx;`` fetches it (protocol
note, section 9). An amplifier samples on its own clock: within one output period after the trigger.

What the note does not tell is settled on the safe side. An amplifier is not selected before its
value must be ready. That a value can be fetched once only is asked of it at the start: one that
gives a value twice would, where a trigger was not heard, give the last sweep's for this one's.
"""

import math

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Rig
from rig.amplifier import message
from rig.amplifier.dialogue import SETTLE_S
from rig.amplifier.frame import BUS_MODE, BadFrameError, FrameFormat
from rig.amplifier.probe import probe_format
from rig.answer_times import JITTER_S
from rig.bus import UNTIMED_S, Bus
from rig.station import Station, Value
from rig.transport import Transport

CRYSTAL = 1e-3
"""How much longer than its name an output period may be: ten times what crystals are off."""

FAILURES_TO_START_ANEW = 2
"""Values in a row that did not come: perhaps nobody heard the trigger, or heard another command."""


def open_bus(transport: Transport, rig: Rig, zeros: dict[int, float] | None = None) -> Bus:
    """The bus with the kind of sweep that the rig file asks for."""
    kind = BroadcastBus if rig.bus.sweep == "broadcast" else Bus
    return kind(transport, rig, zeros)


class BroadcastBus(Bus):
    """Eight amplifiers on one line, triggered together.

    Parameters are those of `Bus`. A sweep begins when a value is taken from an amplifier that has
    given one since the last trigger.
    """

    # Two values of one sweep have one time: a doubted value waits for the next sweep's.
    asks_again = False
    # One that was reset, and forgot its settings, obeys the trigger like the others.
    _is_proof = False

    def __init__(
        self, transport: Transport, rig: Rig, zeros: dict[int, float] | None = None
    ) -> None:
        super().__init__(transport, rig, zeros)
        self._addresses = frozenset(each.address for each in self._amplifiers.values())
        self._pending: set[int] = set()
        self._unsure: set[int] = set()
        self._failures = 0
        self._trigger_s = self._heard_s = 0.0
        self._took_s = self._held_up_s = 0.0
        # Of the sweep: whether its first answer is to come, and whether any came.
        self._proof_due = self._heard = False

    def start(self) -> tuple[Station, ...]:
        """Silence the bus, identify and configure all amplifiers; as `Bus.start`."""
        stations = super().start()
        self._fetch_all()
        self._dialogue.unused()
        return stations

    def stop(self) -> None:
        """Stop all output; what is held still is of no sweep."""
        self._unsure |= self._pending
        self._pending.clear()
        super().stop()

    def resume(self, stations: tuple[Station, ...]) -> tuple[Station, ...]:
        """Set the bus up again after the line was gone; as `Bus.resume`."""
        self.stop()
        self._fetch_all()
        return super().resume(stations)

    def _output_format(self, cof: int) -> int:
        return cof & ~BUS_MODE

    def _measure(self, command: bytes) -> None:
        """Nothing is measured unless it is triggered."""

    def _probe(self, address: int, period_s: float) -> FrameFormat:
        wait_s = _ask_after_s(period_s, self.transport.line.char_s)
        self.waits_s = max(self.waits_s, wait_s)
        cof, csm = self._settings.cof, self._settings.csm
        format_ = probe_format(self._dialogue, address, cof, csm, wait_s)
        if came := self._fetch_held(address):
            raise DeviceError(
                f"amplifier {address:02d} gives a value twice ({came.hex(' ').upper()}): after a "
                "trigger that it did not hear, an old value could not be told from a new one",
                allowed="amplifiers that give each triggered value once",
                where=self.transport.name,
                remedy='set [bus] sweep = "polled" in the rig file',
            )
        return format_

    def _prepare(self, station: Station) -> None:
        if station.address in self._pending:
            self._ask(station)
        else:
            self._trigger()

    def _ask(self, station: Station) -> None:
        if station.address not in self._pending:
            self._trigger()
        self._pending.discard(station.address)
        self.transport.clock.sleep_until(self._heard_s + self.waits_s)
        super()._ask(station)

    def _trigger(self) -> None:
        if stray := self.transport.discard():
            raise BadFrameError("bytes that nobody asked for", stray)
        clock, line = self.transport.clock, self.transport.line
        # Whoever has not been asked since the last trigger holds its value still.
        self._unsure |= self._pending
        self._pending = set(self._addresses)
        self._trigger_s = clock.monotonic_s()
        self.transport.write(message.TRIGGER)
        self._took_s = took_s = clock.monotonic_s() - self._trigger_s
        # Written within that time; and an adapter delays both ways alike.
        way_s = self._answers.least_s / 2.0
        self._heard_s = self._trigger_s + took_s / 2.0 + len(message.TRIGGER) * line.char_s + way_s
        self._proof_due, self._heard = True, False

    def _take(self, station: Station, following: Station | None = None) -> Value:
        try:
            if self._asked is not station:
                self._ask(station)
            self._asked = None
            reading, received = self._due.fetch(station, self._asked_s)
        except BadFrameError:
            self._failed(station)
            raise
        self._failures = 0
        # A value that may be of an earlier trigger has no known time, nor has one whose trigger was
        # written who knows when.
        period_s = station.period_s
        timed = station.address not in self._unsure and self._took_s <= period_s
        self._unsure.discard(station.address)
        asked_s, trigger_s, heard_s = self._asked_s, self._trigger_s, self._heard_s
        is_proof, self._proof_due, self._heard = self._proof_due, False, True
        # Whatever can wait is done while the next answer is on the line.
        self._go_on(following)
        _, held_up_s = self._answers.began(station, asked_s, received)
        if is_proof:
            # What held up the first answer may have held up the trigger.
            self._held_up_s = held_up_s
        return Value(
            reading,
            trigger_s,
            received.last_byte_s,
            heard_s + period_s / 2.0,
            timed=timed and self._held_up_s <= max(period_s, UNTIMED_S),
        )

    def _failed(self, station: Station) -> None:
        self._unsure.add(station.address)
        self._failures += 1
        if self._proof_due:
            # It may have been asked too early: the trigger came late, and who knows how late.
            self._held_up_s = math.inf
        self._proof_due = False
        if self._failures >= FAILURES_TO_START_ANEW and not self._heard:
            self._failures = 0
            self.stop()

    def _fetch_all(self) -> None:
        """Fetch what any amplifier holds: the next value of each is then of the next trigger."""
        for address in self._addresses:
            self._fetch_held(address)
        self._pending.clear()
        self._unsure.clear()

    def _fetch_held(self, address: int) -> bytes:
        self._dialogue.tell(message.select(address))
        chars = len(message.select(address)) + 1
        return self._dialogue.hush(SETTLE_S + chars * self.transport.line.char_s)


def _ask_after_s(period_s: float, char_s: float) -> float:
    """How long after the trigger was heard a value of that output period may be asked for.

    It is ready a period later, and selected when the request has been heard: the time that takes is
    margin for adapters, or part of it.
    """
    request_s = len(message.select(0)) * char_s
    return period_s * (1.0 + CRYSTAL) + max(0.0, JITTER_S - request_s)
