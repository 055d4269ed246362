"""A recorded series, from a table of comma-separated values."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from model.motion import Command
from model.motions.windowed import Times, Windowed

Array = NDArray[np.float64]

COLUMNS = ("x_m", "y_m", "z_m", "roll_deg", "pitch_deg", "yaw_deg")
"""Of a recorded series, as in pose.csv."""

SPLINE_DEGREE = 5
"""X*'' has then two continuous derivatives, which an 8th-order method needs to keep its order
between samples better than the samples deserve."""


@dataclass(frozen=True, eq=False)
class Recorded(Windowed):
    """A recorded series, between its samples a spline of degree 5.

    Parameters
    ----------
    samples_s
        Times, increasing, from 0, shape (n,).
    poses
        X, Y, Z in m and roll, pitch, yaw in rad, shape (n, 6).
    """

    samples_s: Array
    poses: Array
    _splines: list[Any] = field(default_factory=list, init=False, repr=False)

    def __post_init__(self) -> None:
        from scipy.interpolate import make_interp_spline

        spline = make_interp_spline(self.samples_s, self.poses, k=SPLINE_DEGREE)
        self._splines.extend([spline, spline.derivative(1), spline.derivative(2)])

    @classmethod
    def from_csv(
        cls, path: Path, start_s: float = 0.0, ramp_s: float = 0.0, rest_s: float = 0.0
    ) -> Self:
        """Read a series: t_s and any of x_m, y_m, z_m, roll_deg, pitch_deg, yaw_deg.

        Parameters
        ----------
        path
            The file; its first sample is the start of the motion.
        start_s, ramp_s, rest_s
            Rest before, fading in and out, rest after.

        Raises
        ------
        DataError
            The file is missing, or holds no such series.
        """
        samples_s, poses = _read_series(path)
        motion_s = float(samples_s[-1])
        return cls(samples_s, poses, times=Times(start_s, motion_s, ramp_s, rest_s))

    def shape(self, tau: Array) -> Command:
        """The series and its derivatives."""
        inside = np.clip(tau, self.samples_s[0], self.samples_s[-1])
        value, rate, acceleration = (np.asarray(spline(inside)) for spline in self._splines)
        return value, rate, acceleration


def _read_series(path: Path) -> tuple[Array, Array]:
    import pandas as pd

    try:
        frame = pd.read_csv(path)
    except (OSError, ValueError) as error:
        raise DataError(
            f"cannot be read: {error}", where=str(path), allowed="a table of comma-separated values"
        ) from None
    given = [name for name in COLUMNS if name in frame]
    if "t_s" not in frame or not given:
        raise DataError(
            f"has the columns {', '.join(map(str, frame.columns))}",
            where=str(path),
            allowed=f"t_s and at least one of {', '.join(COLUMNS)}",
        )
    try:
        numbers = frame[["t_s", *given]].to_numpy(dtype=float)
    except ValueError as error:
        raise DataError(f"holds what is no number: {error}", where=str(path)) from None
    _check_series(numbers, path)
    poses = np.zeros((len(numbers), 6))
    for name, values in zip(given, numbers[:, 1:].T, strict=True):
        poses[:, COLUMNS.index(name)] = np.deg2rad(values) if name.endswith("_deg") else values
    return numbers[:, 0] - numbers[0, 0], poses


def _check_series(numbers: Array, path: Path) -> None:
    """Refuse gaps, and times that do not increase; rows are told as lines of the file."""
    bad = np.flatnonzero(~np.isfinite(numbers).all(axis=1))
    if bad.size:
        raise DataError(
            "an empty or infinite value", where=f"{path}:{bad[0] + 2}", remedy="drop that row"
        )
    back = np.flatnonzero(np.diff(numbers[:, 0]) <= 0)
    if back.size:
        raise DataError(
            f"t_s is {numbers[back[0] + 1, 0]:g} after {numbers[back[0], 0]:g}",
            where=f"{path}:{back[0] + 3}",
            allowed="increasing times",
        )
    if len(numbers) <= SPLINE_DEGREE:
        raise DataError(
            f"has {len(numbers)} samples", where=str(path), allowed=f"more than {SPLINE_DEGREE}"
        )
