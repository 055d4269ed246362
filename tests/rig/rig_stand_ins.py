"""Stand-ins for what a recording needs: a platform, a camera, a line with a script."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdpr8.clock import Clock, VirtualClock
from cdpr8.rigfile import Excitation, Rig
from cdpr8.runfolder import BAD_TENSION, Run
from rig.ending import Recording
from rig.machine import Machine
from rig.recorder import record
from rig.simulated.bus import SimulatedBus
from rig.simulated.faults import LineFaults
from rig.simulated.rig import assemble, simulated_nodes
from rig.transport import LineSettings, MemoryTransport, Received

Array = NDArray[np.float64]
EPOCH = datetime(2024, 1, 1, tzinfo=UTC)


@dataclass
class WavePlatform:
    """Each cable has its own mean, so that a value of the wrong cable shows."""

    amplitude_n: float = 0.0
    frequency_hz: float = 2.0
    slope_n_per_s: float = 0.0

    def pose_at(self, t_s: Array) -> Array:
        return np.zeros((len(t_s), 6))

    def tension_at(self, cable: int, t_s: Array) -> Array:
        wave = self.amplitude_n * np.sin(2 * np.pi * self.frequency_hz * t_s)
        return np.asarray(5.0 + 2.0 * cable + wave + self.slope_n_per_s * t_s)


@dataclass
class NoisyExposer:
    """Small pictures of noise."""

    generator: np.random.Generator = field(default_factory=lambda: np.random.default_rng(1))
    source: str = "simulated"
    width_px: int = 32
    height_px: int = 24
    fps: float = 16.0
    exposure_s: float = 0.005

    def expose(self, t_mid_s: float) -> NDArray[np.uint8]:
        shape = (self.height_px, self.width_px)
        return self.generator.integers(0, 255, shape, dtype=np.uint8)


@dataclass
class Conversation:
    """A line with a script: what must be sent, byte for byte, and what then comes."""

    pairs: Sequence[tuple[bytes, bytes]]
    line: LineSettings = field(default_factory=LineSettings)
    clock: Clock = field(default_factory=lambda: VirtualClock(EPOCH))
    name: str = "script"

    def __post_init__(self) -> None:
        self._waiting = b""
        self._turn = 0

    def write(self, data: bytes) -> None:
        assert self._turn < len(self.pairs), f"{data!r} was sent after the end of the script"
        expected, answer = self.pairs[self._turn]
        assert data == expected
        self._waiting += answer
        self._turn += 1

    def read(self, count: int, deadline_s: float) -> Received:
        data, self._waiting = self._waiting[:count], self._waiting[count:]
        if len(data) < count:
            self.clock.sleep_until(deadline_s)
        return Received(data, self.clock.monotonic_s())

    def discard(self) -> bytes:
        data, self._waiting = self._waiting, b""
        return data

    def drain(self, quiet_s: float) -> bytes:
        self.clock.sleep_until(self.clock.monotonic_s() + quiet_s)
        return self.discard()

    def close(self) -> None:
        pass

    @property
    def over(self) -> bool:
        return self._turn == len(self.pairs) and not self._waiting


def virtual_clock() -> VirtualClock:
    return VirtualClock(EPOCH)


def with_bus(rig: Rig, **keys: object) -> Rig:
    return rig.model_copy(update={"bus": rig.bus.model_copy(update=keys)})


def without_noise(rig: Rig) -> Rig:
    cables = tuple(
        cable.model_copy(update={"amplifier": cable.amplifier.model_copy(update={"noise_n": 0.0})})
        for cable in rig.cable
        if cable.amplifier is not None
    )
    return rig.model_copy(update={"cable": cables})


def simulated_line(
    rig: Rig,
    platform: WavePlatform | None = None,
    *,
    faults: LineFaults | None = None,
    clock: VirtualClock | None = None,
    seed: int = 0,
    strange: Collection[int] = (),
) -> tuple[SimulatedBus, MemoryTransport]:
    """The rig's nodes on a line in memory; the run's origin is at once."""
    clock = clock or virtual_clock()
    platform = platform or WavePlatform()
    line = LineSettings(rig.bus.baud, rig.bus.parity)
    bus = SimulatedBus(simulated_nodes(rig, platform, clock.now_s, seed, strange), line, faults)
    for node in bus.nodes:
        node.signal.begin(clock.now_s)
    return bus, MemoryTransport(bus, line, clock)


class HeldUp:
    """A line in memory that holds answers up, those behind in order, as a busy computer does.

    `held_s(request)` tells how long what answers a request is held, in s.
    """

    def __init__(self, inner: MemoryTransport, held_s: Callable[[bytes], float]) -> None:
        self._inner = inner
        self._held_s = held_s

    def __getattr__(self, name: str) -> object:
        return getattr(self._inner, name)

    def write(self, data: bytes) -> None:
        bus = self._inner._far_end
        free_s = self._inner.clock.monotonic_s() + self._held_s(data)
        bus._answer_free_s = max(bus._answer_free_s, free_s)
        self._inner.write(data)


def motion(duration_s: float) -> Excitation:
    rest_s = min(0.25, duration_s / 4)
    return Excitation(rest_s=rest_s, motion_s=duration_s - 2 * rest_s, ramp_s=0.0)


def record_virtually(
    rig: Rig,
    folder: Path,
    duration_s: float,
    *,
    platform: WavePlatform | None = None,
    camera: bool = True,
    seed: int = 1,
    faults: LineFaults | None = None,
    strange: Collection[int] = (),
) -> Recording:
    clock = virtual_clock()
    machine = assemble(
        rig,
        platform or WavePlatform(),
        NoisyExposer() if camera else None,
        clock,
        seed=seed,
        faults=faults,
        strange=strange,
    )
    excitation = motion(duration_s)
    return record(
        rig, rig_text(), folder, excitation=excitation, clock=clock, seed=seed, machine=machine
    )


def at_origin(machine: Machine, act: Callable[[float], None]) -> None:
    """Have `act(origin_s)` done when the run begins."""
    begin = machine.begin

    def act_and_begin(origin_s: float) -> None:
        act(origin_s)
        begin(origin_s)

    machine.begin = act_and_begin


def record_spoiled(
    rig: Rig,
    folder: Path,
    duration_s: float,
    rates: dict[str, float],
    *,
    platform: WavePlatform | None = None,
    seed: int = 3,
    strange: Collection[int] = (),
) -> tuple[Recording, LineFaults]:
    """A recording over a line that spoils bytes, each kind at its rate, from the origin on."""
    faults = LineFaults(np.random.default_rng(seed))
    clock = virtual_clock()
    machine = assemble(
        rig, platform or WavePlatform(), None, clock, seed=1, faults=faults, strange=strange
    )
    at_origin(machine, lambda _: vars(faults).update(rates))
    recording = record(
        rig, rig_text(), folder, excitation=motion(duration_s), clock=clock, machine=machine
    )
    return recording, faults


def rig_text() -> str:
    from cdpr8.rigfile import packaged_rig_path

    return packaged_rig_path().read_text(encoding="utf-8")


def all_true(run: Run) -> bool:
    """Whether every good value is the tension of its own cable, within 8 sigma of its noise."""
    good = (run.tension["status"] & int(BAD_TENSION)) == 0
    rows = run.tension[good]
    return bool((np.abs(rows["tension_n"] - 5.0 - 2.0 * rows["cable"]) < 0.04).all())
