"""Putting the simulated rig together, and its entry point."""

import os
from collections.abc import Callable, Collection

import numpy as np
from numpy.typing import NDArray

from cdpr8.clock import Clock, VirtualClock
from cdpr8.rigfile import Excitation, Rig
from rig.amplifier.frame import FrameFormat
from rig.amplifier.profile import FIT
from rig.amplifier.scaling import Scaling
from rig.assignment import amplifiers, line_settings
from rig.camera import Camera
from rig.machine import Machine
from rig.simulated.bus import SimulatedBus
from rig.simulated.exposures import Exposer, ExposureSequence
from rig.simulated.faults import LineFaults
from rig.simulated.late import LatePlatform, Platform
from rig.simulated.node import SimulatedNode
from rig.simulated.signal import Array, Crystal, NodeSignal
from rig.simulated.stranger import STRANGE, StrangeNode
from rig.transport import MemoryTransport, Transport, TwoWire

CRYSTAL_PPM = 50.0
"""Crystals of the nodes are off by up to this much, either way."""


def open_rig(
    rig: Rig,
    excitation: Excitation,
    clock: Clock,
    *,
    seed: int = 0,
    platform: Platform | None = None,
    friction_n: NDArray[np.float64] | None = None,
) -> Machine:
    """Open the simulated rig.

    Parameters
    ----------
    rig
        The machine to simulate.
    excitation
        The motion it performs, from the run's origin on.
    clock
        Real: the amplifiers hang on a pseudo-terminal, or in memory where there are none.
        Virtual: in memory; the transport moves this clock, the camera has one of its own.
    seed
        Settles noise, crystals and pictures.
    platform
        What moves; None simulates it.
    friction_n
        Coulomb friction at each pulley, shape (8,), in N, where `platform` is None; None takes
        the simulated rig's own.

    Returns
    -------
    Machine
        For `rig.recorder.record`.
    """
    ready: Callable[[], object] = _at_once
    if platform is None:

        def simulate() -> Platform:
            from rig.simulated.ahead import simulate_ahead

            return simulate_ahead(rig, excitation, friction_n)

        if isinstance(clock, VirtualClock):
            platform = simulate()
        else:
            rest_n = [float(cable.pretension_n.value) for cable in rig.cable]
            platform = late = LatePlatform(simulate, rest_n)
            ready = late.wait
    exposer: Exposer | None = None
    prepare_camera: Callable[[], object] = _at_once
    camera = rig.camera
    if camera is not None and rig.plate is not None and camera.source == "simulated":
        from rig.simulated.camera import SimulatedCamera

        pictures = SimulatedCamera(
            camera,
            rig.plate,
            platform.pose_at,
            np.random.default_rng(np.random.SeedSequence([seed, _CAMERA_STREAM])),
            centre_of_mass_m=rig.platform.centre_of_mass_m.value,
        )
        exposer, prepare_camera = pictures, pictures.prepare
    machine = assemble(rig, platform, exposer, clock, seed=seed)

    def prepare() -> None:
        prepare_camera()
        ready()

    machine.ready = prepare
    return machine


def _at_once() -> None:
    """Nothing to wait for."""


def assemble(
    rig: Rig,
    platform: Platform,
    exposer: Exposer | None,
    clock: Clock,
    *,
    seed: int = 0,
    faults: LineFaults | None = None,
    strange: Collection[int] = (),
) -> Machine:
    """The simulated rig from its parts.

    Parameters
    ----------
    rig
        Whose amplifiers hang on the bus.
    platform
        What moves.
    exposer
        Makes the pictures; None leaves the camera out.
    clock, seed
        As in `open_rig`.
    faults
        What the line does to bytes.
    strange
        Cables whose amplifier is of a type that nobody knows.
    """
    nodes = simulated_nodes(rig, platform, clock.monotonic_s(), seed, strange)
    # One line for all amplifiers, or one for each.
    groups = [(node,) for node in nodes] if rig.bus.streaming else [nodes]
    lines = [
        _transport(SimulatedBus(group, line_settings(rig), faults, echo=rig.bus.echo), clock)
        for group in groups
    ]
    transports = tuple(TwoWire(transport) if rig.bus.echo else transport for transport, _ in lines)
    camera: Camera | None = None
    if exposer is not None:
        own = VirtualClock(clock.epoch, clock.now_s) if isinstance(clock, VirtualClock) else clock
        camera = ExposureSequence(exposer, own)

    def begin(origin_s: float) -> None:
        for node in nodes:
            node.signal.begin(origin_s)

    def close() -> None:
        for _, close_line in lines:
            close_line()

    return Machine(
        transport=transports[0],
        ports=transports if rig.bus.streaming else (),
        camera=camera,
        simulated=True,
        motion_known=True,
        begin=begin,
        close=close,
    )


def simulated_nodes(
    rig: Rig, platform: Platform, power_on_s: float, seed: int, strange: Collection[int] = ()
) -> tuple[SimulatedNode, ...]:
    """A rig file's amplifiers, each on its own crystal; on `strange` cables of no known type."""
    format_ = FrameFormat()
    nodes: list[SimulatedNode] = []
    for cable, amplifier in amplifiers(rig).items():
        draws = np.random.default_rng(np.random.SeedSequence([seed, _NODE_STREAM, cable]))
        crystal = Crystal(
            power_on_s, phase=draws.uniform(), ppm=draws.uniform(-CRYSTAL_PPM, CRYSTAL_PPM)
        )
        signal = NodeSignal(
            _tension_of(platform, cable),
            Scaling.of(amplifier, format_),
            STRANGE if cable in strange else FIT,
            crystal,
            amplifier.noise_n,
            (seed, cable),
        )
        nodes.append(
            (StrangeNode if cable in strange else SimulatedNode)(
                signal,
                amplifier.address,
                amplifier.serial_number or f"SIM{cable:04d}",
                baud=rig.bus.baud,
                parity=1 if rig.bus.parity == "even" else 0,
            )
        )
    return tuple(nodes)


def _tension_of(platform: Platform, cable: int) -> Callable[[Array], Array]:
    return lambda t_s: platform.tension_at(cable, t_s)


def _transport(bus: SimulatedBus, clock: Clock) -> tuple[Transport, Callable[[], None]]:
    """The line to a simulated bus, and how it is given back."""
    if isinstance(clock, VirtualClock) or not hasattr(os, "openpty"):
        memory = MemoryTransport(bus, bus.line, clock, "simulated bus")
        return memory, memory.close
    from rig.simulated.pseudo_terminal import PseudoTerminal
    from rig.transport import open_serial_port

    terminal = PseudoTerminal(bus, clock)
    transport = open_serial_port(terminal.path, bus.line, clock)
    transport.on_write = terminal.written

    def close() -> None:
        transport.close()
        terminal.close()

    return transport, close


_CAMERA_STREAM = 1
_NODE_STREAM = 2
"""Names of the streams of random numbers drawn from one seed."""
