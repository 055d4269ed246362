"""The paper's Section 4: motion, frequencies, and the runs behind Table II and Figs. 6 to 9."""

from collections.abc import Mapping
from dataclasses import dataclass

from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.schema import Rig
from model.simulation import Simulation
from model.simulator import simulate
from model.sweep.plan import grid

LOW_HZ = 2.06
"""Lower end of the interval of Section 4.1."""

SHOWN_HZ = (10.0, 14.0)
"""Figs. 8 and 9."""

COMPARED_HZ = (LOW_HZ, 14.0)
"""Table II, Figs. 6 and 7."""

FREQUENCIES_HZ = (LOW_HZ, *grid(2.25, 20.0, 72))
"""Section 4.1: 2.06 to 20 Hz; the paper does not say in what steps, here 0.25 Hz."""

REPETITIONS = 16

EXCITATION = Excitation(
    axis="pitch",
    amplitude_deg=2.0,
    frequency_hz=LOW_HZ,
    rest_s=0.0,
    motion_s=10.0,
    ramp_s=0.0,
    platform_offset_m=(1e-4, 0.0, 0.0),
    cable_offset_m=1e-4,
)
"""Section 4.1. The paper does not say how long it simulated: 10 s here."""


@dataclass(frozen=True)
class Runs:
    """The single runs the paper shows, by frequency.

    Parameters
    ----------
    with_effect, without_effect
        Eq. 18, and Eq. 18 with X_w = 0.
    """

    with_effect: Mapping[float, Simulation]
    without_effect: Mapping[float, Simulation]


def run_shown(rig: Rig) -> Runs:
    """Simulate what Table II and Figs. 6 to 9 show, from the paper's own start."""
    motions = {
        frequency: EXCITATION.model_copy(update={"frequency_hz": frequency})
        for frequency in sorted({*SHOWN_HZ, *COMPARED_HZ})
    }
    return Runs(
        {frequency: simulate(rig, motion) for frequency, motion in motions.items()},
        {
            frequency: simulate(rig, motions[frequency], excitation_effect=False)
            for frequency in COMPARED_HZ
        },
    )
