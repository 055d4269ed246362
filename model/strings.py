"""What cables are as strings beside the rig file: numbers that a fit moves and no effect is."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from model.machine import Machine

Array = NDArray[np.float64]

LEAST_LEFT = 0.05
"""A cable has some weight, and its string some loss, however far a fit strays."""


@dataclass(frozen=True)
class Strings:
    """By how much cables are other strings than the rig file says: what a fit moves.

    Parameters
    ----------
    density_share, loss_share
        rho_w A (1 + e) and c_w (1 + d) of Eq. 17: of every cable, or of each, shape (8,). What
        would leave less than `LEAST_LEFT` of either leaves that.
    """

    density_share: float | tuple[float, ...] = 0.0
    loss_share: float | tuple[float, ...] = 0.0

    def of(self, machine: Machine) -> Machine:
        """The machine with such cables."""
        if self == UNCHANGED:
            return machine
        return replace(
            machine,
            line_density=machine.line_density * left_of(self.density_share),
            damping=machine.damping * left_of(self.loss_share),
        )


def left_of(share: float | tuple[float, ...]) -> Array:
    """What is left of a number that is off by a share, over what the rig file says."""
    return np.maximum(1.0 + np.asarray(share), LEAST_LEFT)


UNCHANGED = Strings()
