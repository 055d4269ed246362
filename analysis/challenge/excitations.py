"""What the machine is asked to do: one tone, or a campaign of about six runs."""

import numpy as np

from analysis.challenge.rigs import with_pretension
from cdpr8.rigfile import Excitation, Rig

AXES = ("pitch", "pitch", "pitch", "pitch", "roll", "yaw")
"""Mostly the paper's own."""

SLOWEST_HZ, QUICKEST_HZ = 0.5, 6.0


def single(generator: np.random.Generator) -> Excitation:
    """One tone of 10 to 14 s in all.

    Parameters
    ----------
    generator
        Source of the draw.
    """
    frequency = float(np.exp(generator.uniform(*np.log([0.8, 5.0]))))
    amplitude = float(generator.uniform(0.6, 2.4))
    if generator.uniform() < 0.25:
        frequency, amplitude = 2.06, 2.0
    rest_s = round(float(generator.uniform(0.9, 1.6)), 2)
    whole_s = float(generator.uniform(10.0, 14.0))
    return Excitation(
        axis=AXES[generator.integers(len(AXES))],
        amplitude_deg=round(amplitude, 3),
        frequency_hz=round(frequency, 3),
        rest_s=rest_s,
        motion_s=round(whole_s - 2.0 * rest_s, 2),
        ramp_s=0.5,
        platform_offset_m=(1e-4, 0.0, 0.0) if generator.uniform() < 0.25 else (0.0, 0.0, 0.0),
    )


def campaign(rig: Rig, generator: np.random.Generator) -> list[tuple[Rig, Excitation]]:
    """About six runs of one machine: other amplitudes, frequencies, pretensions, a free decay.

    Parameters
    ----------
    rig
        The machine.
    generator
        Source of the draw.
    """
    first = single(generator)
    amplitude, frequency = first.amplitude_deg, first.frequency_hz

    def other(**changes: object) -> Excitation:
        fresh = single(generator)
        kept = {"axis": first.axis, "amplitude_deg": amplitude, "frequency_hz": frequency}
        return Excitation.model_validate(fresh.model_dump() | kept | changes)

    quick = float(np.clip(frequency * generator.uniform(1.8, 2.8), SLOWEST_HZ, QUICKEST_HZ))
    slow = float(np.clip(frequency * generator.uniform(0.3, 0.55), SLOWEST_HZ, QUICKEST_HZ))
    runs = [
        (rig, first),
        (rig, other(amplitude_deg=round(amplitude * float(generator.uniform(0.2, 0.4)), 3))),
        (rig, other(frequency_hz=round(quick, 3), amplitude_deg=round(amplitude * 0.6, 3))),
        (rig, other(frequency_hz=round(slow, 3))),
    ]
    factors = [float(generator.uniform(1.35, 1.8)), float(generator.uniform(0.65, 0.8))]
    for factor in factors[: 1 + int(generator.uniform() < 0.4)]:
        changed = with_pretension(rig, factor)
        if changed is not None:
            runs.append((changed, other()))
    runs.append((rig, _released(first, generator)))
    if generator.uniform() < 0.4:
        axis = "roll" if first.axis == "pitch" else "pitch"
        runs.append((rig, other(axis=axis)))
    return runs


def _released(first: Excitation, generator: np.random.Generator) -> Excitation:
    """The drive stops at once near an extreme: what follows is free decay."""
    frequency = max(first.frequency_hz, 1.5)
    cycles = int(4.5 * frequency) + 0.25
    return Excitation(
        axis=first.axis,
        amplitude_deg=round(first.amplitude_deg * float(generator.uniform(0.5, 1.0)), 3),
        frequency_hz=frequency,
        rest_s=3.5,
        motion_s=round(cycles / frequency, 3),
        ramp_s=0.0,
        platform_offset_m=(0.0, 0.0, 0.0),
    )
