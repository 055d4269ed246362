"""One frame after the other: markers, corners, pose, and what is wrong with the frame.

A tracker holds what one frame must know of those before: the last pose, which decides between the
two of a plane where the corners do not, and the last picture, which shows a repeated one.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.runfolder.tables import FrameFlag
from vision.camera_model import CameraModel
from vision.corners import Corners, refine_corners
from vision.detect import MarkerDetector
from vision.plate import Plate, Singles
from vision.pose import CameraPose, PoseEstimate, estimate_pose

Image = NDArray[np.uint8]

BLACK_LEVEL = 16
"""A picture whose brightest hundredth stays below this many grey levels (of 255) is black."""

HIGH_REPROJECTION_PX = 1.0
"""Corners are good to a few hundredths of a pixel: past this, plate or lens are not as stated."""

FORGET_AFTER_FRAMES = 8
"""A pose older than this many frames (half a second at 16 fps) no longer decides."""


@dataclass(frozen=True)
class Sighting:
    """A plate, or a marker of its own, in one frame.

    Attributes
    ----------
    marker
        Its id where markers are tracked one by one, else None.
    markers
        How many markers were used.
    estimate
        The pose, None where there is none.
    flags
        What concerns this sighting.
    """

    marker: int | None
    markers: int
    estimate: PoseEstimate | None
    flags: FrameFlag


@dataclass(frozen=True)
class TrackedFrame:
    """What one frame showed.

    Attributes
    ----------
    sightings
        One of a plate, seen or not; of independent markers one each, or one of none.
    """

    sightings: tuple[Sighting, ...]


class Tracker:
    """Follows a plate, or independent markers, through a video.

    Parameters
    ----------
    camera
        The camera that took it.
    board
        What to follow.

    Attributes
    ----------
    board
        What is followed.
    ids_seen
        All markers of the dictionary that were seen so far, of the board or not.
    """

    def __init__(self, camera: CameraModel, board: Plate | Singles) -> None:
        self.ids_seen: set[int] = set()
        self._camera = camera
        self.board = board
        self._detector = MarkerDetector(board.dictionary)
        self._followers: dict[int | None, _Follower] = {}
        self._last: Image | None = None

    def see(self, image: Image) -> TrackedFrame:
        """Take the next frame.

        Parameters
        ----------
        image
            Grey levels, shape (height, width), of the camera's size.
        """
        flags = self._picture_flags(image)
        found = self._detector.detect(image)
        self.ids_seen.update(found.ids)
        board = self.board
        wanted = board.ids if isinstance(board, Plate) else tuple(filter(board.wants, found.ids))
        corners = refine_corners(image, found.of(wanted), self._camera, self._detector.modules)
        if isinstance(board, Plate):
            return TrackedFrame((self._follow(None, board, corners, flags),))
        sightings = [
            self._follow(marker, board.plate_of(marker), _one(corners, index), flags)
            for index, marker in enumerate(corners.ids)
        ]
        unseen = Sighting(None, 0, None, flags | FrameFlag.NO_MARKER)
        return TrackedFrame(tuple(sightings) or (unseen,))

    def _follow(
        self, marker: int | None, plate: Plate, corners: Corners, flags: FrameFlag
    ) -> Sighting:
        count = len(corners.ids)
        follower = self._followers.setdefault(marker, _Follower())
        if count == 0:
            follower.lose()
            return Sighting(marker, 0, None, flags | FrameFlag.NO_MARKER)
        if 2 * count < len(plate.ids):
            flags |= FrameFlag.FEW_MARKERS
        estimate = follower.follow(plate, corners, self._camera)
        if estimate is None or estimate.pose.reprojection_px > HIGH_REPROJECTION_PX:
            flags |= FrameFlag.HIGH_REPROJECTION
        if estimate is not None:
            if estimate.ambiguous:
                flags |= FrameFlag.AMBIGUOUS
            if estimate.from_previous:
                flags |= FrameFlag.BRANCH_FROM_PREVIOUS
        return Sighting(marker, count, estimate, flags)

    def _picture_flags(self, image: Image) -> FrameFlag:
        flags = FrameFlag(0)
        if np.percentile(image, 99.0) < BLACK_LEVEL:
            flags |= FrameFlag.BLACK
        if self._last is not None and np.array_equal(image, self._last):
            flags |= FrameFlag.REPEATED
        self._last = image.copy()
        return flags


class _Follower:
    """The last pose of one plate."""

    def __init__(self) -> None:
        self._previous: CameraPose | None = None
        self._age = 0

    def follow(self, plate: Plate, corners: Corners, camera: CameraModel) -> PoseEstimate | None:
        points = plate.corners_of(corners.ids)
        estimate = estimate_pose(points, corners, camera, self._previous)
        if estimate is None:
            self.lose()
        else:
            self._previous, self._age = estimate.pose, 0
        return estimate

    def lose(self) -> None:
        self._age += 1
        if self._age > FORGET_AFTER_FRAMES:
            self._previous = None


def _one(corners: Corners, index: int) -> Corners:
    only = slice(index, index + 1)
    return Corners(
        corners.ids[only], corners.pixels[only], corners.covariance[only], corners.fitted[only]
    )
