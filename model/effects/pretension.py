"""Pretension of the cables other than the rig file says."""

from typing import TYPE_CHECKING, Any

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(machine: "Machine", pretension_offset_n: Any) -> "Machine":
    """T_0 + d."""
    from dataclasses import replace

    return replace(machine, pretension=machine.pretension + pretension_offset_n)


EFFECT = Effect(
    name="pretension",
    title="pretension of the cables",
    acts=Acts.PARAMETER,
    equation="T_0 + d",
    source="rig file",
    signature="mean tension, and the platform's rest where the sum does not balance",
    parameters=(Parameter("pretension_offset_n", "N", 0.5, -20.0, 20.0, "d", magnitude=True),),
    change=change,
)
