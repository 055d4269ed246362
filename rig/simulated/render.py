"""Pictures of the marker plate, for the simulated camera and for tests of `vision`.

Nothing is drawn and resampled: each pixel's ray is intersected with the plate's plane, and the
blurred pattern there is evaluated in closed form, as squares convolved with a Gaussian (products
of error functions). A texture sampled too coarsely has coherent edge errors of 0.03 px, and a test
of a vision pipeline then measures its renderer. `vision` shares no code with this module.

Frames: O-XYZ as everywhere; the camera's is OpenCV's (x right, y down, z forward); the plate's is
x right, y up, z out of the print. Pixel centres are at integer coordinates. m, rad, px.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Camera, CameraPose, Plate
from rig.simulated.lens import pixel_rays, to_pixels
from rig.simulated.pattern import print_of
from rig.simulated.pattern_kernel import Levels, show

Array = NDArray[np.float64]
Image = NDArray[np.uint8]


@dataclass(frozen=True)
class Appearance:
    """What the plate and the sensor look like.

    Attributes
    ----------
    white, black, background
        Brightness of paper, ink and everything behind the plate, as fractions of full scale.
    blur_px
        Standard deviation of the point spread (lens, focus and the pixel's own aperture), px.
    noise
        Standard deviation of the sensor noise, in 1/255 of full scale.
    shading
        How much brighter the plate's right rim is than its left one, as a fraction of the middle.
    gamma
        The sensor stores light ** (1 / gamma).
    """

    white: float = 0.80
    black: float = 0.10
    background: float = 0.30
    blur_px: float = 0.7
    noise: float = 2.0
    shading: float = 0.0
    gamma: float = 1.0


@dataclass(frozen=True)
class _View:
    """The plate as one camera pose sees it: pixel rays to plate coordinates."""

    to_plate: Array  # (3, 3): ray (x, y, 1) -> (u w, v w, w)
    to_image: Array  # (3, 3): (u, v, 1) -> ray
    faces_camera: bool


class PlateRenderer:
    """Renders one plate for one camera that stands still.

    Parameters
    ----------
    camera
        Its intrinsics, pose and region of interest; the pose must be given.
    plate
        Markers and mounting.
    appearance
        Brightness, blur and noise.
    centre_of_mass_m
        The centre of mass in the platform frame: poses are those of the centre of mass.

    Raises
    ------
    DataError
        The camera has no pose or a lens whose distortion cannot be inverted, or a marker is none
        of the dictionary.
    """

    def __init__(
        self,
        camera: Camera,
        plate: Plate,
        appearance: Appearance | None = None,
        centre_of_mass_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        if camera.pose is None or isinstance(camera.intrinsics, str):
            raise DataError(
                "a rendered camera needs its pose and intrinsics",
                where="[camera.pose]",
                remedy="add position_m and look_at_m to the rig file",
            )
        self.appearance = appearance or Appearance()
        self._position, self._axes = _camera_axes(camera.pose)
        region = camera.region_of_interest
        self.width_px = region.width_px if region else camera.intrinsics.width_px
        self.height_px = region.height_px if region else camera.intrinsics.height_px
        self._corner = (region.x_px, region.y_px) if region else (0, 0)
        self._intrinsics = camera.intrinsics
        rays = pixel_rays(camera.intrinsics, self._corner, self.width_px, self.height_px)
        self._rays = np.stack(rays)
        self._print = print_of(plate)
        look = self.appearance
        self._levels = Levels(look.white, look.black, look.background, look.blur_px, look.shading)
        x, y, normal = _plate_axes(plate)
        self._plate_axes = np.column_stack([x, y, normal])
        self._plate_origin = np.asarray(plate.pose.position_m) - np.asarray(centre_of_mass_m)

    def brightness(self, pose: Array) -> Array:
        """The picture without noise and at one instant, as fractions of full scale.

        Parameters
        ----------
        pose
            x, y, z of the centre of mass in O-XYZ and roll, pitch, yaw; m and rad, shape (6,).

        Returns
        -------
        Array
            Shape (height, width).
        """
        image = np.full((self.height_px, self.width_px), self.appearance.background)
        view = self._view(pose)
        if view.faces_camera:
            show(image, self._rays, view.to_plate, self._print, self._levels)
        return image

    def expose(self, poses: Array, weights: Array, generator: np.random.Generator) -> Image:
        """A picture averaged over an exposure, with noise, as the sensor's grey levels.

        Parameters
        ----------
        poses
            Poses during the exposure, shape (n, 6).
        weights
            Their shares, shape (n,), summing to 1.
        generator
            Draws the noise.

        Returns
        -------
        Image
            Shape (height, width).
        """
        light = np.zeros((self.height_px, self.width_px))
        for pose, weight in zip(poses, weights, strict=True):
            light += weight * self.brightness(pose)
        gamma = self.appearance.gamma
        levels = 255.0 * (light if gamma == 1.0 else light ** (1.0 / gamma))
        levels += self.appearance.noise * generator.standard_normal(light.shape)
        return np.clip(np.rint(levels), 0.0, 255.0).astype(np.uint8)

    def project(self, pose: Array, points: Array) -> Array:
        """Pixels of points of the plate.

        Parameters
        ----------
        pose
            Shape (6,), m and rad.
        points
            u, v in the plate's plane, m, shape (n, 2).

        Returns
        -------
        Array
            Shape (n, 2), in the region of interest.
        """
        rays = np.column_stack([points, np.ones(len(points))]) @ self._view(pose).to_image.T
        return to_pixels(self._intrinsics, rays[:, :2] / rays[:, 2:]) - self._corner

    def corners(self, pose: Array) -> Array:
        """Where the plate's own four corners are in the picture, px, shape (4, 2)."""
        left, bottom, right, top = self._print.paper
        outline = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
        return self.project(pose, outline)

    def _view(self, pose: Array) -> _View:
        rotation = _rotation(*pose[3:])
        origin = self._axes.T @ (pose[:3] + rotation @ self._plate_origin - self._position)
        axes = self._axes.T @ rotation @ self._plate_axes
        to_image = np.column_stack([axes[:, 0], axes[:, 1], origin])
        faces = float(axes[:, 2] @ origin) < 0.0 and origin[2] > 0.0
        return _View(np.linalg.inv(to_image) if faces else to_image, to_image, faces)


def _plate_axes(plate: Plate) -> tuple[Array, Array, Array]:
    """The plate's x, y and z in the platform frame; up is made square to the normal."""
    normal = _unit(np.asarray(plate.pose.normal))
    x = _unit(np.cross(np.asarray(plate.pose.up), normal))
    return x, np.cross(normal, x), normal


def _camera_axes(pose: CameraPose) -> tuple[Array, Array]:
    """Where the camera stands, and its axes (right, down, forward) as columns, in O-XYZ."""
    position = np.asarray(pose.position_m)
    forward = _unit(np.asarray(pose.look_at_m) - position)
    right = _unit(np.cross(forward, np.asarray(pose.up)))
    return position, np.column_stack([right, np.cross(forward, right), forward])


def _unit(vector: Array) -> Array:
    length = float(np.linalg.norm(vector))
    if length < 1e-9:
        raise DataError(
            "directions of the camera or the plate coincide or vanish",
            where="[camera.pose], [plate.pose]",
            allowed="look_at_m away from position_m; up not along the view or the normal",
        )
    unit: Array = vector / length
    return unit


def _rotation(roll: float, pitch: float, yaw: float) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll)."""
    (a, b, c), (s, t, w) = np.cos((roll, pitch, yaw)), np.sin((roll, pitch, yaw))
    return np.array(
        [
            [c * b, c * t * s - w * a, c * t * a + w * s],
            [w * b, w * t * s + c * a, w * t * a - c * s],
            [-t, b * s, b * a],
        ]
    )
