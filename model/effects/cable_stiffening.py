"""Fibres that straighten: a cable stiffer the more it is stretched, or the more it pulls."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def pull(
    cubic_n_per_m3: Any,
    quadratic_share: Any,
    hardening: Any,
    elongation: Any,
    stiffness: Any,
    pretension: Any,
) -> Any:
    """As the equation says, by the series of both functions up to u^11: |u| < 3."""
    rise = stiffness / pretension
    square = hardening * rise * elongation * hardening * rise * elongation
    odd = 1.0 + square / 20.0 * (
        1.0 + square / 42.0 * (1.0 + square / 72.0 * (1.0 + square / 110.0))
    )
    even = 1.0 + square / 12.0 * (
        1.0 + square / 30.0 * (1.0 + square / 56.0 * (1.0 + square / 90.0))
    )
    alike, more = elongation * odd, quadratic_share * 3.0 / rise * even
    return cubic_n_per_m3 * elongation * elongation * (alike + more)


EFFECT = Effect(
    name="cable_stiffening",
    title="stiffening of the cable",
    acts=Acts.CABLE,
    equation="T += 6 k_3 [sinh u - u + c b (cosh u - 1)]/q^3, u = q Delta L, q = b k/T_0: "
    "k_3 (Delta L^3 + 3 c T_0 Delta L^2/k) for small b; with c = 1/b and k_3 = k q^2/6 the "
    "stiffness follows the tension, dT/dDelta L = k (1 + b (T - T_0)/T_0)",
    source="Duffing (1918); Masri & Caughey, J. Appl. Mech. 46 (1979) 433",
    signature="3rd harmonic in phase, and the 2nd where it follows the tension; the resonance "
    "rises with amplitude; no loop",
    parameters=(
        Parameter("cubic_n_per_m3", "N/m3", 5e6, 0.0, 5e8, "k_3", magnitude=True),
        Parameter("quadratic_share", "1", 0.0, 0.0, 30.0, "c; 0: alike both ways", False),
        Parameter("hardening", "1", 0.3, 0.03, 3.0, "b", False),
    ),
    pull=pull,
    longest_step_s=3.1e-3,
    cost="stretched, it rings faster than at rest",
)
