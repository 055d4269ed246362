"""The simulated bus behind a pseudo-terminal, paced in real time: pyserial's whole path is real."""

import os
import select
import threading
import tty
from collections import deque
from collections.abc import Sequence
from pathlib import Path

from cdpr8.clock import Clock
from rig.schedule import prefer_this_thread
from rig.simulated.bus import SimulatedBus
from rig.transport import Chunk

MOST_LATENESS_S = 0.002
"""Lateness of this thread beyond which it is the computer's trouble, not to be made up for."""

AWAKE_S = 150e-6
"""Before an answer is due this thread no longer sleeps: to be woken may take as long. For values
sent unasked it does sleep: nobody waits for them, and there are eight such threads."""

WRITE_S = 6e-6
"""How long it takes this thread to write, which no line does: so much earlier it begins."""

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
    link
        A lasting name for it: a replugged pseudo-terminal has another path.

    Attributes
    ----------
    path
        What to open as a serial port.
    """

    def __init__(self, bus: SimulatedBus, clock: Clock, link: Path | None = None) -> None:
        self._bus = bus
        self._clock = clock
        self._link = link
        self.plug()

    def plug(self) -> None:
        """Make the port appear."""
        # The slave stays open here, or the master would fail whenever no client has it open.
        self._master, self._slave = os.openpty()
        tty.setraw(self._master)
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        if self._link is not None:
            self._link.unlink(missing_ok=True)
            self._link.symlink_to(self.path)
            self.path = str(self._link)
        self._wake, self._waker = os.pipe()
        self._writes: deque[float] = deque()
        self._thread = threading.Thread(target=self._serve, name="simulated bus", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Unplug: whoever has the port open sees it vanish."""
        if self._thread.is_alive():
            os.write(self._waker, b".")
            self._thread.join()
        for descriptor in (self._master, self._slave, self._wake, self._waker):
            os.close(descriptor)
        if self._link is not None:
            self._link.unlink(missing_ok=True)

    def _serve(self) -> None:
        # Eight lines of one node each would take a third of a core more, and nobody waits for them.
        prefer_this_thread(real_time=len(self._bus.nodes) > 1)
        ends = (self._master, self._wake)
        pending: deque[Chunk] = deque()
        streaming = self._bus.streaming
        while True:
            # What can be done beforehand is: who reads what is written waits for this thread to
            # sleep again, as Python runs one thread at a time.
            while pending and pending[0].last_s - WRITE_S <= self._clock.monotonic_s():
                self._write(pending.popleft().data)
            if streaming and not pending:
                pending, streaming = self._spoken()
            ready, _, _ = select.select(ends, (), (), self._wait_s(pending, streaming))
            if self._wake in ready:
                return
            if self._master in ready:
                data = os.read(self._master, 4096)
                self._bus.hear(data, self._started_s())
                pending, streaming = self._spoken()

    def _spoken(self) -> tuple[deque[Chunk], bool]:
        """What the bus sends soon, and whether it will send more unasked."""
        pending = self._bus.speak(self._clock.monotonic_s() + STREAM_LOOK_S)
        return pending, self._bus.streaming

    def written(self, now_s: float) -> None:
        """Note when the master hands bytes over, before it does."""
        self._writes.append(now_s)

    def _started_s(self) -> float:
        """When what was just read began to travel.

        This thread wakes up late by some tens of microseconds, which no line does: where the
        master said when it wrote, that is the time.
        """
        now_s = started_s = self._clock.monotonic_s()
        while self._writes:
            started_s = min(started_s, self._writes.popleft())
        return max(started_s, now_s - MOST_LATENESS_S)

    def _wait_s(self, pending: Sequence[Chunk], streaming: bool) -> float | None:
        if not pending:
            return STREAM_LOOK_S if streaming else None
        until_due_s = pending[0].last_s - self._clock.monotonic_s()
        return max(0.0, until_due_s - (0.0 if streaming else AWAKE_S))

    def _write(self, data: bytes) -> None:
        """A line does not wait: what the reader's buffer does not take is lost (overrun)."""
        try:
            os.write(self._master, data)
        except BlockingIOError:
            return
