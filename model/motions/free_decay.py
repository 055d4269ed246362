"""Free vibration."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model.motion import Command
from model.motions.pose import Pose

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FreeDecay:
    """Held beside rest, then let go: what follows is the machine's own.

    X* is the pose while it is held and rest from the release on, so that the drive then does what
    it does at rest, which is nothing.

    Parameters
    ----------
    pose
        Where it is held; m and rad.
    hold_s, free_s
        How long it is held, above 0, and how long it is free.
    """

    pose: Pose
    hold_s: float = 0.1
    free_s: float = 10.0
    start_s: float = field(default=0.0, init=False)

    def __post_init__(self) -> None:
        if not min(self.hold_s, self.free_s) > 0:
            raise UsageError(
                f"held for {self.hold_s:g} s, free for {self.free_s:g} s", allowed="both above 0"
            )

    @property
    def disturbed_s(self) -> float:
        """See `Motion`."""
        return self.start_s

    @property
    def duration_s(self) -> float:
        """Held and free."""
        return self.hold_s + self.free_s

    @property
    def steady_window_s(self) -> tuple[float, float]:
        """From the release on."""
        return self.hold_s, self.duration_s

    @property
    def breaks_s(self) -> tuple[float, ...]:
        """The release."""
        return (self.hold_s,)

    def at(self, time_s: Array, within_s: Array | None = None) -> Command:
        """X*, X*' and X*''; see `model.motion.Motion.at`."""
        time_s = np.asarray(time_s, dtype=float)
        within = time_s if within_s is None else within_s
        # Before the start there is no hold yet: the platform is put where it is held.
        held = np.broadcast_to((within >= self.start_s) & (within < self.hold_s), time_s.shape)
        still = np.zeros((*time_s.shape, 6))
        return held[..., None] * np.array(self.pose), still, still.copy()
