"""The cable hangs through under its own weight: softer where the tension is low."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

FLOOR = 0.1
"""The law is not followed below this share of the pretension, where the parabola is none."""


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
    """Delta T of T = T_e + k [s(T) - s(T_0)], s = (w L)^2 L / (24 T^2), by two Newton steps."""
    weight = weight_share * line_density * gravity * length
    across = weight * weight * (1.0 - direction_z * direction_z)
    sag = stiffness * across * length / 24.0
    floor = FLOOR * pretension
    taut = np.sqrt(elastic * elastic + floor * floor)
    at_rest = sag / (pretension * pretension + floor * floor)
    first = (sag / (taut * taut) - at_rest) / (1.0 + 2.0 * sag / (taut * taut * taut))
    again = np.sqrt((elastic + first) * (elastic + first) + floor * floor)
    short = sag / (again * again) - at_rest - first
    return first + short / (1.0 + 2.0 * sag / (again * again * again))


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
