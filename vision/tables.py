"""The tables of poses: rows from sightings, columns and units, and the file they are written to."""

import math
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.runfolder.tables import POSE, POSE_AXES, Column, FrameFlag, Table
from cdpr8.runfolder.write import Cell, TableWriter
from vision.mounting import PlatformPose
from vision.pose import CameraPose
from vision.tracker import Sighting

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

PLATE_AXES = ("x_m", "y_m", "z_m", "rx_deg", "ry_deg", "rz_deg")
"""Pose of a plate in the camera frame: its origin, and its rotation vector in degrees."""

VIDEO_POSE = Table(
    "pose.csv",
    "Written by `vision track VIDEO`: pose of the plate in the camera frame (x right, y down, "
    "z forward), one row a frame; of independent markers, one row a frame and marker.",
    (
        Column("frame", "integer", "frame number from 0"),
        Column("t_s", "number", "presentation time in the container", "s", True, 6),
        Column("marker", "integer", "marker id, where markers are tracked one by one", "", True),
        *(Column(name, "number", "pose", name.rsplit("_", 1)[1], True, 9) for name in PLATE_AXES),
        *(
            Column(f"sigma_{name}", "number", "standard deviation", name.rsplit("_", 1)[1], True, 9)
            for name in PLATE_AXES
        ),
        Column("markers", "integer", "markers used"),
        Column("reproj_px", "number", "rms reprojection error", "px", True, 4),
        Column("ratio", "number", "second-best over best reprojection error", "", True, 3),
        Column("flags", "integer", "frame flag bits"),
        Column("blur_px", "number", "standard deviation of the point spread", "px", True, 3),
    ),
)

Row = dict[str, Cell]


def common_cells(frame: int, t_s: float, sighting: Sighting, flags: FrameFlag) -> Row:
    """What every pose table has: which frame, how it was seen, and the flags."""
    estimate = sighting.estimate
    return {
        "frame": frame,
        "t_s": t_s,
        "markers": sighting.markers,
        "reproj_px": estimate.pose.reprojection_px if estimate else float("nan"),
        "ratio": estimate.ratio if estimate else float("nan"),
        "flags": int(sighting.flags | flags),
        "blur_px": estimate.blur_px if estimate else float("nan"),
    }


def platform_cells(pose: PlatformPose) -> Row:
    """A platform's pose, its standard deviations and correlations."""
    scale = np.array([1.0, 1.0, 1.0, *np.rad2deg([1.0, 1.0, 1.0])])
    sigma = np.sqrt(np.diag(pose.covariance))
    cells = _axes(POSE_AXES, pose.values * scale, sigma * scale)
    upper = np.triu_indices(6, 1)  # the order of the columns: combinations of the axes
    names = (column.name for column in POSE.columns if column.name.startswith("corr_"))
    correlation = (pose.covariance / np.outer(sigma, sigma))[upper]
    cells.update(zip(names, correlation.tolist(), strict=True))
    return cells


def plate_cells(pose: CameraPose) -> Row:
    """A plate's pose in the camera frame and its standard deviations.

    The sigmas of rx, ry and rz are those of a small rotation about the camera's axes.
    """
    import cv2

    vector = np.rad2deg(np.asarray(cv2.Rodrigues(pose.rotation)[0]).ravel())
    sigma = np.sqrt(np.diag(pose.covariance))
    sigma = np.concatenate([sigma[3:], np.rad2deg(sigma[:3])])
    return _axes(PLATE_AXES, np.concatenate([pose.translation, vector]), sigma)


def _axes(names: tuple[str, ...], values: Array, sigma: Array) -> Row:
    cells: Row = dict(zip(names, values.tolist(), strict=True))
    cells.update(zip((f"sigma_{name}" for name in names), sigma.tolist(), strict=True))
    return cells


def as_frame(rows: list[Row], table: Table) -> "pd.DataFrame":
    """Rows as a data frame with the table's columns; what a row leaves out is NaN."""
    import pandas as pd

    frame = pd.DataFrame(rows, columns=list(table.names))
    for column in table.columns:
        integer = column.type == "integer" and not column.optional
        frame[column.name] = frame[column.name].astype("int64" if integer else "float64")
    return frame


def write_poses(frame: "pd.DataFrame", table: Table, path: Path) -> None:
    """Write a table of poses whole, or not at all.

    Parameters
    ----------
    frame
        Its rows.
    table
        Columns and digits.
    path
        Overwritten.

    Raises
    ------
    DataError
        The file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".pose-") as folder:
            writer = TableWriter(Path(folder), table)
            for cells in frame.to_dict("records"):
                writer.append(_whole(cells, table))
            writer.close()
            os.replace(Path(folder) / table.file, path)
    except OSError as error:
        raise DataError(
            f"cannot be written: {error.strerror}", where=str(path), remedy="name another --out"
        ) from None


def _whole(cells: Mapping[Any, Any], table: Table) -> dict[str, Cell]:
    """Integers that pandas holds as floats, as integers; NaN as nothing."""
    row: dict[str, Cell] = {}
    for column in table.columns:
        value = cells[column.name]
        number = float(value) if isinstance(value, int | float) else float("nan")
        if math.isnan(number):
            row[column.name] = None
        else:
            row[column.name] = int(number) if column.type == "integer" else number
    return row
