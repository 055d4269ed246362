"""One frame after the other: markers, corners, pose, and what is wrong with the frame.

A tracker holds what one frame must know of those before: where the plate was, which says where to
look for it; the score of both poses of a plane so far, which decides where one frame does not; and
the last picture, which shows a repeated one.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdpr8.runfolder.tables import FrameFlag
from vision.branches import BranchScore
from vision.camera_model import CameraModel
from vision.charuco import saddles_seen
from vision.corners import Corners, refine_corners
from vision.detect import MarkerDetector, Markers
from vision.marker_print import print_of
from vision.plate import Plate, Singles
from vision.pose import CameraPose, PoseEstimate, estimate_pose
from vision.refine import Refinement, refine_on_pixels
from vision.region import Region, detect_in, region_about

Image = NDArray[np.uint8]

BLACK_LEVEL = 16
"""A picture whose brightest hundredth stays below this many grey levels (of 255) is black."""

HIGH_REPROJECTION_PX = 1.0
"""Corners are good to a few hundredths of a pixel: past this, plate or lens are not as stated."""

BLACK_SAMPLE = 4
"""Every so many rows and columns are looked at to tell whether a picture is black."""

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
    ids
        The markers used.
    """

    marker: int | None
    markers: int
    estimate: PoseEstimate | None
    flags: FrameFlag
    ids: tuple[int, ...] = ()


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
    refinement
        What poses are fitted to; None takes the pixels for a plate, and the corners for
        independent markers, whose paper is often bent.

    Attributes
    ----------
    camera
        That took the video.
    board
        What is followed.
    ids_seen
        All markers of the dictionary that were seen so far, of the board or not.
    searches
        How many whole pictures were searched.
    """

    def __init__(
        self, camera: CameraModel, board: Plate | Singles, refinement: Refinement | None = None
    ) -> None:
        self.ids_seen: set[int] = set()
        self.searches = 0
        self.camera = camera
        self.board = board
        usual = Refinement.PHOTOMETRIC if isinstance(board, Plate) else Refinement.CORNERS
        self._refinement = refinement or usual
        self._detector = MarkerDetector(board.dictionary)
        self._followers: dict[int | None, _Follower] = {}
        self._last: Image | None = None

    def __reduce__(self) -> tuple[type["Tracker"], tuple[Any, ...]]:
        """A copy in another process has seen nothing."""
        return Tracker, (self.camera, self.board, self._refinement)

    def anew(self) -> "Tracker":
        """One that follows the same, and has seen nothing."""
        return Tracker(self.camera, self.board, self._refinement)

    def see(self, image: Image) -> TrackedFrame:
        """Take the next frame.

        Parameters
        ----------
        image
            Grey levels, shape (height, width), of the camera's size.
        """
        flags = self._picture_flags(image)
        board = self.board
        if isinstance(board, Plate):
            follower = self._follower(None, board)
            found = self._find(image, follower, board)
            corners = refine_corners(image, found, self.camera, self._detector.modules)
            return TrackedFrame((follower.follow(image, corners, flags),))
        found = self._search(image)
        wanted = found.of(tuple(filter(board.wants, found.ids)))
        corners = refine_corners(image, wanted, self.camera, self._detector.modules)
        sightings = [
            self._follower(marker, board.plate_of(marker)).follow(
                image, _one(corners, index), flags
            )
            for index, marker in enumerate(corners.ids)
        ]
        for marker in self._followers.keys() - set(corners.ids):
            self._followers[marker].lose()
        unseen = Sighting(None, 0, None, flags | FrameFlag.NO_MARKER)
        return TrackedFrame(tuple(sightings) or (unseen,))

    def _follower(self, marker: int | None, plate: Plate) -> "_Follower":
        if marker not in self._followers:
            self._followers[marker] = _Follower(
                marker, plate, self.camera, self._refinement, self._detector.modules
            )
        return self._followers[marker]

    def _find(self, image: Image, follower: "_Follower", plate: Plate) -> Markers:
        """Markers of the plate: where it must be by now, else anywhere."""
        region = follower.region()
        if region is not None and region.smaller_than_half(self.camera):
            found = detect_in(image, region, self._detector).of(plate.ids)
            if found.ids and len(found.ids) >= follower.markers:
                return found
        return self._search(image).of(plate.ids)

    def _search(self, image: Image) -> Markers:
        self.searches += 1
        found = self._detector.detect(image)
        self.ids_seen.update(found.ids)
        return found

    def _picture_flags(self, image: Image) -> FrameFlag:
        flags = FrameFlag(0)
        sample = image[::BLACK_SAMPLE, ::BLACK_SAMPLE]
        if np.count_nonzero(sample >= BLACK_LEVEL) < 0.01 * sample.size:
            flags |= FrameFlag.BLACK
        if self._last is not None and _same(image, self._last):
            flags |= FrameFlag.REPEATED
        self._last = image
        return flags


class _Follower:
    """What is known of one plate from the frames so far."""

    def __init__(
        self,
        marker: int | None,
        plate: Plate,
        camera: CameraModel,
        refinement: Refinement,
        modules: int,
    ) -> None:
        self.markers = 0
        self._modules = modules
        self._marker = marker
        self._plate = plate
        self._camera = camera
        self._print = print_of(plate) if refinement is Refinement.PHOTOMETRIC else None
        self._last: CameraPose | None = None
        self._before: CameraPose | None = None
        self._age = 0
        self._score = BranchScore()

    def region(self) -> Region | None:
        """Where to look for it; None where it was not in the last frame."""
        if self._last is None or self._age:
            return None
        return region_about(self._plate, self._last, self._before, self._camera)

    def follow(self, image: Image, corners: Corners, flags: FrameFlag) -> Sighting:
        """Take what was found of it in the next frame."""
        count = len(corners.ids)
        self.markers = count
        if count == 0:
            self.lose()
            return Sighting(self._marker, 0, None, flags | FrameFlag.NO_MARKER)
        if 2 * count < len(self._plate.ids):
            flags |= FrameFlag.FEW_MARKERS
        estimate = self._estimate(image, corners)
        if estimate is None:
            self.lose()
            return Sighting(self._marker, count, None, flags | FrameFlag.HIGH_REPROJECTION)
        estimate = self._score.take(estimate, self._age + 1)
        self._before = self._last if self._age == 0 else None
        self._last, self._age = estimate.pose, 0
        return Sighting(self._marker, count, estimate, flags | flags_of(estimate), corners.ids)

    def _estimate(self, image: Image, corners: Corners) -> PoseEstimate | None:
        points = self._plate.corners_of(corners.ids)
        estimate = estimate_pose(points, corners, self._camera)
        if estimate is not None and corners.fitted.any() and not corners.fitted.all():
            # The others say where the sides of an ill-detected marker are: fit them from there.
            corners = self._fitted_again(image, corners, estimate.pose)
            estimate = estimate_pose(points, corners, self._camera)
        if estimate is None:
            return None
        saddles = saddles_seen(image, self._plate, corners.ids, estimate.pose, self._camera)
        if saddles is not None:
            return estimate_pose(*saddles, self._camera) or estimate
        if self._print is None:
            return estimate
        seen = self._print.of([self._plate.ids.index(marker) for marker in corners.ids])
        return refine_on_pixels(image, seen, corners, points, estimate, self._camera)

    def _fitted_again(self, image: Image, corners: Corners, pose: CameraPose) -> Corners:
        places = self._plate.corners_of(corners.ids).reshape(-1, 3)
        ideal = self._camera.project(places @ pose.rotation.T + pose.translation)
        expected = self._camera.distort(ideal).reshape(-1, 4, 2)
        again = refine_corners(image, Markers(corners.ids, expected), self._camera, self._modules)
        better = again.fitted & ~corners.fitted
        pixels, covariance = corners.pixels.copy(), corners.covariance.copy()
        pixels[better], covariance[better] = again.pixels[better], again.covariance[better]
        return Corners(corners.ids, pixels, covariance, corners.fitted | better)

    def lose(self) -> None:
        """It was not in the next frame."""
        self._age += 1
        if self._age > FORGET_AFTER_FRAMES:
            self._last = self._before = None
            self._score.forget()


def flags_of(estimate: PoseEstimate) -> FrameFlag:
    """What an estimate says of itself."""
    flags = FrameFlag(0)
    if estimate.pose.reprojection_px > HIGH_REPROJECTION_PX:
        flags |= FrameFlag.HIGH_REPROJECTION
    if estimate.ambiguous:
        flags |= FrameFlag.AMBIGUOUS
    if estimate.from_previous:
        flags |= FrameFlag.BRANCH_FROM_PREVIOUS
    return flags


def _same(image: Image, other: Image) -> bool:
    """Whether two pictures are the same; those that are not mostly differ in the first rows."""
    first = slice(0, 8)
    return np.array_equal(image[first], other[first]) and np.array_equal(image, other)


def _one(corners: Corners, index: int) -> Corners:
    only = slice(index, index + 1)
    return Corners(
        corners.ids[only], corners.pixels[only], corners.covariance[only], corners.fitted[only]
    )
