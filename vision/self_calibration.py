"""Where the markers really are: plate and poses fitted together to the pixels of many frames.

A print is good to 0.05 mm or so, and a marker glued on by hand to less. Frames in which the plate
moves tell where its markers are relative to each other: every marker gets a shift in its plane and
a turn of its own, every frame a pose and its light, and all are fitted to all pixels (a bundle
adjustment; the frames' own unknowns are eliminated frame by frame). What all markers do together is
the pose of the plate, which the still zero take settles.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.detect import Image
from vision.marker_print import MarkerPrint, print_of
from vision.photometric import align_print, markers_alone, windows_of
from vision.plate import Plate
from vision.pose import CameraPose

Array = NDArray[np.float64]

ROUNDS = 3
LEAST_FRAMES = 5
USUAL_MISPLACEMENT_M = 3e-4
USUAL_TURN_RAD = 0.02
"""How far markers may be from their stated places; also what fixes the plate's own frame."""


@dataclass(frozen=True)
class PlateView:
    """One frame in which the plate was seen.

    Attributes
    ----------
    image
        Grey levels, shape (height, width).
    ids
        The markers seen.
    pose
        The plate's pose in the camera frame.
    """

    image: Image
    ids: tuple[int, ...]
    pose: CameraPose


@dataclass(frozen=True)
class PlateCalibration:
    """A plate as it is.

    Attributes
    ----------
    plate
        With the corners where they were found.
    ids
        Its markers.
    shift_m
        How far each is to the right of and below its stated place, shape (n, 2).
    turn_rad
        How far each is turned, clockwise on the print, shape (n,).
    sigma_m
        Standard deviation of the shifts, shape (n, 2).
    frames
        How many frames it was found from.
    """

    plate: Plate
    ids: tuple[int, ...]
    shift_m: Array
    turn_rad: Array
    sigma_m: Array
    frames: int

    def sentence(self) -> str:
        """What a user must know."""
        distance = np.linalg.norm(self.shift_m, axis=1)
        worst = int(distance.argmax())
        return (
            f"plate self-calibrated from {self.frames} frames: markers were up to "
            f"{1e3 * distance[worst]:.3f} mm (marker {self.ids[worst]}) from their stated places, "
            f"known to {1e3 * float(np.median(self.sigma_m)):.3f} mm"
        )


def calibrate_plate(
    plate: Plate, views: Sequence[PlateView], camera: CameraModel
) -> PlateCalibration | None:
    """Find the markers of a plate from frames that show it.

    Parameters
    ----------
    plate
        As stated.
    views
        Frames, best in which it is turned differently.
    camera
        The camera.

    Returns
    -------
    PlateCalibration or None
        None where fewer than five frames could be used.
    """
    printed = print_of(plate)
    count = len(plate.ids)
    poses = [view.pose for view in views]
    move, spread, used = np.zeros((count, 3)), np.full((count, 3), np.nan), 0
    for _ in range(ROUNDS):
        moved = _moved(printed, move)
        scale = np.tile([USUAL_MISPLACEMENT_M, USUAL_MISPLACEMENT_M, USUAL_TURN_RAD], count)
        normal = np.diag(1.0 / scale**2)
        pull = -move.ravel() / scale**2
        used = 0
        for index, view in enumerate(views):
            part = _reduced(view, poses[index], plate, moved, camera)
            if part is None:
                continue
            poses[index], its_normal, its_pull, its_columns = part
            normal[np.ix_(its_columns, its_columns)] += its_normal
            pull[its_columns] += its_pull
            used += 1
        if used < LEAST_FRAMES:
            return None
        inverse = np.linalg.inv(normal)
        move = move + (inverse @ pull).reshape(count, 3)
        spread = np.sqrt(np.diag(inverse)).reshape(count, 3)
    found = _moved(printed, move)
    square = np.array([[0.0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    square[:, :2] *= printed.modules
    corners = square @ found.frame.transpose(0, 2, 1)
    return PlateCalibration(
        replace(plate, corners=corners), plate.ids, move[:, :2], move[:, 2], spread[:, :2], used
    )


def spread_out(count: int, wanted: int) -> list[int]:
    """So many indices, evenly over a range."""
    return sorted(set(np.linspace(0, count - 1, min(wanted, count)).astype(int).tolist()))


def _moved(printed: MarkerPrint, move: Array) -> MarkerPrint:
    """Prints shifted (m) and turned (rad) in their planes."""
    frame = printed.frame.copy()
    size = np.linalg.norm(frame[:, :, 0], axis=1)[:, None]
    right, down = frame[:, :, 0].copy(), frame[:, :, 1].copy()
    centre = frame[:, :, 2] + (right + down) * printed.modules / 2.0
    centre += (right * move[:, :1] + down * move[:, 1:2]) / size
    cos, sin = np.cos(move[:, 2:]), np.sin(move[:, 2:])
    frame[:, :, 0] = cos * right + sin * down
    frame[:, :, 1] = cos * down - sin * right
    frame[:, :, 2] = centre - (frame[:, :, 0] + frame[:, :, 1]) * printed.modules / 2.0
    return replace(printed, frame=frame)


def _reduced(
    view: PlateView, pose: CameraPose, plate: Plate, printed: MarkerPrint, camera: CameraModel
) -> tuple[CameraPose, Array, Array, NDArray[np.intp]] | None:
    """Pose of a frame, and its normal equations for the markers, its own unknowns eliminated."""
    from vision.normal_equations_kernel import COLUMNS, SHARED, accumulate
    from vision.projection_kernel import placed

    chosen = [plate.ids.index(marker) for marker in view.ids]
    seen = printed.of(chosen)
    aligned = align_print(view.image, seen, pose.rotation, pose.translation, camera)
    if aligned is None:
        return None
    windows = windows_of(seen, aligned.rotation, aligned.translation, camera)
    if windows is None:
        return None
    normals, pulls, _, _ = accumulate(
        view.image,
        windows.lens,
        windows.middle,
        windows.window,
        seen.paper,
        windows.reach,
        placed(seen.frame, aligned.rotation, aligned.translation),
        aligned.translation,
        camera.focal_px,
        camera.principal_point_px,
        windows.size_m,
        aligned.light,
        windows.origin,
        windows.scale,
        5.0 * aligned.noise,
        COLUMNS,
    )
    matrix, right, size = markers_alone(normals, pulls, SHARED)
    variance = aligned.noise**2
    normal, right = matrix * np.outer(size, size) / variance, right * size / variance
    moved = replace(pose, rotation=aligned.rotation, translation=aligned.translation)
    places = (3 * np.array(chosen)[:, None] + np.arange(3)).ravel()
    return moved, normal, right, places
