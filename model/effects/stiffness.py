"""Stiffness of the cables other than the rig file says."""

from typing import TYPE_CHECKING, Any

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(machine: "Machine", stiffness_share: Any) -> "Machine":
    """k_w (1 + e)."""
    from dataclasses import replace

    return replace(machine, stiffness=machine.stiffness * (1.0 + stiffness_share))


EFFECT = Effect(
    name="stiffness",
    title="stiffness of the cables",
    acts=Acts.PARAMETER,
    equation="k_w (1 + e)",
    source="rig file",
    signature="one factor on k Delta L, in phase, no harmonics",
    parameters=(Parameter("stiffness_share", "1", 0.05, -0.5, 0.5, "e", magnitude=True),),
    change=change,
)
