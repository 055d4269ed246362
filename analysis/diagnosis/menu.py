"""Experiments that can be recorded next: motions, pretensions, and rig files that ask for them."""

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from analysis.diagnosis.recording import Recording
from analysis.diagnosis.segments import segments
from analysis.engine.bundle import Bundle
from cdpr8.rigfile import Excitation, Rig, load_rig
from cdpr8.rigfile.checks import structure_matrix_at_rest
from model import Machine, simulate
from model.rest import tones_hz

FREQUENCIES_HZ = (0.5, 1.0, 2.0, 4.0, 6.0)
"""Below 8 Hz, the paper's own limit."""

AMPLITUDES = (0.3, 1.5)
"""Shares of the amplitude of the runs there are."""

PRETENSIONS = (0.6, 1.6)
"""Factors on the part of the pretensions that carries no weight."""

SLOW_HZ = 0.25

PERIODS, LEAST_MOTION_S = 6, 5.0

SLOW_PERIODS = 3

LONG_S = 60.0

HOLD_S = 60.0
HOLD_LINES_HZ = 0.5
"""Of a long hold only what is slow is looked at: there is nothing else in it."""

SLOWLY = ("cable_creep", "cable_relaxation", "cell_drift", "cell_zero", "pretension")
"""What a hold shows."""

DECAY_S = 3.0

ASK_MIN, TIGHTEN_MIN = 0.5, 10.0
"""Minutes of rig time to ask for another motion, and to tighten eight cables and let them rest."""

ALIKE = 0.15
"""A motion whose numbers are all within this share of those of a run there is, is that run."""

NEAR_TONE = 0.2
"""No drive is proposed this near a tone of the platform, as a share of it."""

SLACKER = 0.5
"""A motion must leave every cable this share of the lowest tension of the runs there are."""

WEAKER, ATTEMPTS = 0.7, 4
"""Where it does not, it is tried again with so much of its amplitude, so often."""


@dataclass(frozen=True)
class Experiment:
    """One experiment.

    Attributes
    ----------
    what
        In words.
    excitation
        Its motion.
    rig
        The machine as it then is.
    minutes
        Of rig time.
    repeats
        It is so many times as long as what is simulated of it: the noise is that much less.
    """

    what: str
    excitation: Excitation
    rig: Rig
    minutes: float
    repeats: float = 1.0

    @property
    def simulated(self) -> Excitation:
        """What is simulated of its motion."""
        motion_s = round(self.excitation.motion_s / self.repeats, 3)
        return self.excitation.model_copy(update={"motion_s": motion_s})

    def recording(self, like: Recording) -> Recording:
        """The recording it would make, values left at zero; rates and noise are those of a run."""
        asked = self.simulated
        start = like.run.start.model_copy(update={"excitation": asked, "motion_start_known": True})
        run = replace(like.run, folder=Path("next"), rig=self.rig, start=start)
        tones = tuple(tones_hz(Machine.from_rig(self.rig)))
        quieter = [replace(one, covariance=one.covariance / self.repeats) for one in like.bundles]
        bundles = tuple(_empty(one, asked, tones) for one in quieter)
        return replace(like, run=run, excitation=asked, shift_s=0.0, bundles=bundles, notes=())


def experiments(
    recordings: Sequence[Recording], effects: Sequence[str] = SLOWLY
) -> tuple[Experiment, ...]:
    """What could be recorded next, beside runs of one machine.

    Parameters
    ----------
    recordings
        The runs there are; their motions are not proposed again, but for a longer one.
    effects
        What is to be told apart: without anything slow, no long hold.
    """
    moved = [one for one in recordings if one.excitation.amplitude_deg > 0.0]
    like = moved[0] if moved else recordings[0]
    own = like.excitation if moved else Excitation(drive=like.excitation.drive)
    rig = recordings[0].rig
    base = own.model_copy(update={"rest_s": 1.2, "motion_start_s": None, "ramp_s": 0.5})
    found = []
    lowest = SLACKER * float(simulate(rig, own, output_rate_hz=500.0).tension_n.min())
    for what, there, excitation, preparing in _wanted(rig, base, effects):
        taut = _taut(there, excitation, lowest * (1.0 if there is rig else 0.5))
        if taut is None or any(_same(taut, there, one) for one in recordings):
            continue
        long = taut.motion_s == LONG_S and taut.amplitude_deg > 0.0
        repeats = LONG_S / _motion_s(taut) if long else 1.0
        minutes = preparing + ASK_MIN + taut.duration_s / 60.0
        found.append(Experiment(what(taut), taut, there, minutes, repeats))
    return tuple(found)


def _motion_s(excitation: Excitation) -> float:
    """Some periods and the ramps."""
    least = PERIODS / excitation.frequency_hz + 2.0 * excitation.ramp_s
    return round(max(least, LEAST_MOTION_S), 2)


def _wanted(
    rig: Rig, base: Excitation, effects: Sequence[str]
) -> Iterator[tuple[Callable[[Excitation], str], Rig, Excitation, float]]:
    """What in words, machine, motion, and minutes of preparation."""
    tones = tones_hz(Machine.from_rig(rig))

    def motion(**changes: object) -> Excitation:
        changed = base.model_copy(update=changes)
        return changed.model_copy(update={"motion_s": _motion_s(changed)})

    for hertz in FREQUENCIES_HZ:
        if np.abs(tones - hertz).min() > NEAR_TONE * hertz:
            yield (lambda e: f"{_angle(e)} at {e.frequency_hz:g} Hz", rig,
                   motion(frequency_hz=hertz), 0.0)  # fmt: skip
    for share in AMPLITUDES:
        yield (lambda e: f"the same frequency, {_angle(e)}", rig,
               motion(amplitude_deg=round(share * base.amplitude_deg, 2)), 0.0)  # fmt: skip
    for axis in ("pitch", "roll", "yaw"):
        if axis != base.axis:
            yield lambda e: f"{_angle(e)} about another axis", rig, motion(axis=axis), 0.0
    slow = motion(frequency_hz=SLOW_HZ)
    slow = slow.model_copy(update={"motion_s": SLOW_PERIODS / SLOW_HZ + 2.0 * slow.ramp_s})
    yield lambda e: f"a slow motion, {_angle(e)} at {e.frequency_hz:g} Hz", rig, slow, 0.0
    hertz = max(base.frequency_hz, 1.5)
    stopped = base.model_copy(
        update={
            "frequency_hz": hertz, "ramp_s": 0.0, "rest_s": DECAY_S,
            "motion_s": round((int(4.0 * hertz) + 0.25) / hertz, 4),
        }
    )  # fmt: skip
    yield (lambda e: f"{_angle(e)}, stopped at once at its extreme, and the free decay after it",
           rig, stopped, 0.0)  # fmt: skip
    if set(effects) & set(SLOWLY):
        still = base.model_copy(update={"amplitude_deg": 0.0, "motion_s": HOLD_S})
        yield lambda e: f"a hold of {e.duration_s:.0f} s without motion", rig, still, 0.0
    long = base.model_copy(update={"motion_s": LONG_S})
    yield lambda e: f"the same motion for {e.motion_s:g} s", rig, long, 0.0
    for factor in PRETENSIONS:
        there = with_pretension(rig, factor)
        if there is not None:
            yield (partial(_tightened, factor), there, motion(), TIGHTEN_MIN)


def _tightened(factor: float, _: Excitation) -> str:
    return f"the same motion with pretensions of {factor:g} times the inner tension"


def _angle(excitation: Excitation) -> str:
    return f"{excitation.amplitude_deg:g} deg in {excitation.axis}"


def _same(asked: Excitation, rig: Rig, there: Recording) -> bool:
    """Whether a run there is was just this; a longer one is not."""
    had = there.excitation
    if asked.axis != had.axis or (asked.ramp_s > 0.0) != (had.ramp_s > 0.0):
        return False
    pairs = [(asked.amplitude_deg, had.amplitude_deg), (asked.frequency_hz, had.frequency_hz)]
    pairs += [
        (one.pretension_n.value, other.pretension_n.value)
        for one, other in zip(rig.cable, there.rig.cable, strict=True)
    ]
    long = asked.motion_s > 2.0 * had.motion_s
    return not long and all(abs(a - b) <= ALIKE * max(abs(a), abs(b)) for a, b in pairs)


def _taut(rig: Rig, excitation: Excitation, lowest_n: float) -> Excitation | None:
    """The motion, as large as leaves every cable taut; None where none does."""
    for _ in range(ATTEMPTS):
        if excitation.amplitude_deg == 0.0:
            return excitation
        seen = simulate(rig, excitation, output_rate_hz=500.0)
        if seen.tension_n.min() >= lowest_n:
            return excitation
        less = round(WEAKER * excitation.amplitude_deg, 2)
        excitation = excitation.model_copy(update={"amplitude_deg": less})
    return None


def with_pretension(rig: Rig, factor: float) -> Rig | None:
    """The same machine, its inner tensions by a factor; None where a cable would hang slack.

    Parameters
    ----------
    rig
        The machine.
    factor
        Of the part of the pretensions that carries no weight, so that it still hangs in balance.
    """
    tension = np.array([cable.pretension_n.value for cable in rig.cable])
    structure = structure_matrix_at_rest(rig)
    carrying = np.linalg.pinv(structure) @ (structure @ tension)
    changed = np.round(tension + (factor - 1.0) * (tension - carrying), 6)
    if changed.min() < 0.5 * min(factor, 1.0) * tension.min():
        return None
    cables = []
    for cable, value in zip(rig.cable, changed, strict=True):
        row = cable.pretension_n.model_copy(update={"value": float(value)})
        cables.append(cable.model_copy(update={"pretension_n": row}))
    return rig.model_copy(update={"cable": tuple(cables)})


def _empty(one: Bundle, excitation: Excitation, tones: tuple[float, ...]) -> Bundle:
    interval = float(np.median(np.diff(one.t_s)))
    if excitation.amplitude_deg == 0.0:
        # Averages of samples, as if they were fewer and quieter.
        block = max(round(0.25 / HOLD_LINES_HZ / interval), 1)
        interval *= block
        one = replace(one, covariance=one.covariance / block)
    t_s = np.arange(0.5 * interval, excitation.duration_s, interval)
    parts = segments(excitation, 0.0, float(t_s[0]), float(t_s[-1]))
    if excitation.amplitude_deg == 0.0:
        parts = tuple(replace(part, highest_hz=HOLD_LINES_HZ) for part in parts)
    value = np.zeros((len(t_s), one.value.shape[1]))
    return replace(
        one, t_s=t_s, value=value, segments=parts, tones_hz=tones, jitter=None, late=None
    )


def write_rig(experiment: Experiment, like: Recording, path: Path) -> Path:
    """Write a rig file that `rig record` takes, with the experiment's motion and pretensions.

    Parameters
    ----------
    experiment
        What to record.
    like
        A run of the machine: its rig file is taken.
    path
        Where to write.

    Raises
    ------
    RigFileError
        What was written is no rig file: a defect of this program.
    """
    import tomli_w

    folder = like.run.folder
    data = tomllib.loads((folder / "rig.toml").read_text(encoding="utf-8"))
    data["excitation"] = experiment.excitation.model_dump(mode="json", exclude_none=True)
    for table, cable, own in zip(data["cable"], experiment.rig.cable, like.rig.cable, strict=True):
        if cable.pretension_n != own.pretension_n:
            row = cable.pretension_n
            table["pretension_n"] = {"value": row.value, "sigma": row.sigma}
    intrinsics = data.get("camera", {}).get("intrinsics")
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(intrinsics, str) and (folder / intrinsics).is_file():
        (path.parent / intrinsics).write_bytes((folder / intrinsics).read_bytes())
    head = f"# Written by `analysis diagnose`: {experiment.what}.\n\n"
    path.write_text(head + tomli_w.dumps(data), encoding="utf-8")
    load_rig(path)
    return path
