"""Damping of the cable along itself (Kelvin-Voigt)."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def pull(viscous_n_s_per_m: Any, elongation_rate: Any) -> Any:
    """Add c Delta L'."""
    return viscous_n_s_per_m * elongation_rate


def steepest(viscous_n_s_per_m: Any) -> Any:
    """It is c."""
    return viscous_n_s_per_m


EFFECT = Effect(
    name="cable_viscous",
    title="Kelvin-Voigt damping of the cable",
    acts=Acts.CABLE,
    equation="T += c Delta L'",
    source="Kelvin-Voigt; Findley, Lai & Onaran, Creep and Relaxation (1976), Section 5.3",
    signature="quadrature in proportion to the frequency, no harmonics; a late camera looks the "
    "same but dissipates nothing",
    parameters=(Parameter("viscous_n_s_per_m", "N s/m", 4.0, 0.0, 60.0, "c", magnitude=True),),
    pull=pull,
    steepest=steepest,
)
