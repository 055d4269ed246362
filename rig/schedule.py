"""Running the streams of a recording: in threads on a real clock, in turn on virtual ones."""

import ctypes
import os
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

from rig.stop import StopRequest
from rig.streams import Stream

LOOK_S = 0.1
"""How often the main thread looks whether to stop, and shows how things stand."""

SWITCH_S = 1e-4
"""Longest turn of one thread while another waits: a tenth of one value on the bus."""

PREFERRED_NICE = -10
"""Niceness of the bus's thread; others than the superuser need CAP_SYS_NICE for it."""

PREFERRED_PRIORITY = 1
"""Real-time priority of the bus's thread, the lowest; needs the same, or an RTPRIO limit."""

HANGING_S = 2.0
"""A stream that does not come back from its device is not waited for longer than this."""


def run_by_time(streams: Sequence[Stream], stop: StopRequest) -> None:
    """Step whichever stream is due first, until all are over: the same order every time."""
    active = list(streams)
    while active and not stop.requested:
        stream = min(active, key=lambda each: each.due_s)
        if not stream.step():
            active.remove(stream)


def run_in_threads(
    streams: Sequence[Stream],
    stop: StopRequest,
    failed: Callable[[], BaseException | None],
    look: Callable[[], None] | None,
) -> None:
    """Run each stream on its own thread until all are over.

    Parameters
    ----------
    streams
        Each is stepped by its thread alone. When the first (the bus) is over the others are
        about to be; one that hangs in its device is left behind.
    stop
        Ends all of them after their present step.
    failed
        What else must end them: a writer that failed.
    look
        Called now and then by this thread; it may stall or fail without harm to the data.

    Raises
    ------
    Exception
        The first that a stream, or the writer, raised.
    """
    halt = threading.Event()
    faults: list[BaseException] = []

    def run(stream: Stream) -> None:
        if stream is streams[0]:
            prefer_this_thread()
        try:
            while not halt.is_set() and stream.step():
                pass  # a step is all the work
        except Exception as error:  # raised again below, on the main thread
            faults.append(error)

    threads = [
        threading.Thread(target=run, args=(stream,), name=stream.name, daemon=True)
        for stream in streams
    ]
    with _quick_switches():
        for thread in threads:
            thread.start()
        _attend(threads, stop, halt, lambda: bool(faults) or failed() is not None, look)
    if faults:
        raise faults[0]
    if (failure := failed()) is not None:
        raise failure


def _attend(
    threads: Sequence[threading.Thread],
    stop: StopRequest,
    halt: threading.Event,
    failing: Callable[[], bool],
    look: Callable[[], None] | None,
) -> None:
    """Wait until all threads are over, and make them so where something ends the run."""
    while any(thread.is_alive() for thread in threads):
        threads[0].join(LOOK_S)
        over = not threads[0].is_alive()
        if stop.requested or failing():
            halt.set()
            over = True
        if over:
            for thread in threads:
                thread.join(HANGING_S)
            break
        if look is not None:
            with suppress(Exception):
                look()


@contextmanager
def _quick_switches() -> Iterator[None]:
    """Let the bus have its turn sooner than Python's 5 ms after a thread that computes."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(SWITCH_S)
    try:
        yield
    finally:
        sys.setswitchinterval(before)


def prefer_this_thread(real_time: bool = True) -> None:
    """Let this thread run before others on a busy computer, where the user may ask for that.

    A thread that was woken may have to wait until another's turn is over, 4 ms on many a Linux,
    however little the other is preferred; a real-time one does not (docs/decisions/0013). What it
    starts is not preferred.

    Parameters
    ----------
    real_time
        Whether to ask for that; otherwise, and where it is refused, for a lower niceness.
    """
    if sys.platform == "linux":
        # Linux adds 50 us to each wait to save power.
        ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0)
        policy = os.SCHED_RR | os.SCHED_RESET_ON_FORK
        if real_time:
            with suppress(OSError):
                os.sched_setscheduler(0, policy, os.sched_param(PREFERRED_PRIORITY))
                return
    if hasattr(os, "setpriority"):
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), PREFERRED_NICE)


_PR_SET_TIMERSLACK = 29
"""Of <linux/prctl.h>; for the calling thread, in ns."""
