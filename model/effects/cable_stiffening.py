"""Fibres that straighten: a cable stiffer the more it is stretched, or the more it pulls."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def pull(cubic_n_per_m3: Any, asymmetry_m: Any, elongation: Any) -> Any:
    """k_3 Delta L^2 (Delta L + a)."""
    return cubic_n_per_m3 * elongation * elongation * (elongation + asymmetry_m)


EFFECT = Effect(
    name="cable_stiffening",
    title="stiffening of the cable",
    acts=Acts.CABLE,
    equation="T += k_3 Delta L^2 (Delta L + a)",
    source="Duffing (1918); Masri & Caughey, J. Appl. Mech. 46 (1979) 433; a stiffness that "
    "follows the tension, k (1 + b (T - T_0)/T_0), to third order: a = 3 T_0/(b k), "
    "k_3 = k (b k/T_0)^2/6",
    signature="3rd harmonic in phase, and the 2nd where it follows the tension; the resonance "
    "rises with amplitude; no loop",
    parameters=(
        Parameter("cubic_n_per_m3", "N/m3", 5e6, 0.0, 5e8, "k_3", magnitude=True),
        Parameter("asymmetry_m", "m", 0.0, 0.0, 0.1, "a; 0: alike both ways"),
    ),
    pull=pull,
    longest_step_s=3.1e-3,
    cost="stretched, it rings faster than at rest",
)
