"""Opening what a rig file names: the amplifiers' line and the camera, real or simulated."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import metadata
from typing import Protocol

from cdpr8.clock import Clock, RealClock, VirtualClock
from cdpr8.errors import DeviceError, RigFileError
from cdpr8.rigfile import Excitation, Rig
from rig.assignment import amplifiers
from rig.camera import Camera, CaptureCamera
from rig.transport import Transport

ENTRY_POINTS = "cdpr8.rigs"
"""Entry-point group of rigs that are not hardware; the port's name chooses."""


@dataclass
class Machine:
    """An opened rig.

    Attributes
    ----------
    transport
        The amplifiers' line.
    camera
        None where the rig has none.
    simulated
        Whether the data are made, not measured.
    motion_known
        Whether this machine performs the excitation itself, on the run's clock.
    begin
        Told the run's origin on the clock's seconds, before the first sample.
    close
        Gives everything back.
    ready
        Called before anything is written: waits for, and tells the faults of, what was begun when
        the machine was opened.
    ports
        Where each amplifier has a line of its own: those of all cables, in order; `transport` is
        the first of them.
    """

    transport: Transport
    camera: Camera | None
    simulated: bool
    motion_known: bool
    begin: Callable[[float], None]
    close: Callable[[], None]
    ports: tuple[Transport, ...] = ()
    ready: Callable[[], object] = lambda: None


class OpenRig(Protocol):
    """What an entry point of the group ``cdpr8.rigs`` must be."""

    def __call__(self, rig: Rig, excitation: Excitation, clock: Clock, *, seed: int) -> Machine:
        """Open the rig; `seed` settles everything random about it."""
        ...


def open_machine(rig: Rig, excitation: Excitation, clock: Clock, *, seed: int = 0) -> Machine:
    """Open the rig that a rig file describes.

    Parameters
    ----------
    rig
        ``bus.port`` is a serial port, or the name of an entry point such as ``simulated``.
    excitation
        The motion that a simulated rig performs.
    clock
        Of all times; hardware takes a real one.
    seed
        Of a simulated rig.

    Raises
    ------
    DeviceError
        A port or camera is missing, taken, or not what the rig file says.
    """
    for entry in metadata.entry_points(group=ENTRY_POINTS):
        if entry.name == rig.bus.port:
            opener: OpenRig = entry.load()
            return opener(rig, excitation, clock, seed=seed)
    if isinstance(clock, VirtualClock):
        raise DeviceError(
            f"port {rig.bus.port!r} is hardware, which keeps no virtual time",
            remedy="leave --virtual out, or add --simulated",
        )
    return _open_hardware(rig, clock)


def open_line(rig: Rig) -> Transport:
    """The amplifiers' line alone, without the camera, on the computer's clock.

    Parameters
    ----------
    rig
        As for `open_machine`; a bus, not one port for each amplifier.

    Raises
    ------
    DeviceError
        The port is missing or taken.
    """
    alone = rig.model_copy(update={"camera": None})
    return open_machine(alone, alone.excitation, RealClock()).transport


def _open_hardware(rig: Rig, clock: Clock) -> Machine:
    from rig.assignment import line_settings
    from rig.transport import TwoWire, open_serial_port

    lines: list[Transport] = []

    def close_lines() -> None:
        for line in lines:
            line.close()

    try:
        for path in _paths(rig):
            opened: Transport = open_serial_port(path, line_settings(rig), clock)
            lines.append(TwoWire(opened) if rig.bus.echo else opened)
    except Exception:
        close_lines()
        raise
    camera: Camera | None = None
    try:
        if rig.camera is not None and rig.camera.source != "simulated":
            camera = CaptureCamera(rig.camera, clock)
    except Exception:
        close_lines()
        raise

    def close() -> None:
        close_lines()
        if camera is not None:
            camera.close()

    return Machine(
        transport=lines[0],
        ports=tuple(lines) if rig.bus.streaming else (),
        camera=camera,
        simulated=False,
        motion_known=False,
        begin=lambda _: None,
        close=close,
    )


def _paths(rig: Rig) -> list[str]:
    if not rig.bus.streaming:
        return [rig.bus.port]
    found = amplifiers(rig)
    for cable, amplifier in found.items():
        if not amplifier.port:
            raise RigFileError(
                f"cable {cable} has no port, and [bus] streaming = true",
                where=rig.name,
                remedy="give its amplifier `port = ...`, or set streaming = false",
            )
    return [amplifier.port for amplifier in found.values()]
