"""The photometric alignment of pose and light: Levenberg-Marquardt, compiled by numba.

The unknowns are the shared ones of `vision.normal_equations_kernel`.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision.compiled import compiled
from vision.marker_print import PADDING
from vision.normal_equations_kernel import SHARED, accumulate
from vision.projection_kernel import cubic, inverse, placed

Array = NDArray[np.float64]


@compiled
def align(
    image: Any,
    lens: Array,
    middle: Array,
    window: Any,
    paper: Array,
    reach: Array,
    frame: Array,
    size_m: Array,
    rotation: Array,
    translation: Array,
    focal: Array,
    principal: Array,
    light: Array,
    origin: Array,
    scale: float,
    blur_limits: Any,
    most_steps: int,
) -> Any:
    """Levenberg-Marquardt on pose and light; arguments as `accumulate`.

    Returns
    -------
    tuple
        Rotation, translation, light, normal matrix (14, 14), weighted squares, pixels, whether it
        settled.
    """
    homography = placed(frame, rotation, translation)
    levels = _seek_levels(image, lens, middle, window, paper, homography, focal, principal)
    light = light.copy()
    if levels[1] > 0.0 and levels[3] > 0.0:
        light[1] = levels[0] / levels[1]
        light[4] = max(levels[2] / levels[3] - light[1], 1.0)
    light[2] = light[3] = light[5] = light[6] = light[7] = 0.0
    robust, damping, settled = 1e9, 1e-6, False
    prior = np.zeros(SHARED)
    shared = len(prior)  # a number of its type: a constant would be compiled apart
    normals, pulls, parts, counts = accumulate(
        image,
        lens,
        middle,
        window,
        paper,
        reach,
        homography,
        translation,
        focal,
        principal,
        size_m,
        light,
        origin,
        scale,
        robust,
        shared,
    )
    squares, pixels = parts.sum(), counts.sum()
    for step in range(most_steps):
        noise = squares / max(pixels - SHARED, 1.0)
        prior[7:13] = noise / (2.0 * light[4]) ** 2
        prior[13] = noise / 0.09
        prior[6] = noise / 0.25
        normal = normals.sum(axis=0)
        pull = pulls.sum(axis=0)
        for a in range(SHARED):
            normal[a, a] = normal[a, a] * (1.0 + damping) + prior[a]
        pull[13] -= prior[13] * light[7]
        change = np.linalg.solve(normal, pull)
        # A step beyond half a module leaves the range in which the derivatives mean anything.
        change[6] = min(max(change[6], -0.3), 0.3)
        new_rotation = _turn(change[:3]) @ rotation
        new_translation = translation + change[3:6]
        new_light = light + change[6:14]
        new_light[0] = min(max(new_light[0], blur_limits[0]), blur_limits[1])
        new_light[7] = min(max(new_light[7], -0.8), 0.8)
        if not np.isfinite(change).all() or new_translation[2] <= 0.0 or new_light[4] <= 0.0:
            break
        homography = placed(frame, new_rotation, new_translation)
        limit = 5.0 * math.sqrt(noise) if step > 0 else 1e9
        tried = accumulate(
            image,
            lens,
            middle,
            window,
            paper,
            reach,
            homography,
            new_translation,
            focal,
            principal,
            size_m,
            new_light,
            origin,
            scale,
            limit,
            shared,
        )
        tried_squares, tried_pixels = tried[2].sum(), tried[3].sum()
        # Pixels come and go at the rim: compare means.
        mean, tried_mean = squares / max(pixels, 1.0), tried_squares / max(tried_pixels, 1.0)
        if tried_pixels < 50.0 or tried_mean > mean * (1.0 + 1e-3):
            damping = max(damping, 1e-4) * 30.0
            if damping > 1e3:
                break
            continue
        rotation, translation, light = new_rotation, new_translation, new_light
        normals, pulls, squares, pixels = tried[0], tried[1], tried_squares, tried_pixels
        damping = max(damping / 30.0, 1e-6)
        gain = 0.0
        for a in range(SHARED):
            gain += change[a] * pull[a]
        if gain < 1e-3 * noise and step > 0 and limit < 1e8:
            settled = True
            break
    return rotation, translation, light, normals.sum(axis=0), squares, pixels, settled


@compiled
def _seek_levels(
    image: Any,
    lens: Array,
    middle: Array,
    window: Any,
    paper: Array,
    homography: Array,
    focal: Array,
    principal: Array,
) -> Array:
    """Sum and number of the pixels well inside ink modules, then inside paper ones."""
    found = np.zeros(4)
    modules = paper.shape[1] - 2 * PADDING
    for m in range(len(paper)):
        back = inverse(homography[m])
        for row in range(window[m, 1], window[m, 3]):
            for column in range(window[m, 0], window[m, 2]):
                x, y = column - middle[m, 0], row - middle[m, 1]
                ideal_x = cubic(lens[m, 0], x, y)
                ideal_y = cubic(lens[m, 1], x, y)
                ray_x = (ideal_x - principal[0]) / focal[0]
                ray_y = (ideal_y - principal[1]) / focal[1]
                w = back[2, 0] * ray_x + back[2, 1] * ray_y + back[2, 2]
                u = (back[0, 0] * ray_x + back[0, 1] * ray_y + back[0, 2]) / w
                v = (back[1, 0] * ray_x + back[1, 1] * ray_y + back[1, 2]) / w
                if u < 0.0 or v < 0.0 or u >= modules or v >= modules:
                    continue
                in_u, in_v = u - math.floor(u), v - math.floor(v)
                if min(in_u, in_v) > 0.3 and max(in_u, in_v) < 0.7:
                    of = 2 * int(paper[m, int(v) + PADDING, int(u) + PADDING])
                    found[of] += image[row, column]
                    found[of + 1] += 1.0
    return found


@compiled
def _turn(vector: Array) -> Array:
    """Rotation by a small vector (Rodrigues)."""
    angle = math.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2)
    k = np.zeros((3, 3))
    k[0, 1], k[0, 2], k[1, 2] = -vector[2], vector[1], -vector[0]
    k[1, 0], k[2, 0], k[2, 1] = vector[2], -vector[1], vector[0]
    first, second = 1.0, 0.5
    if angle > 1e-8:
        first, second = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle**2
    out = np.eye(3)
    for i in range(3):
        for c in range(3):
            square = 0.0
            for n in range(3):
                square += k[i, n] * k[n, c]
            out[i, c] += first * k[i, c] + second * square
    return out
