"""Mass of the platform other than the rig file says."""

from typing import TYPE_CHECKING, Any

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(machine: "Machine", mass_share: Any) -> "Machine":
    """Make it m (1 + e)."""
    from dataclasses import replace

    return replace(machine, mass=machine.mass * (1.0 + float(mass_share[0])))


EFFECT = Effect(
    name="mass",
    title="mass of the platform",
    acts=Acts.PARAMETER,
    equation="m (1 + e)",
    source="rig file",
    signature="in the wrench balance only: a sag at rest, and -w^2 in translation",
    parameters=(Parameter("mass_share", "1", 0.03, -0.5, 0.5, "e", False, True),),
    change=change,
)
