"""A bad line on a virtual clock, for hours too: no spoiled or late byte becomes a good value."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import (
    HeldUp,
    WavePlatform,
    all_true,
    record_spoiled,
    simulated_line,
    with_bus,
)

from cdpr8.rigfile import Rig
from cdpr8.runfolder import BAD_TENSION, EventKind, load_run
from rig.amplifier.message import TRIGGER
from rig.broadcast import open_bus
from rig.bus import Bus
from rig.intake import Intake
from rig.lines import Sample
from rig.simulated.bus import SimulatedBus
from rig.simulated.faults import LineFaults
from rig.streams import BusStream, Span
from rig.tally import Tally
from rig.transport import LineSettings

FAULTS = ("flip", "drop", "insert")
PER_BYTE = 1e-4


@dataclass
class Witness:
    """A scribe that knows what each amplifier really measured."""

    bus: SimulatedBus
    origin_s: float = 0.0
    triggered_s: float | None = None  # how long after its request a triggered value is ready
    wrong: list[Sample] = field(default_factory=list)
    events: Counter[str] = field(default_factory=Counter)
    good: int = 0
    written: int = 0
    failure: None = None

    def sample(self, sample: Sample) -> None:
        self.written += 1
        if sample.status & BAD_TENSION:
            return
        self.good += 1
        node = self.bus.nodes[sample.cable - 1]
        first = node.signal.number_at(self.origin_s + sample.request_s, 0)
        until_s = sample.received_s
        if self.triggered_s is not None:
            until_s = sample.request_s + self.triggered_s
        last = node.signal.number_at(self.origin_s + until_s, 0)
        true = (node.signal.value(number, 0, 0)[0] for number in range(first, last + 1))
        if sample.digits not in true:
            self.wrong.append(sample)

    def event(self, t_s: float, kind: EventKind, detail: str, cable: int | None = None) -> None:
        self.events[kind.value] += 1

    def close(self) -> None: ...


def triggered_s(rig: Rig) -> float | None:
    """From the start of a trigger to the latest value that it can give."""
    if rig.bus.sweep == "polled":
        return None
    line = LineSettings(rig.bus.baud, rig.bus.parity)
    return (len(TRIGGER) + 2) * line.char_s + 1.001 / 1200  # two bytes may come between


def hours_of_faults(
    rig: Rig, hours: float, kinds: tuple[str, ...], per_byte: float, seed: int = 1
) -> tuple[Witness, Tally, LineFaults, int]:
    """A faulty bus for so long; also returns how many values were asked for."""
    faults = LineFaults(np.random.default_rng(seed))
    line, transport = simulated_line(rig, WavePlatform(1.0, 0.3), faults=faults, seed=seed)
    bus = open_bus(transport, rig)
    stations = bus.start()
    for kind in kinds:
        setattr(faults, kind, per_byte / len(kinds))
    origin_s = transport.clock.monotonic_s()
    witness, tally = Witness(line, origin_s, triggered_s(rig)), Tally()
    span = Span(origin_s, origin_s + 3600.0 * hours)
    asked = 0
    take = bus.take

    def counted(*arguments: object) -> object:
        nonlocal asked
        asked += 1
        return take(*arguments)

    bus.take = counted
    stream = BusStream(bus, stations, Intake(witness, tally, origin_s), span)
    while stream.step():
        pass
    return witness, tally, faults, asked


def held(witness: Witness, tally: Tally, asked: int) -> None:
    """No wrong value is good, and every value asked for was written or counted as lost."""
    assert witness.wrong == []
    lost = tally.lost.get("bad_frame", 0) + tally.lost.get("no_answer", 0)
    assert witness.written + lost == asked
    assert witness.good == witness.written - tally.lost.get("flagged", 0)
    assert witness.events["bad_frame"] == tally.lost.get("bad_frame", 0)


SWEEPS = pytest.mark.parametrize("sweep", ["polled", "broadcast"])


@SWEEPS
@pytest.mark.parametrize("parity", ["even", "none"])
@pytest.mark.long
def test_minutes_of_a_bad_line_record_nothing_wrong(rig: Rig, parity: str, sweep: str) -> None:
    witness, tally, faults, asked = hours_of_faults(
        with_bus(rig, parity=parity, sweep=sweep), 0.8 / 60, (*FAULTS, "twist"), 30 * PER_BYTE
    )
    assert sum(faults.count.values()) > 400
    held(witness, tally, asked)
    assert witness.good > 0.5 * asked


@pytest.mark.slow
@SWEEPS
def test_a_day_of_a_bad_line_records_nothing_wrong(
    rig: Rig, sweep: str, record_property: Callable[[str, object], None]
) -> None:
    # 9600 baud: 24 h are 7 million values, each held against the amplifier's own.
    witness, tally, faults, asked = hours_of_faults(
        with_bus(rig, baud=9600, sweep=sweep), 24.0, FAULTS, PER_BYTE
    )
    record_property("faults", faults.count)
    record_property("good, asked, lost", (witness.good, asked, tally.lost))
    assert sum(faults.count.values()) > 5000
    held(witness, tally, asked)
    assert witness.good > 0.99 * asked


@SWEEPS
def test_another_amplifiers_value_is_not_believed(rig: Rig, sweep: str) -> None:
    # Without parity one turned bit makes S01; into S03;, and node 3 answers in good order.
    rig = with_bus(rig, parity="none", sweep=sweep)
    line, transport = simulated_line(rig)
    bus = open_bus(transport, rig)
    stations = bus.start()
    origin_s = transport.clock.monotonic_s()
    witness, tally = Witness(line, origin_s, triggered_s(rig)), Tally()
    hear, wrong = line.hear, []

    def mishear(data: bytes, start_s: float) -> None:
        if data == b"S01;" and len(wrong) < 20 and start_s > origin_s + 0.3 * len(wrong):
            wrong.append(start_s)
            data = b"S03;"
        hear(data, start_s)

    line.hear = mishear
    span = Span(origin_s, origin_s + 7.0)
    stream = BusStream(bus, stations, Intake(witness, tally, origin_s), span)
    while stream.step():
        pass
    assert len(wrong) == 20
    assert witness.wrong == []
    if sweep == "broadcast":  # node 3 gives its value once: it is missed where it is due
        assert tally.lost["no_answer"] == len(wrong)
    # And one that waited when the run ended.
    assert 0 <= tally.lost["unconfirmed"] - len(wrong) <= 1


def test_a_real_jump_is_confirmed_and_kept(rig: Rig) -> None:
    class Snap(WavePlatform):
        def tension_at(self, cable: int, t_s: np.ndarray) -> np.ndarray:
            return np.asarray(10.0 + 15.0 * (t_s > 1.0))

    line, transport = simulated_line(rig, Snap())
    bus = Bus(transport, rig)
    stations = bus.start()
    origin_s = transport.clock.monotonic_s()
    for node in line.nodes:
        node.signal.begin(origin_s)
    witness, tally = Witness(line, origin_s), Tally()
    stream = BusStream(
        bus, stations, Intake(witness, tally, origin_s), Span(origin_s, origin_s + 2.0)
    )
    while stream.step():
        pass
    assert witness.good == witness.written > 2.0 * 8 * 0.9 * 131
    assert tally.lost == {}


@SWEEPS
@pytest.mark.parametrize("kind", ["flip", "drop", "insert"])
def test_spoiled_bytes_never_become_good_values(
    rig: Rig, tmp_path: Path, kind: str, sweep: str
) -> None:
    folder = tmp_path / "run"
    rig = with_bus(rig, sweep=sweep)
    recording, faults = record_spoiled(rig, folder, 20.0, {kind: 1e-3}, seed=5)
    run = load_run(folder)
    assert faults.count[kind] > 80
    assert all_true(run)
    counted = sum(recording.stop.lost.get(what, 0) for what in ("bad_frame", "no_answer"))
    assert counted > 0.5 * faults.count[kind]
    bad = run.events[run.events["kind"] == "bad_frame"]
    assert len(bad) == recording.stop.lost.get("bad_frame", 0)


@SWEEPS
@pytest.mark.parametrize("held_s", [0.01, 0.03, 0.042, 0.06, 0.1, 0.3])
def test_late_answers_are_not_taken_for_the_next_nodes(rig: Rig, held_s: float, sweep: str) -> None:
    # One answer in 97 is late, so all cables have their turn.
    rig = with_bus(rig, sweep=sweep)
    line, transport = simulated_line(rig, WavePlatform(1.0, 0.3))
    asked = count(1)
    held = HeldUp(transport, lambda request: held_s if next(asked) % 97 == 0 else 0.0)
    bus = open_bus(transport, rig)
    stations = bus.start()
    bus.transport = bus._dialogue.transport = held
    origin_s = transport.clock.monotonic_s()
    for node in line.nodes:
        node.signal.begin(origin_s)
    witness, tally = Witness(line, origin_s, triggered_s(rig)), Tally()
    span = Span(origin_s, origin_s + 3.0)
    stream = BusStream(bus, stations, Intake(witness, tally, origin_s), span)
    while stream.step():
        pass
    assert witness.wrong == []
    assert witness.good == witness.written - tally.lost.get("flagged", 0) > 400
    if sweep == "polled":
        assert ("untimed" in tally.lost) == (held_s == 0.01)
    assert ("no_answer" in tally.lost) == (held_s > 0.02)
