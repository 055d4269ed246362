"""A user's wish to stop: once is in order, twice is at once, and the third time exits."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class StopRequest:
    """Counts the wishes to stop a recording; Ctrl-C and the like make them while `listening`."""

    def __init__(self) -> None:
        self._count = 0

    @property
    def requested(self) -> bool:
        """End in order: everything that came is written."""
        return self._count > 0

    @property
    def at_once(self) -> bool:
        """End now: frames still waiting for the encoder are given up, the stop record is not."""
        return self._count > 1

    def request(self) -> None:
        """Wish to stop."""
        self._count += 1

    @contextmanager
    def listening(self) -> Iterator[None]:
        """Take Ctrl-C, SIGTERM and SIGHUP (the terminal was closed) as wishes.

        A SIGHUP that is ignored, as under `nohup`, stays so; outside the main thread all do.
        """
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.getsignal(number) for number in _SIGNALS}
        if before.get(_HANGUP) is signal.SIG_IGN:
            del before[_HANGUP]
        for number in before:
            signal.signal(number, self._on_signal)
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _on_signal(self, _: int, __: FrameType | None) -> None:
        self.request()
        if self._count > 2:
            raise KeyboardInterrupt


_HANGUP = getattr(signal, "SIGHUP", signal.SIGTERM)
"""Windows has none."""

_SIGNALS = (signal.SIGINT, signal.SIGTERM, _HANGUP)
