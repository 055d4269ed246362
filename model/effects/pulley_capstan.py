"""Friction in proportion to the tension: the cable is wrapped round a pulley that sticks."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter
from model.library.smooth import smooth_sign


def pull(
    friction: Any,
    wrap_rad: Any,
    switch_m_per_s: Any,
    axial_velocity: Any,
    elastic: Any,
) -> Any:
    """T (exp(mu theta sgn v) - 1), the exponential by its series: 2e-6 of T at mu theta = 0.3."""
    a = friction * wrap_rad * smooth_sign(axial_velocity, switch_m_per_s)
    series = 1.0 + a / 2.0 * (1.0 + a / 3.0 * (1.0 + a / 4.0 * (1.0 + a / 5.0)))
    return elastic * a * series


def steepest(friction: Any, wrap_rad: Any, switch_m_per_s: Any, pretension: Any) -> Any:
    """Give mu theta T / v_s, at reversal, with room for T above T_0."""
    return 2.0 * pretension * friction * wrap_rad / switch_m_per_s


EFFECT = Effect(
    name="pulley_capstan",
    title="capstan friction at the pulley",
    acts=Acts.PULLEY,
    equation="T += T (exp(mu theta v / sqrt(v^2 + v_s^2)) - 1)",
    source="Euler-Eytelwein; Johnson, Contact Mechanics (1985), Section 8.2",
    signature="step at reversal that grows with T: even harmonics, 2nd 0.85 mu theta k A; scales "
    "with the pretension",
    parameters=(
        Parameter("friction", "1", 0.03, 0.0, 0.5, "mu", magnitude=True),
        Parameter("wrap_rad", "rad", 1.5708, 0.1, 6.2832, "theta, angle of contact"),
        Parameter("switch_m_per_s", "m/s", 2e-3, 1e-4, 0.05, "v_s, width of the reversal"),
    ),
    pull=pull,
    steepest=steepest,
    longest_step_s=1e-3,
    cost="creeps below v_s instead of sticking; four times the steps",
)
