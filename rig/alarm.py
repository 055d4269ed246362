"""An overload said aloud, with the bell, and a command of the user's; the bus never waits for it.

The toolkit has no authority over the motion of a machine: whoever has, is told.
"""

import queue
import subprocess
import threading
from collections.abc import Callable
from contextlib import suppress


class OverloadAlarm:
    """Tells, and runs a command, each on a thread of its own: a terminal may stand still.

    Parameters
    ----------
    tell
        Prints one line and rings; may stall or fail.
    command
        Run by the shell once an overload begins, with CDPR8_CABLE and CDPR8_OVERLOAD set;
        None runs nothing.
    """

    def __init__(self, tell: Callable[[str], None], command: str | None = None) -> None:
        self._tell = tell
        self._command = command
        self._to_run: queue.SimpleQueue[tuple[int, str]] = queue.SimpleQueue()
        self._to_tell: queue.SimpleQueue[tuple[int, str]] = queue.SimpleQueue()
        for work in (self._run, self._speak):
            threading.Thread(target=work, name="alarm", daemon=True).start()

    def __call__(self, cable: int, words: str) -> None:
        """Raise the alarm; returns at once."""
        self._to_run.put((cable, words))
        self._to_tell.put((cable, words))

    def _speak(self) -> None:
        while True:
            cable, words = self._to_tell.get()
            with suppress(OSError, ValueError):  # the terminal was closed
                self._tell(f"OVERLOAD cable {cable}: {words}")

    def _run(self) -> None:
        while True:
            cable, words = self._to_run.get()
            if self._command is None:
                continue
            # Beside this thread: the next alarm does not wait for a command that takes its time.
            threading.Thread(
                target=subprocess.run,
                args=(self._command,),
                kwargs={"shell": True, "check": False, "env": _environment(cable, words)},
                daemon=True,
            ).start()


def _environment(cable: int, words: str) -> dict[str, str]:
    import os

    return {**os.environ, "CDPR8_CABLE": str(cable), "CDPR8_OVERLOAD": words}
