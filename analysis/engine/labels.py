"""What each of the numbers is that the lens makes of samples."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array


@dataclass(frozen=True)
class Labels:
    """What each number is, arrays of shape (f,).

    Attributes
    ----------
    bundle, channel, segment
        Places in the system's bundles and in the bundle.
    line
        Harmonic of the drive; in a stretch that does not repeat, the frequency in Hz.
    ringing
        Whether the system rings here: the phase of what is seen is not to be foretold.
    growth
        How much less sure a law is of this line than of the drive's own: its multiple of it.
    quadrature
        0: mean or cosine, 1: sine.
    order
        Degree of the slow change; 0: none.
    held_out
        Whether it is kept back for confirming.
    group
        Numbers of one channel, stretch and line, cosine and sine, share their group; those of its
        slow change have another.
    stretch
        Numbers of one channel and stretch share it.
    samples
        How many samples the stretch has.
    free
        Whether the stretch does not repeat.
    every
        Whether all lines of the stretch are looked at; a band of them shares its group.
    sealed
        Whether nothing but the proof may see it.
    """

    bundle: NDArray[np.int64]
    channel: NDArray[np.int64]
    segment: NDArray[np.int64]
    line: Array
    ringing: NDArray[np.bool_]
    growth: Array
    quadrature: NDArray[np.int64]
    order: NDArray[np.int64]
    held_out: NDArray[np.bool_]
    group: NDArray[np.int64]
    stretch: NDArray[np.int64]
    samples: NDArray[np.int64]
    free: NDArray[np.bool_]
    every: NDArray[np.bool_]
    sealed: NDArray[np.bool_]

    @property
    def series(self) -> NDArray[np.int64]:
        """Numbers of one channel of one bundle share it."""
        return self.bundle * (int(self.channel.max(initial=0)) + 1) + self.channel
