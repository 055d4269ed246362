"""An overload said aloud: a bell, a line, and a command of the user's; the bus never waits for it.

The toolkit has no authority over the motion of a machine: whoever has, is told.
"""

import queue
import subprocess
import threading
from collections.abc import Callable


class OverloadAlarm:
    """Rings, prints and runs a command, on a thread of its own.

    Parameters
    ----------
    tell
        Prints one line.
    command
        Run by the shell once an overload begins, with CDPR8_CABLE and CDPR8_OVERLOAD set;
        None runs nothing.
    """

    def __init__(self, tell: Callable[[str], None], command: str | None = None) -> None:
        self._tell = tell
        self._command = command
        self._waiting: queue.SimpleQueue[tuple[int, str]] = queue.SimpleQueue()
        threading.Thread(target=self._serve, name="alarm", daemon=True).start()

    def __call__(self, cable: int, words: str) -> None:
        """Raise the alarm; returns at once."""
        self._waiting.put((cable, words))

    def _serve(self) -> None:
        while True:
            cable, words = self._waiting.get()
            self._tell(f"\aOVERLOAD cable {cable}: {words}")
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
