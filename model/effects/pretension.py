"""Pretension of the cables other than the rig file says."""

from typing import TYPE_CHECKING, Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.machine import Machine


def change(machine: "Machine", pretension_offset_n: Any, trimmed_share: Any) -> "Machine":
    """T_0 + d, and so much of the least change by which what else moved leaves X* = 0 at rest.

    What moves the balance, in the order of the library's names, is before it.
    """
    from dataclasses import replace

    pretension = machine.pretension + pretension_offset_n
    if trimmed_share[0]:
        least, *_ = np.linalg.lstsq(machine.structure, machine.unbalanced)
        pretension = pretension - trimmed_share[0] * least
    return replace(machine, pretension=pretension)


EFFECT = Effect(
    name="pretension",
    title="pretension of the cables",
    acts=Acts.PARAMETER,
    equation="T_0 + d - s A^+ w",
    source="rig file",
    signature="mean tension, and the platform's rest where the sum does not balance",
    parameters=(
        Parameter("pretension_offset_n", "N", 0.5, -20.0, 20.0, "d", magnitude=True),
        Parameter(
            "trimmed_share",
            "1",
            0.0,
            -1.0,
            2.0,
            "1: whoever tightened the cables left the platform at X* = 0; 0: it hangs where it may",
            False,
            True,
        ),
    ),
    change=change,
)
