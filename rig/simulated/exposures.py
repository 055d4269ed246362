"""The simulated camera in time: one exposure after another on the camera's clock."""

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cdpr8.clock import Clock
from rig.camera import Frame


class Exposer(Protocol):
    """What makes pictures: `rig.simulated.camera.SimulatedCamera`, or a stand-in."""

    source: str
    width_px: int
    height_px: int
    fps: float
    exposure_s: float

    def expose(self, t_mid_s: float) -> NDArray[np.uint8]:
        """The picture, shape (height_px, width_px), of the exposure about a time of the run."""
        ...


class ExposureSequence:
    """A free-running camera: exposures start at whole periods from the run's origin.

    Parameters
    ----------
    exposer
        Makes the pictures.
    clock
        Of the camera.
    """

    def __init__(self, exposer: Exposer, clock: Clock) -> None:
        self._exposer = exposer
        self._clock = clock
        self._origin_s = 0.0
        self._next = 0
        self.source = exposer.source
        self.width_px, self.height_px = exposer.width_px, exposer.height_px
        self.fps, self.exposure_s = exposer.fps, exposer.exposure_s

    @property
    def clock(self) -> Clock:
        """The clock given at the start."""
        return self._clock

    @property
    def next_frame_s(self) -> float:
        """End of the next exposure."""
        return self._mid_s(self._next) + self.exposure_s / 2.0

    def start(self, origin_s: float) -> None:
        """Let the first exposure start at `origin_s`."""
        self._origin_s = origin_s
        self._next = 0

    def next_frame(self) -> Frame | None:
        """Wait for the end of the next exposure; those that were missed meanwhile are counted."""
        newest = math.floor((self._clock.monotonic_s() - self._mid_s(0)) * self.fps)
        dropped = max(0, newest - self._next)
        self._next += dropped
        self._clock.sleep_until(self.next_frame_s)
        mid_s = self._mid_s(self._next)
        self._next += 1
        return Frame(self._exposer.expose(mid_s - self._origin_s), mid_s, dropped)

    def close(self) -> None:
        """Nothing to give back."""

    def _mid_s(self, number: int) -> float:
        return self._origin_s + self.exposure_s / 2.0 + number / self.fps
