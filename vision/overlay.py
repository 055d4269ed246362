"""A video with what was tracked drawn on it: markers, axes, angles and flags."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.runfolder.tables import FrameFlag
from cdpr8.runfolder.video import read_video
from vision.camera_model import CameraModel
from vision.plate import Plate, Singles
from vision.pose import CameraPose
from vision.refine import Refinement
from vision.tracker import Sighting, Tracker

GREEN, RED, BLUE, AMBER = (40, 200, 40), (40, 40, 230), (230, 120, 40), (0, 190, 255)
LEAST_WIDTH_PX = 640
"""Smaller pictures are enlarged, so that the writing on them can be read."""


def write_overlay(
    path: Path,
    out: Path,
    camera: CameraModel,
    board: Plate | Singles,
    *,
    fps: float = 16.0,
    step: Callable[[], None] | None = None,
) -> int:
    """Track a video and write it anew with the poses drawn on it.

    Parameters
    ----------
    path
        The video.
    out
        Where to write (MP4, MKV or AVI by its ending).
    camera, board
        As for `vision.track_video`.
    fps
        Of the video written.
    step
        Called once a frame.

    Returns
    -------
    int
        Frames written.

    Raises
    ------
    DataError
        The video cannot be read, or the new one not written.
    """
    import av

    tracker = Tracker(camera, board, Refinement.CORNERS)
    frames = read_video(path)
    scale = max(1, int(np.ceil(LEAST_WIDTH_PX / camera.width_px)))
    size = (scale * camera.width_px // 2 * 2, scale * camera.height_px // 2 * 2)
    try:
        with av.open(str(out), "w") as container:
            stream: Any = container.add_stream("mpeg4", rate=round(fps))
            stream.width, stream.height, stream.pix_fmt = *size, "yuv420p"
            stream.bit_rate = 8_000_000
            count = 0
            for image, _ in frames:
                camera.check_size(image, str(path))
                drawn = draw(image, tracker.see(image).sightings, tracker, camera, count, scale)
                picture = np.ascontiguousarray(drawn[: size[1], : size[0]])
                for packet in stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")):
                    container.mux(packet)
                count += 1
                if step:
                    step()
            for packet in stream.encode(None):
                container.mux(packet)
    except (av.FFmpegError, OSError, ValueError) as error:
        raise DataError(
            f"the overlay cannot be written: {error}",
            where=str(out),
            allowed="a name ending in .mp4, .mkv or .avi, in a folder that exists",
        ) from None
    return count


def draw(
    image: NDArray[np.uint8],
    sightings: tuple[Sighting, ...],
    tracker: Tracker,
    camera: CameraModel,
    number: int,
    scale: int = 1,
) -> NDArray[np.uint8]:
    """A frame in colour with its sightings drawn on it, enlarged so many times."""
    import cv2

    big = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_NEAREST)
    picture: Any = cv2.cvtColor(big, cv2.COLOR_GRAY2BGR)
    lines = [f"frame {number}"]
    board = tracker.board
    for sighting in sightings:
        if sighting.flags:
            names = ", ".join(f.name.lower() for f in FrameFlag if f in sighting.flags and f.name)
            lines.append(names.replace("_", " "))
        if sighting.estimate is None:
            continue
        plate = board if isinstance(board, Plate) else board.plate_of(sighting.marker or 0)
        pose = sighting.estimate.pose
        colour = AMBER if sighting.flags else GREEN
        for corners in plate.corners:
            outline = scale * (_pixels(corners, pose, camera) + 0.5)
            cv2.polylines(
                picture, [np.rint(outline).astype(np.int32)], True, colour, 1, cv2.LINE_AA
            )
        _draw_axes(picture, plate, pose, camera, scale)
        lines.append(f"{sighting.markers} markers, {pose.reprojection_px:.3f} px")
    for row, line in enumerate(lines[:8]):
        cv2.putText(
            picture, line, (8, 20 + 20 * row), cv2.FONT_HERSHEY_SIMPLEX, 0.5, AMBER, 1, cv2.LINE_AA
        )
    result: NDArray[np.uint8] = picture
    return result


def _draw_axes(
    picture: Any, plate: Plate, pose: CameraPose, camera: CameraModel, scale: int
) -> None:
    import cv2

    length = 0.7 * float(np.linalg.norm(plate.corners[0, 1] - plate.corners[0, 0]))
    points = np.vstack([np.zeros(3), length * np.eye(3)])
    ends = np.rint(scale * (_pixels(points, pose, camera) + 0.5)).astype(int)
    for end, colour in zip(ends[1:], (RED, GREEN, BLUE), strict=True):
        cv2.line(picture, ends[0].tolist(), end.tolist(), colour, 2, cv2.LINE_AA)


def _pixels(points: NDArray[np.float64], pose: CameraPose, camera: CameraModel) -> Any:
    return camera.distort(camera.project(points @ pose.rotation.T + pose.translation))
