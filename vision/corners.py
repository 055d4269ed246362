"""Corners where the sides of a marker meet, each side fitted as a blurred straight edge.

A side is the line e = o + a t (t along it, e across it, outwards) and the picture round it

    I = (1 + g t) (dark + (bright - dark) Phi((e - o - a t) / s)),

the step from ink to paper convolved with a Gaussian of standard deviation s, under a light that
varies along the side. Least squares on the raw pixels beside the side (no resampling, so their
noise stays independent) give o and a with their covariance; neighbouring lines meet in the corners.
Blur does not pull such corners inwards, as it does those of `cornerSubPix`, because the stretches
near the corners are not used. Lines are fitted in ideal pixels, where a lens does not bend them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.camera_model import CameraModel
from vision.detect import CORNER_PRECISION_PX, Markers
from vision.local_lens import local_lenses, through_lenses

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

ITERATIONS = 8
CORNER_CLEARANCE_PX = 2.5
"""Left out at both ends of a side: there the neighbouring side's blur reaches in."""

INWARD_PX, OUTWARD_PX = (1.5, 4.0), (2.0, 4.0)
"""Least and most distance from the side at which pixels are used, on the ink and on the paper."""

INWARD_CLEARANCE_PX, OUTWARD_CLEARANCE_PX = 1.5, 1.0
"""Kept from the next module, which may be of the other colour; the paper is a module wide."""

BLUR_PX = (0.35, 3.0)
USUAL_BLUR_PX = (0.8, 0.4)
USUAL_GRADIENT_PER_PX = (0.0, 0.003)
"""What blur and uneven light usually are (mean, standard deviation).

They matter for markers of few pixels, which cannot tell them, and for no others.
"""

USUAL_NOISE = 2.0
"""Grey levels; sets the weight of the two usual values against the pixels."""

LEAST_PIXELS = 20
LEAST_CONTRAST = 12.0
"""Grey levels; a fainter marker keeps the corners it was detected with."""

MOST_SHIFT_PX = 2.0
"""A line that moves further from where the marker was detected has caught something else."""

ROUNDING_VARIANCE = 1.0 / 12.0
"""Of grey levels rounded to whole numbers: no picture is less noisy."""


@dataclass(frozen=True)
class Corners:
    """Corners of markers in ideal pixels, and how well they are known.

    Attributes
    ----------
    ids
        Markers, n of them.
    pixels
        TL, TR, BR, BL of each, ideal px, shape (n, 4, 2).
    covariance
        Of each marker's eight coordinates, in the order of ``pixels.reshape(n, 8)``, px2, shape
        (n, 8, 8). Corners of one marker are correlated: two share a side.
    fitted
        Whether a marker's sides could be fitted, shape (n,); else its corners are as detected.
    """

    ids: tuple[int, ...]
    pixels: Array
    covariance: Array
    fitted: NDArray[np.bool_]


@dataclass(frozen=True)
class _Sides:
    """The pixels beside m sides, k each (padded), in coordinates along and across the side."""

    middle: Array  # (m, 2)
    along: Array  # (m, 2), unit vector from one corner to the next
    across: Array  # (m, 2), unit vector outwards
    t: Array  # (m, k)
    e: Array  # (m, k)
    level: Array  # (m, k)
    used: Array  # (m, k), 1 or 0
    reach: tuple[Array, Array]  # (m, 1) inwards and outwards


@dataclass(frozen=True)
class _Lines:
    offset: Array  # (m,)
    slope: Array  # (m,)
    covariance: Array  # (m, 2, 2), of offset and slope
    good: NDArray[np.bool_]  # (m,)


def refine_corners(image: Image, markers: Markers, camera: CameraModel, modules: int) -> Corners:
    """Fit the sides of each marker and intersect them.

    Parameters
    ----------
    image
        Grey levels, shape (height, width).
    markers
        As detected, in px of the picture.
    camera
        Whose lens bends the sides.
    modules
        Modules along a marker's side, its border included.
    """
    count = len(markers.ids)
    ideal = camera.undistort(markers.corners.reshape(-1, 2)).reshape(count, 4, 2)
    pixels = ideal.copy()
    covariance = np.tile(CORNER_PRECISION_PX**2 * np.eye(8), (count, 1, 1))
    fitted = np.zeros(count, dtype=bool)
    if count:
        sides = _sides(image, markers.corners, ideal, camera, modules)
        lines = _fit(sides)
        met, spread, crossed = _meet(sides, lines)
        moved = np.abs(met - ideal).max(axis=(1, 2))
        fitted = lines.good.reshape(count, 4).all(axis=1) & crossed & (moved < MOST_SHIFT_PX)
        pixels[fitted] = met[fitted]
        covariance[fitted] = spread[fitted]
    return Corners(markers.ids, pixels, covariance, fitted)


def _sides(image: Image, corners: Array, ideal: Array, camera: CameraModel, modules: int) -> _Sides:
    """Take the pixels beside each side: whole columns across flat sides, rows across steep ones."""
    start, end = corners.reshape(-1, 2), np.roll(corners, -1, axis=1).reshape(-1, 2)
    step = end - start
    length = np.linalg.norm(step, axis=1)
    steep = np.abs(step[:, 1]) > np.abs(step[:, 0])
    major = np.where(steep, 1, 0)
    side = np.arange(len(start))
    low = np.minimum(start[side, major], end[side, major])
    high = np.maximum(start[side, major], end[side, major])
    slope = step[side, 1 - major] / step[side, major]
    diagonals = corners[:, 2:] - corners[:, :2]
    area = np.abs(np.linalg.det(diagonals)) / 2.0
    module = np.repeat(area, 4) / length / modules  # across the side: a plate seen obliquely
    inward = np.clip(module - INWARD_CLEARANCE_PX, *INWARD_PX)
    outward = np.clip(module - OUTWARD_CLEARANCE_PX, *OUTWARD_PX)
    half = int(np.ceil(outward.max() * np.sqrt(2.0)))
    places = np.ceil(low)[:, None] + np.arange(int((high - low).max()) + 1)
    on_side = start[side, 1 - major][:, None] + slope[:, None] * (
        places - start[side, major][:, None]
    )
    minor = np.rint(on_side)[:, :, None] + np.arange(-half, half + 1)
    places = np.broadcast_to(places[:, :, None], minor.shape).reshape(len(side), -1)
    minor = minor.reshape(len(side), -1)
    x = np.where(steep[:, None], minor, places)
    y = np.where(steep[:, None], places, minor)
    inside = (x >= 0) & (x < camera.width_px) & (y >= 0) & (y < camera.height_px)
    x, y = np.clip(x, 0, camera.width_px - 1), np.clip(y, 0, camera.height_px - 1)
    level = image[y.astype(int), x.astype(int)].astype(float)
    seen = _without_lens(np.stack([x, y], axis=-1), corners, camera)

    start, end = ideal.reshape(-1, 2), np.roll(ideal, -1, axis=1).reshape(-1, 2)
    length = np.linalg.norm(end - start, axis=1)
    along = (end - start) / length[:, None]
    # Corners run clockwise on the picture (y down): outwards is to the left of the way.
    across = np.column_stack([along[:, 1], -along[:, 0]])
    middle = (start + end) / 2.0
    t = np.einsum("mkc,mc->mk", seen - middle[:, None], along)
    e = np.einsum("mkc,mc->mk", seen - middle[:, None], across)
    used = inside & (np.abs(t) <= length[:, None] / 2.0 - CORNER_CLEARANCE_PX)
    return _Sides(
        middle, along, across, t, e, level, used.astype(float), (inward[:, None], outward[:, None])
    )


def _without_lens(pixels: Array, corners: Array, camera: CameraModel) -> Array:
    """Ideal pixels of those beside the sides, (4 n, k, 2), by one cubic a marker."""
    if not camera.distortion.any():
        return pixels
    middles = corners.mean(axis=1)
    each = pixels.reshape(len(corners), -1, 2) - middles[:, None]
    half = np.abs(corners - middles[:, None]).max(axis=(1, 2)) + OUTWARD_PX[1] + 2.0
    return through_lenses(local_lenses(camera, middles, half), each).reshape(pixels.shape)


def _fit(sides: _Sides) -> _Lines:
    """Gauss-Newton on each side."""
    from vision.edge_kernel import fit_edges

    usual = np.array([0.0, 0.0, 0.0, 0.0, USUAL_BLUR_PX[0], USUAL_GRADIENT_PER_PX[0]])
    weight = np.array([1e-9, 1e-9, 1e-9, 1e-9, USUAL_BLUR_PX[1], USUAL_GRADIENT_PER_PX[1]])
    weight[4:] = (USUAL_NOISE / weight[4:]) ** 2
    values, normal, squares, pixels = fit_edges(
        np.ascontiguousarray(sides.t),
        np.ascontiguousarray(sides.e),
        sides.level,
        sides.used,
        sides.reach[0][:, 0],
        sides.reach[1][:, 0],
        usual,
        weight,
        _LARGEST_STEP,
        np.array(BLUR_PX),
        ITERATIONS,
    )
    variance = squares / np.maximum(pixels - 6.0, 1.0)
    # The noise is the picture's, one for all sides; a side that fits worse has more of its own.
    variance = np.maximum(np.maximum(variance, np.median(variance)), ROUNDING_VARIANCE)
    contrast = values[:, 3] - values[:, 2]
    good = (
        (pixels >= LEAST_PIXELS)
        & (contrast >= LEAST_CONTRAST)
        & (np.sqrt(variance) < 0.2 * contrast)
        & (np.abs(values[:, 0]) < MOST_SHIFT_PX)
        & np.isfinite(values).all(axis=1)
    )
    covariance = np.linalg.inv(normal)[:, :2, :2] * variance[:, None, None]
    return _Lines(values[:, 0], values[:, 1], covariance, good)


_LARGEST_STEP = np.array([0.7, 0.1, 60.0, 60.0, 0.5, 0.02])


def _meet(sides: _Sides, lines: _Lines) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Corners (n, 4, 2), their covariance (n, 8, 8), and whether all sides cross."""
    normal = sides.across - lines.slope[:, None] * sides.along
    level = lines.offset + np.einsum("mc,mc->m", normal, sides.middle)
    count = len(level) // 4
    before = np.roll(np.arange(4 * count).reshape(count, 4), 1, axis=1).ravel()
    system = np.stack([normal[before], normal], axis=1)
    crossed = (np.abs(np.linalg.det(system)) > 0.05).reshape(count, 4).all(axis=1)
    system[~np.repeat(crossed, 4)] = np.eye(2)
    inverse = np.linalg.inv(system)
    corners = np.einsum("mij,mj->mi", inverse, np.column_stack([level[before], level]))
    # A line moves at the corner by its offset and by its slope times the way from its middle.
    jacobian = np.zeros((count, 4, 2, 4, 2))
    index = np.arange(4 * count)
    for lever_of, column in ((before, 0), (index, 1)):
        lever = np.einsum("mc,mc->m", corners - sides.middle[lever_of], sides.along[lever_of])
        effect = (
            inverse[:, :, column, None] * np.column_stack([np.ones(len(lever)), lever])[:, None]
        )
        jacobian[index // 4, index % 4, :, lever_of % 4, :] = effect
    by_line = jacobian.reshape(count, 8, 8)
    of_lines = np.zeros((count, 4, 2, 4, 2))
    of_lines[index // 4, index % 4, :, index % 4, :] = lines.covariance
    spread = by_line @ of_lines.reshape(count, 8, 8) @ by_line.transpose(0, 2, 1)
    return corners.reshape(count, 4, 2), spread, crossed
