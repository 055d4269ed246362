"""Pose by direct photometric alignment: the picture of the known print is fitted to the pixels.

The model is the print of every marker seen, through the lens, under a Gaussian blur of unknown
width, with an ink and a paper level that may each vary linearly over the plate, and a transfer that
may be bowed (gamma, spreading ink). All of that is fitted with the pose by Levenberg-Marquardt on
the raw pixels, so every edge inside the markers counts, not their outlines alone. The covariance is
the Cramer-Rao bound of that model at the noise that the residuals show.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.local_lens import local_lenses
from vision.marker_print import MarkerPrint

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

BLUR_PX = (0.3, 4.0)
USUAL_BLUR_PX = 0.8
MOST_STEPS = 15

OUTWARD_PX = 4.0
"""Paper round a marker is used up to this far, to a module less a pixel, and to its neighbours."""

NEIGHBOUR_CLEARANCE_PX = 3.5
LEAST_MODULE_PX = 2.0
LEAST_CONTRAST = 12.0
ROUNDING_VARIANCE = 1.0 / 12.0

WORST_MISFIT = 0.15
"""Residuals, as a fraction of the contrast, past which the print is not what is seen."""


@dataclass(frozen=True)
class Alignment:
    """A pose that the pixels settled on.

    Attributes
    ----------
    rotation, translation
        From plate to camera, shapes (3, 3) and (3,), m.
    covariance
        Of a small rotation about the camera's axes, rad, and of the translation, m: shape (6, 6).
    light
        Blur in px, then level of the ink and its gradients, contrast and its gradients, and bow:
        shape (8,).
    noise
        Standard deviation of the residuals, grey levels.
    squares
        Sum of the squared residuals, grey levels squared.
    pixels
        How many were used.
    misfit
        Chi-squared, per degree of freedom, by which the markers want to be elsewhere on the plate:
        1 for the plate as stated, NaN for a single marker.
    """

    rotation: Array
    translation: Array
    covariance: Array
    light: Array
    noise: float
    squares: float
    pixels: int
    misfit: float

    @property
    def blur_px(self) -> float:
        """Standard deviation of the point spread, px."""
        return float(self.light[0])


@dataclass(frozen=True)
class PixelWindows:
    """Which pixels of a picture belong to which marker, and the lens there.

    Attributes
    ----------
    lens, middle, window
        As `vision.normal_equations_kernel.accumulate` takes them.
    reach
        Modules of paper beyond each marker.
    size_m
        Side of a module of each marker, m.
    origin, scale
        Middle and half the size of the plate in the picture, px.
    """

    lens: Array
    middle: Array
    window: NDArray[np.int64]
    reach: Array
    size_m: Array
    origin: Array
    scale: float


def windows_of(
    printed: MarkerPrint, rotation: Array, translation: Array, camera: CameraModel
) -> PixelWindows | None:
    """The pixels that markers fill at a pose; None where one is behind or beside the picture.

    Parameters
    ----------
    printed
        The markers to be used.
    rotation, translation
        From plate to camera.
    camera
        The camera.
    """
    modules = printed.modules
    square = np.array([[0, 0, 1], [modules, 0, 1], [modules, modules, 1], [0, modules, 1.0]])
    corners = (square @ printed.frame.transpose(0, 2, 1)) @ rotation.T + translation
    if corners[..., 2].min() <= 0.0:
        return None
    ideal = camera.project(corners.reshape(-1, 3))
    pixels = camera.distort(ideal).reshape(-1, 4, 2)
    diagonals = pixels[:, 2:] - pixels[:, :2]
    area = np.abs(diagonals[:, 0, 0] * diagonals[:, 1, 1] - diagonals[:, 0, 1] * diagonals[:, 1, 0])
    sides = np.linalg.norm(np.roll(pixels, -1, axis=1) - pixels, axis=2)
    module_px = area / 2.0 / sides.max(axis=1) / modules  # the narrow way
    if module_px.min() < LEAST_MODULE_PX:
        return None
    size_m = np.linalg.norm(printed.frame[:, :, 0], axis=1)
    clear_px = printed.clear_m / size_m * module_px
    outward = np.minimum(np.minimum(OUTWARD_PX, module_px - 1.0), clear_px - NEIGHBOUR_CLEARANCE_PX)
    outward = np.maximum(outward, 0.5)
    low, high = pixels.min(axis=1) - outward[:, None], pixels.max(axis=1) + outward[:, None]
    size = (camera.width_px, camera.height_px)
    window = np.column_stack(
        [np.maximum(np.floor(low), 0.0), np.minimum(np.ceil(high) + 1.0, size)]
    ).astype(np.int64)
    if (window[:, 0] >= window[:, 2]).any() or (window[:, 1] >= window[:, 3]).any():
        return None
    middle = pixels.mean(axis=1)
    lens = local_lenses(camera, middle, (high - low).max(axis=1) / 2.0)
    everywhere = pixels.reshape(-1, 2)
    scale = max(float(np.ptp(everywhere, axis=0).max()) / 2.0, 1.0)
    return PixelWindows(
        lens, middle, window, outward / module_px, size_m, everywhere.mean(axis=0), scale
    )


def align_print(
    image: Image,
    printed: MarkerPrint,
    rotation: Array,
    translation: Array,
    camera: CameraModel,
    blur_px: float = USUAL_BLUR_PX,
) -> Alignment | None:
    """Fit pose, blur and light to the pixels of the markers seen.

    Parameters
    ----------
    image
        Grey levels, shape (height, width).
    printed
        The markers seen.
    rotation, translation
        From plate to camera, good to half a module in the picture.
    camera
        The camera.
    blur_px
        Where to start with the blur.

    Returns
    -------
    Alignment or None
        None where markers are too small, too faint, or not as printed.
    """
    from vision.alignment_kernel import align
    from vision.normal_equations_kernel import COLUMNS, SHARED, accumulate
    from vision.projection_kernel import placed

    windows = windows_of(printed, rotation, translation, camera)
    if windows is None:
        return None
    light = np.array([blur_px, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    rotation, translation, light, normal, squares, pixels, settled = align(
        image,
        windows.lens,
        windows.middle,
        windows.window,
        printed.paper,
        windows.reach,
        printed.frame,
        windows.size_m,
        np.ascontiguousarray(rotation),
        np.ascontiguousarray(translation),
        camera.focal_px,
        camera.principal_point_px,
        light,
        windows.origin,
        windows.scale,
        BLUR_PX,
        MOST_STEPS,
    )
    if not settled or pixels <= 2 * SHARED or light[4] < LEAST_CONTRAST:
        return None
    variance = max(float(squares) / (pixels - SHARED), ROUNDING_VARIANCE)
    noise = float(np.sqrt(variance))
    if noise > WORST_MISFIT * light[4]:
        return None
    normals, pulls, _, _ = accumulate(
        image,
        windows.lens,
        windows.middle,
        windows.window,
        printed.paper,
        windows.reach,
        placed(printed.frame, rotation, translation),
        translation,
        camera.focal_px,
        camera.principal_point_px,
        windows.size_m,
        light,
        windows.origin,
        windows.scale,
        5.0 * noise,
        COLUMNS,
    )
    return Alignment(
        rotation,
        translation,
        pose_covariance(normal, variance),
        light,
        noise,
        float(squares),
        int(pixels),
        _misfit(normals, pulls, variance),
    )


def _misfit(normals: Array, pulls: Array, variance: float) -> float:
    """How much the markers pull away from each other (the score test of their displacement)."""
    from vision.normal_equations_kernel import SHARED

    count = len(normals)
    if count < 2:
        return float("nan")
    moves, right, _ = markers_alone(normals, pulls, SHARED)
    values, vectors = np.linalg.eigh(moves)
    # Six combinations move the plate as a whole: those are the pose, and pull at nothing.
    free = values > 1e-6 * values[-1]
    drawn = (vectors[:, free].T @ right) ** 2 / values[free]
    return float(drawn.sum() / variance / max(int(free.sum()), 1))


def markers_alone(normals: Array, pulls: Array, shared: int) -> tuple[Array, Array, Array]:
    """Normal equations of the markers' own columns, pose and light eliminated.

    Parameters
    ----------
    normals, pulls
        As `vision.normal_equations_kernel.accumulate` gives them, n markers with all columns.
    shared
        How many columns are pose and light.

    Returns
    -------
    tuple
        Matrix (3 n, 3 n) and right side (3 n,), in grey levels squared, and the size (3 n,) of
        each unknown by which both were divided: metres and radians do not compare.
    """
    count = len(normals)
    own = normals[:, :shared, :shared].sum(axis=0)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(own), 1e-300))
    own = own * np.outer(scale, scale) + 1e-9 * np.eye(shared)
    cross, block = np.zeros((shared, 3 * count)), np.zeros((3 * count, 3 * count))
    for n in range(count):
        at = slice(3 * n, 3 * n + 3)
        cross[:, at] = scale[:, None] * normals[n, :shared, shared:]
        block[at, at] = normals[n, shared:, shared:]
    drawn = np.column_stack([cross, scale * pulls[:, :shared].sum(axis=0)])
    eliminated = np.linalg.solve(own, drawn)
    matrix: Array = block - cross.T @ eliminated[:, :-1]
    right: Array = pulls[:, shared:].ravel() - cross.T @ eliminated[:, -1]
    size: Array = np.sqrt(np.maximum(np.diag(block), 1e-300))
    return matrix / np.outer(size, size), right / size, size


def pose_covariance(normal: Array, variance: float) -> Array:
    """Covariance of the pose, (6, 6), with the light fitted beside, from a normal matrix."""
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    inverse = np.linalg.pinv(normal / np.outer(scale, scale), hermitian=True)
    covariance: Array = (inverse / np.outer(scale, scale))[:6, :6] * variance
    return covariance
