"""The cable hangs through under its own weight: softer where the tension is low."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

STEPS = 5
"""Newton's, from above: the parabola's pull is then exact to rounding, however low it is."""

TINY = 1e-12
"""N, so that a cable that weighs nothing divides nothing by nothing."""


def pull(
    weight_share: Any,
    elastic: Any,
    pretension: Any,
    stiffness: Any,
    length: Any,
    line_density: Any,
    gravity: Any,
    direction_z: Any,
) -> Any:
    """Delta T of T = T_e + k [s(T) - s(T_0)], s = (w L)^2 L / (24 T^2).

    T^2 (T - a) = k s T^2 has one positive root: a cable hangs through rather than pushes.
    """
    weight = weight_share * line_density * gravity * length
    across = weight * weight * (1.0 - direction_z * direction_z)
    sag = stiffness * across * length / 24.0
    free = elastic - sag / (pretension * pretension)
    # Above the root, or so near below it that the first step leads there: where T = a + (k s
    # T^2)^(1/3), the left side is the larger.
    tension = 0.5 * (free + np.abs(free)) + _about_cube_root(sag) + TINY
    for _ in range(STEPS):
        tension -= (tension * (tension - free) - sag / tension) / (3.0 * tension - 2.0 * free)
    return tension - elastic


def _about_cube_root(value: Any) -> Any:
    """value^(1/4 + 1/16 + 1/64), without the C library: within an eighth from 1e-9 to 1e9."""
    fourth = np.sqrt(np.sqrt(value))
    sixteenth = np.sqrt(np.sqrt(fourth))
    return fourth * sixteenth * np.sqrt(np.sqrt(sixteenth))


EFFECT = Effect(
    name="cable_sag",
    title="sag of the cable",
    acts=Acts.CABLE,
    equation="T = T_e + k [s(T) - s(T_0)], s = (a rho g L cos beta)^2 L/(24 T^2)",
    source="Irvine, Cable Structures (1981), Section 2; Ernst, Bauingenieur 40 (1965) 52",
    signature="softening at low tension, about T^-3: even harmonics in phase",
    parameters=(
        Parameter(
            "weight_share",
            "1",
            1.0,
            0.0,
            4.0,
            "a: weight over that of the rig file's line density",
            magnitude=True,
        ),
    ),
    pull=pull,
)
