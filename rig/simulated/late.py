"""A platform that is simulated while the amplifiers are being set up."""

import threading
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Platform(Protocol):
    """What moves: `rig.simulated.plant.PlatformTrajectory`, or a stand-in in tests."""

    def pose_at(self, t_s: Array) -> Array:
        """Poses at times of the run, shape (n, 6), m and rad."""
        ...

    def tension_at(self, cable: int, t_s: Array) -> Array:
        """Tension of one cable, 1 to 8, at times of the run, shape (n,), N."""
        ...


class LatePlatform:
    """At rest until its motion is needed; then the one that is being simulated on a thread.

    Parameters
    ----------
    simulate
        Makes the platform; takes seconds.
    pretension_n
        Tensions at rest, cable by cable.
    """

    def __init__(self, simulate: Callable[[], Platform], pretension_n: Sequence[float]) -> None:
        self._pretension_n = tuple(pretension_n)
        self._platform: Platform | None = None
        self._failure: Exception | None = None
        self._thread = threading.Thread(
            target=self._run, args=(simulate,), name="platform", daemon=True
        )
        self._thread.start()

    def wait(self) -> Platform:
        """The platform, as soon as it is ready.

        Raises
        ------
        Exception
            What its simulation raised.
        """
        self._thread.join()
        if self._platform is None:
            raise self._failure or RuntimeError("the platform's simulation gave nothing")
        return self._platform

    def pose_at(self, t_s: Array) -> Array:
        """Poses at times of the run."""
        return self.wait().pose_at(t_s)

    def tension_at(self, cable: int, t_s: Array) -> Array:
        """Tension of one cable; until the run begins all times are 0, at rest."""
        if self._platform is None and not np.any(t_s):
            return np.full(np.shape(t_s), self._pretension_n[cable - 1])
        return self.wait().tension_at(cable, t_s)

    def _run(self, simulate: Callable[[], Platform]) -> None:
        try:
            self._platform = simulate()
        except Exception as failure:  # raised by `wait`, on the thread that needs the platform
            self._failure = failure
