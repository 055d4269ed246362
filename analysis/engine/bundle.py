"""What was recorded, and which stretches of it are looked at."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array


@dataclass(frozen=True)
class Segment:
    """A stretch of time over which channels are looked at together.

    Parameters
    ----------
    start_s, end_s
        From and to.
    fundamental_hz
        The motion repeats at this rate: harmonics of it are fitted, and their slow change. None:
        nothing repeats, and the stretch is resolved into lines of a Fourier series over its length.
    highest_hz
        Nothing faster is looked at; None, and nothing repeats: every sample is, resolved into as
        many lines; samples must then be evenly apart.
    held_out
        Kept back when what was found is fitted once more for the proof.
    sealed
        Kept back from everything but the proof: neither parameters nor causes are found by it.
    name
        What to call it, such as "rest" or "steady".
    """

    start_s: float
    end_s: float
    fundamental_hz: float | None = None
    highest_hz: float | None = None
    held_out: bool = False
    sealed: bool = False
    name: str = ""

    def holds(self, t_s: Array) -> NDArray[np.bool_]:
        """Which times lie in it, of shape (n,); its end does not."""
        return np.asarray((t_s >= self.start_s) & (t_s < self.end_s))


TOGETHER_S = 1.0
"""For so long what the instants of samples are off by together stays as it is."""


@dataclass(frozen=True)
class Bundle:
    """Channels sampled together.

    Parameters
    ----------
    names, units
        Of the channels, length m.
    t_s
        Sample times, shape (n,).
    value
        Shape (n, m).
    covariance
        Of the noise of one sample, shape (m, m); samples are independent.
    segments
        Stretches to look at. Samples outside of all are not used.
    record
        Which recording they belong to, where there are several.
    kind
        Channels of one kind are pictured together, such as "tension" or "pose".
    base_share
        The simulator's own error as a share of the channels' variation, however good its physics.
    tones_hz
        The system's own tones: what is left of a kick long ago cannot be foretold in phase, and so
        lines near a tone, and all above those that the drive cannot reach, name nothing.
    jitter
        What one standard deviation of its instant does to each sample, shape (n, m): the rate at
        which values change there, times that; None: instants are known.
    jitter_unsure
        By which share of itself the square of that may be larger.
    late
        What one standard deviation of that does to each sample by which all instants are off alike
        for `TOGETHER_S`, and by another for the next, shape (n, m): where what measures runs on its
        own, and is asked at times that keep step with it. None: instants are off singly.
    noise_from
        How many samples the covariance was taken from; 0: it is known.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    t_s: Array
    value: Array
    covariance: Array
    segments: tuple[Segment, ...]
    record: str = ""
    kind: str = ""
    base_share: float = 0.0
    tones_hz: tuple[float, ...] = ()
    jitter: Array | None = None
    jitter_unsure: float = 0.0
    late: Array | None = None
    noise_from: int = 0
