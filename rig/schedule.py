"""Running the streams of a recording: in threads on a real clock, in turn on virtual ones."""

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress

from rig.stop import StopRequest
from rig.streams import Stream

LOOK_S = 0.1
"""How often the main thread looks whether to stop, and shows how things stand."""

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
        Each is stepped by its thread alone.
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
        try:
            while not halt.is_set() and stream.step():
                pass
        except Exception as error:  # raised again below, on the main thread
            faults.append(error)

    threads = [
        threading.Thread(target=run, args=(stream,), name=stream.name, daemon=True)
        for stream in streams
    ]
    for thread in threads:
        thread.start()
    while any(thread.is_alive() for thread in threads):
        threads[0].join(LOOK_S)
        if not threads[0].is_alive():
            for thread in threads:
                thread.join(LOOK_S)
        if stop.requested or faults or failed() is not None:
            halt.set()
            for thread in threads:
                thread.join(HANGING_S)
            break
        if look is not None:
            with suppress(Exception):
                look()
    if faults:
        raise faults[0]
    if (failure := failed()) is not None:
        raise failure
