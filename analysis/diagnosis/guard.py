"""Damping that ends the platform's own ringing, where lines are asked and the ring is not."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analysis.engine.system import Ring
from cdpr8.rigfile import Rig
from model import Machine, Simulation
from model.rest import tones_hz

Array = NDArray[np.float64]

GUARD = 0.08
"""Share of critical damping that keeps the platform from ringing, where that is asked for."""

MOST_BIAS = 0.1
"""And no more of it than moves a tone's answer to the drive by this share in quadrature."""

GUARDS: dict[Ring, tuple[float, ...]] = {"left_out": (0.5, 1.0), "damped": (1.0,), "as_is": (0.0,)}
"""Shares of the guard with which a point is simulated."""


def without_bias(simulations: Sequence[Simulation]) -> Simulation:
    """One simulation as it is; of two, the second with twice the damping, none of the bias."""
    one, other = simulations[0], simulations[-1]
    if one is other or one.tension_n.shape != other.tension_n.shape:
        return one
    return replace(
        one,
        tension_n=np.maximum(2.0 * one.tension_n - other.tension_n, 0.0),
        pose=2.0 * one.pose - other.pose,
        pose_rate=2.0 * one.pose_rate - other.pose_rate,
    )


def guard_of(rig: Rig, drive_hz: float) -> Array:
    """Damping of the cables that ends the platform's ringing in some cycles, N s/m, shape (8,).

    In proportion to stiffness, so that it leaves the drive's own frequency nearly alone; less of
    it where the drive comes near a tone, which it would damp as well.
    """
    machine = Machine.from_rig(rig)
    tones = tones_hz(machine)
    above = tones[tones > 1.5 * drive_hz]
    lowest = float(above.min()) if above.size else float(tones.max())
    share = GUARD
    if drive_hz > 0.0:
        # By so much more than a share of its damping each tone would be off in quadrature.
        gain = 2.0 * tones * drive_hz / np.abs(tones**2 - drive_hz**2) * (tones / lowest)
        share = min(GUARD, MOST_BIAS / float(gain.max()))
    return np.asarray(2.0 * share / (2.0 * np.pi * lowest) * machine.stiffness)
