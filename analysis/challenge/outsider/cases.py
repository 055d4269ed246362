"""What the outsider asks of a machine, one tone or a campaign of six runs, and how effects fall."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider.concealed import Concealed, Effect, catalogue
from analysis.challenge.outsider.machine import Machine, Offset
from analysis.challenge.outsider.plant import simulate
from analysis.challenge.outsider.record import Sensing
from analysis.challenge.outsider.rigs import (
    drawn,
    drawn_offset,
    inner_share,
    packaged,
    swung,
    with_pretension,
)
from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]

OTHER_MACHINES = 0.3
"""Share of cases on machines other than CDPR-8."""

USUAL_HZ, USUAL_DEG = 2.06, 2.0
USUAL = 0.6
"""Share of runs at the paper's own frequency, and of those at its amplitude."""

QUICK = {"cable_end_forcing": (3.5, 4.0), "inertia": (3.0, 4.0), "drive_backlash": (3.0, 4.0)}
"""Frequencies, Hz, at which these show at all."""

ON_CDPR8 = {"cable_end_forcing", "cable_sag", "cable_slack"}
"""Its long, thin cables hang and swing; the tensions of a drawn machine are too high for it."""

LEAST_N = 1.8
"""A machine whose cables would hang looser in its motion is asked for the usual amplitude."""

SLACK_N = -0.8
"""A machine that conceals slack cables is loosened until its rig file's law goes so far down."""

LOOSER_BY_N = 0.1
LOOSEST_N = 30.0

CAMPAIGN = ((2.06, 2.0, 0.0), (2.06, 1.0, 0.0), (1.2, 2.0, 0.0), (3.4, 1.2, 0.0),
            (2.06, 1.6, 2.5), (2.06, 1.4, -1.5))  # fmt: skip
"""Frequency (Hz), amplitude (deg) and change of the largest inner tension (N) of each run."""
CAMPAIGN_LEAST_N = 1.2
TIGHTER_N = 0.5
"""A machine that could not be loosened so far is tightened by this."""

SPREAD = 0.35
"""Usual sizes are drawn within this factor's logarithm."""

LOOK_STEP_S = 5e-4


def excitation(
    generator: np.random.Generator,
    frequency_hz: float | None = None,
    amplitude_deg: float | None = None,
) -> Excitation:
    """Twelve seconds of pitch; often the paper's own.

    Parameters
    ----------
    generator
        Source of the draw.
    frequency_hz, amplitude_deg
        Where they are given; else drawn.
    """
    usual_tone, usual_reach = generator.uniform(size=2) < USUAL
    tone = USUAL_HZ if usual_tone else round(float(generator.uniform(1.0, 4.0)), 2)
    reach = USUAL_DEG if usual_reach else round(float(generator.uniform(1.2, 2.3)), 2)
    return Excitation(
        axis="pitch",
        amplitude_deg=reach if amplitude_deg is None else amplitude_deg,
        frequency_hz=tone if frequency_hz is None else frequency_hz,
        rest_s=1.0,
        motion_s=12.0,
        ramp_s=0.5,
        platform_offset_m=(1e-4, 0.0, 0.0),
    )


def planned(
    kind: str, effects: Sequence[str], generator: np.random.Generator
) -> tuple[list[Rig], Sensing, Offset]:
    """The rig file of each run, how it is measured, and the true machine.

    Parameters
    ----------
    kind
        "single" or "campaign".
    effects
        Names of what it will conceal: where an effect shows only on some runs, those are chosen.
    generator
        Source of the draw.
    """
    own = generator.uniform() < OTHER_MACHINES and not ON_CDPR8 & set(effects)
    quick = [QUICK[name] for name in effects if name in QUICK]
    tone = round(float(generator.uniform(*quick[0])), 2) if quick else None
    if kind == "campaign":
        # A drawn machine is made for the widest of the motions, not for each.
        first = excitation(generator, USUAL_HZ, 2.2)
    else:
        first = excitation(generator, tone)
    rig = drawn(first, generator) if own else _excited(packaged(), first)
    if "cable_slack" in effects:
        rig = loosened(rig)
    runs = _campaign(rig, tone, generator) if kind == "campaign" else [rig]
    sensing = Sensing.drawn(generator)
    return [_stated(one, sensing) for one in runs], sensing, drawn_offset(rig, generator)


def _excited(rig: Rig, first: Excitation) -> Rig:
    if swung(Machine.from_rig(rig), first).min() < LEAST_N:
        first = first.model_copy(update={"amplitude_deg": USUAL_DEG})
    return rig.model_copy(update={"excitation": first})


def _campaign(rig: Rig, tone: float | None, generator: np.random.Generator) -> list[Rig]:
    """Six runs of one machine: other amplitudes, frequencies and pretensions."""
    machine = Machine.from_rig(rig)
    share = inner_share(machine)
    runs = []
    for number, (frequency, amplitude, change) in enumerate(CAMPAIGN):
        asked = excitation(generator, tone if tone and number == 0 else frequency, amplitude)
        changed = with_pretension(rig, machine.pretension + change * share)
        if change < 0.0 and swung(Machine.from_rig(changed), asked).min() < CAMPAIGN_LEAST_N:
            changed = with_pretension(rig, machine.pretension + TIGHTER_N * share)
        runs.append((changed if change else rig).model_copy(update={"excitation": asked}))
    return runs


def loosened(rig: Rig) -> Rig:
    """The same machine, its inner tensions so low that a cable would have to push."""
    machine = Machine.from_rig(rig)
    share = inner_share(machine)
    for less in np.arange(0.0, LOOSEST_N, LOOSER_BY_N):
        looser = with_pretension(rig, machine.pretension - less * share)
        if swung(Machine.from_rig(looser), rig.excitation).min() < SLACK_N:
            break
    return looser


def _stated(rig: Rig, sensing: Sensing) -> Rig:
    """The rig file says how noisy its cells are, where it does."""
    if not sensing.noise_stated:
        return rig
    noise = round(float(sensing.tension_noise_n[0]), 4)
    cables = []
    for cable in rig.cable:
        amplifier = cable.amplifier
        if amplifier is not None:
            amplifier = amplifier.model_copy(update={"noise_n": noise})
        cables.append(cable.model_copy(update={"amplifier": amplifier}))
    return rig.model_copy(update={"cable": tuple(cables)})


def placed(name: str, rig: Rig, offset: Offset, generator: np.random.Generator) -> Concealed:
    """An effect at its usual size, on some of the cables, with its further numbers.

    Parameters
    ----------
    name
        Of the effect.
    rig, offset
        The machine of the first run.
    generator
        Source of the draw.
    """
    effect = catalogue()[name]
    cables = effect.chosen(generator)
    details = dict(effect.draw(generator))
    if name == "cell_saturation":
        tension = simulate(rig, offset, step_s=LOOK_STEP_S).tension_n[:, cables[0] - 1]
        details = {"rest_n": float(tension[0]), "top_n": float(tension.max())}
    size = effect.typical * float(np.exp(generator.uniform(-SPREAD, SPREAD)))
    size = min(max(size, effect.least), effect.most)
    if effect.signed and generator.uniform() < 0.5:
        size = -size
    return Concealed(effect, size, cables, details)


def rival(
    effect: Effect, cables: Sequence[int], rig: Rig, generator: np.random.Generator
) -> Concealed:
    """An effect at its usual size, on the cables of another; its further numbers drawn.

    Parameters
    ----------
    effect
        Which.
    cables
        Of the other, one or more.
    rig
        Of the first run.
    generator
        Source of the draw.
    """
    details = dict(effect.draw(generator))
    if effect.name == "cell_saturation":
        machine = Machine.from_rig(rig)
        swing = swung(machine, rig.excitation)[:, cables[0] - 1]
        rest = float(machine.pretension[cables[0] - 1])
        details = {"rest_n": rest, "top_n": max(float(swing.max()), rest + 1.0)}
    taken = tuple(cables)
    if not effect.cables:
        taken = ()
    elif set(effect.cables) == {"one"}:
        taken = taken[:1]
    elif set(effect.cables) == {"swap"}:
        taken = taken[:2] if len(taken) > 1 else (*taken, taken[0] % 8 + 1)
    return Concealed(effect, effect.typical, taken, details)
