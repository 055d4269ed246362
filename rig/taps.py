"""Sync taps: the user taps the platform, which tensions and video both see, and presses Enter."""

import queue
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from cdpr8.clock import RealClock

Taps = queue.SimpleQueue[float]
"""Times of the monotonic clock."""


@contextmanager
def listen_for_taps() -> Iterator[Taps | None]:
    """Take each Enter as a tap; None where standard input is no terminal."""
    if not sys.stdin.isatty():
        yield None
        return
    taps: Taps = queue.SimpleQueue()
    clock = RealClock()

    def listen() -> None:
        for _ in sys.stdin:
            taps.put(clock.monotonic_s())

    threading.Thread(target=listen, name="taps", daemon=True).start()
    yield taps
