"""Fibres that straighten: a cable stiffer the more it is stretched."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter


def pull(cubic_n_per_m3: Any, elongation: Any) -> Any:
    """k_3 Delta L^3."""
    return cubic_n_per_m3 * elongation * elongation * elongation


EFFECT = Effect(
    name="cable_stiffening",
    title="stiffening of the cable",
    acts=Acts.CABLE,
    equation="T += k_3 Delta L^3",
    source="Duffing (1918); Masri & Caughey, J. Appl. Mech. 46 (1979) 433",
    signature="3rd harmonic in phase; the resonance rises with amplitude; no loop",
    parameters=(Parameter("cubic_n_per_m3", "N/m3", 5e6, 0.0, 1e8, "k_3", magnitude=True),),
    pull=pull,
)
