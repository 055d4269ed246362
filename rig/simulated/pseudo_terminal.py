"""The simulated bus behind a pseudo-terminal, paced in real time: pyserial's whole path is real."""

import os
import select
import threading
import tty

from cdpr8.clock import Clock
from rig.simulated.bus import SimulatedBus

MOST_LATENESS_S = 0.002
"""Lateness of this thread beyond which it is the computer's trouble, not to be made up for."""

STREAM_LOOK_S = 0.005
"""How far ahead values sent unasked are looked for."""


class PseudoTerminal:
    """A pseudo-terminal with a simulated bus on the far side, served by a thread.

    Parameters
    ----------
    bus
        Hears and speaks.
    clock
        A real clock.

    Attributes
    ----------
    path
        What to open as a serial port.
    """

    def __init__(self, bus: SimulatedBus, clock: Clock) -> None:
        self._bus = bus
        self._clock = clock
        # The slave stays open here, or the master would fail whenever no client has it open.
        self._master, self._slave = os.openpty()
        tty.setraw(self._master)
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        self._wake, self._waker = os.pipe()
        self._late_s = 0.0
        self._thread = threading.Thread(target=self._serve, name="simulated bus", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Unplug: whoever has the port open sees it vanish."""
        if self._thread.is_alive():
            os.write(self._waker, b".")
            self._thread.join()
        for descriptor in (self._master, self._slave, self._wake, self._waker):
            os.close(descriptor)

    def _serve(self) -> None:
        while True:
            now_s = self._clock.monotonic_s()
            pending = self._bus.speak(now_s + STREAM_LOOK_S)
            while pending and pending[0].last_s <= now_s:
                chunk = pending.popleft()
                self._late_s = min(now_s - chunk.last_s, MOST_LATENESS_S)
                self._write(chunk.data)
            wait_s = self._wait_s(pending[0].last_s - now_s if pending else None)
            ready, _, _ = select.select([self._master, self._wake], [], [], wait_s)
            if self._wake in ready:
                return
            if self._master in ready:
                data = os.read(self._master, 4096)
                # Our own thread wakes up late by some tens of microseconds, which no line does:
                # the request is timed as if the last answer had been on time.
                self._bus.hear(data, self._clock.monotonic_s() - self._late_s)
                self._late_s = 0.0

    def _wait_s(self, until_due_s: float | None) -> float | None:
        if until_due_s is None:
            streaming = any(node.powered and node.streaming for node in self._bus.nodes)
            return STREAM_LOOK_S if streaming else None
        return max(0.0, until_due_s)

    def _write(self, data: bytes) -> None:
        """A line does not wait: what the reader's buffer does not take is lost (overrun)."""
        try:
            os.write(self._master, data)
        except BlockingIOError:
            return
