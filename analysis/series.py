"""What was measured, as series: one angle and eight tensions, each about its own rest."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analysis.noise_floor import noise_floor
from cdpr8 import CABLES
from cdpr8.errors import DataError
from cdpr8.runfolder import FrameFlag, Run

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

MIN_REST_SAMPLES = 8
"""Fewer samples than this make neither a mean nor a standard deviation to rely on."""

MIN_SAMPLES = 16


@dataclass(frozen=True)
class Series:
    """One quantity over time, as the variation about its value at rest.

    Attributes
    ----------
    name
        ``pitch`` (or the axis that is moved), ``tension 1`` to ``tension 8``.
    unit
        ``deg`` or ``N``.
    t_s
        Sample times, shape (n,); tensions on the tension clock, the angle on the camera's.
    value
        Measured value less its mean at rest, shape (n,).
    noise
        Standard deviation of one sample at rest.
    noise_known
        False where the run has no rest before its motion and `noise` is an estimate from that.
    """

    name: str
    unit: str
    t_s: Array
    value: Array
    noise: float
    noise_known: bool

    def within(self, window_s: tuple[float, float]) -> "Series":
        """The samples of a time window."""
        inside = (self.t_s >= window_s[0]) & (self.t_s <= window_s[1])
        return Series(
            self.name,
            self.unit,
            self.t_s[inside],
            self.value[inside],
            self.noise,
            self.noise_known,
        )


def measured_angle(run: Run, pose: "pd.DataFrame", axis: str) -> Series:
    """The moved angle, in deg, from the poses of the video.

    Parameters
    ----------
    run
        The run.
    pose
        Columns of pose.csv.
    axis
        ``roll``, ``pitch`` or ``yaw``.

    Raises
    ------
    DataError
        Too few frames have a pose.
    """
    repeated = (pose["flags"].to_numpy(dtype=int) & int(FrameFlag.REPEATED)) != 0
    seen = pose[pose[f"{axis}_deg"].notna() & ~repeated]
    return _series(run, axis, "deg", seen["t_s"], seen[f"{axis}_deg"], "frames with a pose")


def measured_tension(run: Run, cable: int) -> Series:
    """The tension of cable 1 to 8, in N, from its good samples.

    Raises
    ------
    DataError
        The cable has too few good samples.
    """
    good = run.cable_tension(cable)
    return _series(
        run, f"tension {cable}", "N", good["t_s"], good["tension_n"], f"samples of cable {cable}"
    )


def measured_cables(run: Run) -> tuple[int, ...]:
    """Cables with good samples; the others are dead or were never connected."""
    return tuple(c for c in range(1, CABLES + 1) if len(run.cable_tension(c)) >= MIN_SAMPLES)


def _series(
    run: Run, name: str, unit: str, times: "pd.Series[float]", values: "pd.Series[float]", of: str
) -> Series:
    t_s = np.asarray(times, dtype=np.float64)
    value = np.asarray(values, dtype=np.float64)
    if len(t_s) < MIN_SAMPLES:
        raise DataError(
            f"{len(t_s)} usable {of}",
            where=str(run.folder),
            allowed=f"at least {MIN_SAMPLES}",
            remedy="see `vision track` and events.csv for what was lost",
        )
    excitation = run.start.excitation
    at_rest = (t_s < excitation.start_s) & run.start.motion_start_known
    if np.count_nonzero(at_rest) >= MIN_REST_SAMPLES:
        rest = value[at_rest]
        return Series(name, unit, t_s, value - rest.mean(), float(rest.std(ddof=1)), True)
    # Without rest the middle of the motion stands in for it.
    middle = (value.max() + value.min()) / 2.0
    noise = noise_floor(t_s, value, excitation)
    return Series(name, unit, t_s, value - middle, noise, False)
