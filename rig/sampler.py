"""Tensions outside a recording: for zeros and for setting the pretension."""

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from cdpr8.errors import DeviceError
from cdpr8.rigfile import Rig
from rig.amplifier.frame import BadFrameError
from rig.broadcast import open_bus
from rig.bus import Bus
from rig.machine import Machine
from rig.station import Station
from rig.streaming.port import close_ports, open_ports


class Sampler:
    """Takes values of all cables for some time.

    Parameters
    ----------
    machine
        Opened.
    rig
        Its rig file.
    zeros
        Host-side zeros by cable, in mV/V.
    """

    def __init__(self, machine: Machine, rig: Rig, zeros: dict[int, float]) -> None:
        self._clock = machine.transport.clock
        self._bus: Bus | None = None
        self._ports = open_ports(machine.ports, rig, zeros) if machine.ports else ()
        if self._ports:
            self.stations = tuple(port.station for port in self._ports)
        else:
            self._bus = open_bus(machine.transport, rig, zeros)
            self.stations = self._bus.start()

    def signals_mv_per_v(self, seconds: float) -> dict[int, list[float]]:
        """All values of each cable within so many seconds, not corrected for its zero.

        Raises
        ------
        DeviceError
            A cable gave none.
        """
        found: dict[int, list[float]] = {station.cable: [] for station in self.stations}
        for station, digits in self._values(seconds):
            found[station.cable].append(digits / station.scaling.digits_per_mv_per_v)
        silent = [str(cable) for cable, values in found.items() if not values]
        if silent:
            raise DeviceError(
                f"no value from cable {', '.join(silent)}",
                remedy="check power and wiring; `rig scan` lists who answers",
            )
        return found

    def tensions_n(self, seconds: float) -> dict[int, float]:
        """Mean tension of each cable over so many seconds; cables that gave none are left out."""
        found: dict[int, list[float]] = {}
        for station, digits in self._values(seconds):
            found.setdefault(station.cable, []).append(station.scaling.tension_n(digits))
        # The median: a wrong value that the bus could not tell must not move the winches.
        return {cable: float(np.median(values)) for cable, values in found.items()}

    def close(self) -> None:
        """Stop the amplifiers' output."""
        with suppress(DeviceError):
            if self._bus is not None:
                self._bus.stop()
        close_ports(self._ports)

    def _values(self, seconds: float) -> Iterator[tuple[Station, int]]:
        end_s = self._clock.monotonic_s() + seconds
        while self._clock.monotonic_s() < end_s:
            if self._bus is None:
                yield from self._streamed()
                continue
            for station in self.stations:
                with suppress(BadFrameError):
                    yield station, self._bus.take(station).reading.digits

    def _streamed(self) -> Iterator[tuple[Station, int]]:
        for port in self._ports:
            for value in port.poll()[0]:
                yield port.station, value.reading.digits
        self._clock.sleep_until(self._clock.monotonic_s() + 0.01)
