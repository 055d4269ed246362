"""A run as the engine sees it: bundles of channels with times, noise and stretches of time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.noise import (
    ESTIMATED,
    LEAST_REST,
    about_line,
    at_rest,
    instants_s,
    stated_covariance,
    with_instants,
)
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.tones import RESONANT, resonant
from analysis.noise_floor import noise_floor
from analysis.series import measured_cables
from cdpr8.errors import DataError
from cdpr8.rigfile import Rig
from cdpr8.rigfile.excitation import Excitation
from cdpr8.runfolder import POSE_AXES, FrameFlag, Run
from model import Machine
from model.rest import tones_hz

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

HANGS_SIGMAS, HANGS_SHARE = 4.0, 0.03
"""A cable hangs slack where so much of its samples lies within so many sigmas of zero: one whose
tension only comes to zero and turns is there for less."""

MOST_HZ = 250.0
"""Faster tensions are averaged in blocks down to about this; nothing here is faster than 30 Hz."""

LINES_HZ = 25.0
"""Of stretches that do not repeat, lines up to here."""

LEAST_FRAMES, LEAST_REST_FRAMES = 20, 10
"""Poses that are of use, and those at rest that a noise level needs."""

OF_LINES = 4
"""A median of lines tells as much of the noise as so many times fewer samples at rest."""

LEAST_NOISE_N = 2e-4
"""Below this the resolution of the electronics is the noise."""

LEAST_NOISE_M, LEAST_NOISE_RAD = 1e-6, 1e-6

HELD_SHARE = 0.3
"""Of the steady cycles, kept back."""

LEAST_PERIODS = 6
"""Fewer steady periods than this are not split."""

BASE_SHARE = 1e-4
"""What two good simulators of the same equations differ by, as a share of the variation."""

CLEAR_S = 0.006
"""A motion starts with a jump: what a sample this near it shows is a matter of its instant, and of
how two rows of a simulation are joined."""

_DEGREES = np.array([1.0, 1.0, 1.0, *[np.pi / 180.0] * 3])


OUTPUT_HZ, ABRUPT_HZ = 333.0, 1332.0
"""Rows a second: what cubics through them miss of a ring is 0.08 of the noise, rms. Where a motion
begins or ends at once, tones of 60 and 80 Hz ring, of which 333 Hz miss 4 and 12 %, more than the
noise. Four rows a step take half as long again."""


@dataclass(frozen=True)
class Recording:
    """One run, ready for the engine.

    Attributes
    ----------
    run
        As loaded.
    excitation
        What was commanded.
    shift_s
        How much later than it says the motion started; 0 where the run knows.
    cables
        Cables with samples.
    bundles
        The tensions of these, one bundle each, and then the pose where there is one.
    has_pose
        Whether the last bundle is the pose.
    notes
        What a reader must know.
    averaged_s2
        Of each of these cables: the variance of the instants whose values are one sample, s^2.
    """

    run: Run
    excitation: Excitation
    shift_s: float
    cables: tuple[int, ...]
    bundles: tuple[Bundle, ...]
    has_pose: bool
    notes: tuple[str, ...]
    averaged_s2: tuple[float, ...]

    @property
    def rig(self) -> Rig:
        """The machine as the run has it."""
        return self.run.rig

    @property
    def hanging(self) -> tuple[int, ...]:
        """Cables that hang slack in a part of the motion: their tension lies at zero, not below."""
        tensions = (one for one in self.bundles if one.kind == "tension")
        return tuple(
            cable
            for cable, one in zip(self.cables, tensions, strict=True)
            if _hangs(one.value[:, 0], float(np.sqrt(one.covariance[0, 0])))
        )

    @property
    def output_hz(self) -> float:
        """Rows a second of a simulation of it."""
        abrupt = self.excitation.ramp_s == 0.0 or self.excitation.ending == "at_once"
        return ABRUPT_HZ if abrupt else OUTPUT_HZ


def recording(run: Run, pose: "pd.DataFrame | None", shift_s: float = 0.0) -> Recording:
    """Make bundles of a run.

    Parameters
    ----------
    run
        The run.
    pose
        Columns of pose.csv; None: there is none, and tensions have to do.
    shift_s
        How much later than it says the motion started.

    Raises
    ------
    DataError
        Nothing usable was measured.
    """
    excitation = run.start.excitation
    cables = measured_cables(run)
    if not cables:
        raise DataError("no cable has usable tension samples", where=str(run.folder))
    notes: list[str] = []
    read = [_tension(run, cable, excitation, shift_s, notes) for cable in cables]
    bundles = _instants([one for one, _ in read], excitation, shift_s, notes)
    seen = None if pose is None else _pose(run, pose, excitation, shift_s, notes)
    if seen is not None:
        bundles += _instants([seen], excitation, shift_s, notes)
    else:
        notes.append("no pose: cameras and clocks cannot be told from what the platform does")
    near = [tone for tone in bundles[0].tones_hz if resonant(tone, excitation.frequency_hz)]
    if near and excitation.amplitude_deg > 0.0:
        notes.append(
            f"the drive at {excitation.frequency_hz:g} Hz is within {100.0 * RESONANT:.0f} % of a "
            f"tone of the platform, {near[0]:.1f} Hz: only averages and what it does at rest can "
            "be foretold; drive it slower or faster"
        )
    lost = [str(c) for c in range(1, len(run.rig.cable) + 1) if c not in cables]
    if lost:
        notes.append(f"no usable tension of cable {', '.join(lost)}")
    made = Recording(
        run,
        excitation,
        shift_s,
        cables,
        tuple(bundles),
        seen is not None,
        tuple(notes),
        tuple(averaged_s2 for _, averaged_s2 in read),
    )
    if made.hanging:
        slack = ", ".join(str(one) for one in made.hanging)
        notes.append(
            f"cable {slack}: its tension lies at zero for part of the time: it hangs slack"
        )
    return replace(made, notes=tuple(notes))


def _hangs(tension_n: Array, sigma_n: float) -> bool:
    """Whether a tension that is none at times lies at zero for longer than it takes to pass."""
    near = HANGS_SIGMAS * sigma_n
    at_zero, below = np.abs(tension_n) < near, tension_n < -near
    pulls = float(np.median(tension_n)) > HANGS_SIGMAS * near
    return pulls and bool(at_zero.mean() > HANGS_SHARE > 10.0 * below.mean())


def segments(
    excitation: Excitation, shift_s: float, first_s: float, last_s: float
) -> tuple[Segment, ...]:
    """Rest, onset, steady motion (used and kept back), stop and what follows."""
    if excitation.amplitude_deg == 0.0:
        return (Segment(first_s, last_s + 1e-9, None, LINES_HZ, name="whole"),)
    start, end = excitation.start_s + shift_s, excitation.end_s + shift_s
    first, last = (one + shift_s for one in excitation.steady_window_s)
    steady = (first, min(last, last_s + 1e-9))
    found: list[Segment] = []

    def free(a: float, b: float, name: str) -> None:
        a, b = max(a, first_s), min(b, last_s + 1e-9)
        if b - a > 0.05:
            found.append(Segment(a, b, None, LINES_HZ, name=name))

    free(first_s, start - CLEAR_S, "rest")
    free(start + CLEAR_S, steady[0], "onset")
    frequency = excitation.frequency_hz
    periods = int((steady[1] - steady[0]) * frequency + 1e-6)
    if periods >= LEAST_PERIODS:
        middle = steady[0] + round(periods * (1.0 - HELD_SHARE)) / frequency
        found.append(Segment(steady[0], middle, frequency, name="steady"))
        found.append(Segment(middle, steady[1], frequency, held_out=True, name="steady, held out"))
    elif periods >= 2:
        found.append(Segment(*steady, frequency, name="steady"))
    else:
        free(*steady, "steady")
    free(steady[1], end, "stop")
    free(end, last_s + 1.0, "after")
    return tuple(found)


def _tension(
    run: Run, cable: int, excitation: Excitation, shift_s: float, notes: list[str]
) -> tuple[Bundle, float]:
    """A cable's tension, and the variance of the instants that one sample is the mean of, s^2."""
    good = run.cable_tension(cable)
    t_s = good["t_s"].to_numpy(dtype=float)
    value = good["tension_n"].to_numpy(dtype=float)
    keep = np.concatenate([[True], np.diff(t_s) > 0.0])
    t_s, value = t_s[keep], value[keep]
    interval = float(np.median(np.diff(t_s)))
    block = max(int(1.0 / (interval * MOST_HZ)), 1)
    averaged_s2 = 0.0
    if block > 1:
        whole = len(t_s) // block * block
        averaged_s2 = float(np.median(t_s[:whole].reshape(-1, block).var(axis=1)))
        t_s = t_s[:whole].reshape(-1, block).mean(axis=1)
        value = value[:whole].reshape(-1, block).mean(axis=1)
    rest = at_rest(t_s, excitation, shift_s)
    if run.start.motion_start_known and np.count_nonzero(rest) >= LEAST_REST:
        sigma, noise_from = about_line(t_s[rest], value[rest]), int(rest.sum())
    else:
        sigma = noise_floor(t_s, value, excitation, shift_s)
        noise_from = len(value) // OF_LINES
        notes.append(f"cable {cable}: no rest to take the noise from; {sigma:.4f} N is an estimate")
    stated = (one.sampling_sigma_s for one in run.start.nodes if one.cable == cable)
    found = Bundle(
        names=(f"tension {cable}",),
        units=("N",),
        t_s=t_s,
        value=value[:, None],
        covariance=np.array([[max(sigma, LEAST_NOISE_N) ** 2]]),
        segments=segments(excitation, shift_s, float(t_s[0]), float(t_s[-1])),
        record=run.name,
        kind="tension",
        base_share=BASE_SHARE,
        tones_hz=tuple(tones_hz(Machine.from_rig(run.rig))),
        noise_from=noise_from,
    )
    return with_instants(found, (next(stated, None) or 0.0) / np.sqrt(block)), averaged_s2


def _instants(
    bundles: list[Bundle], excitation: Excitation, shift_s: float, notes: list[str]
) -> list[Bundle]:
    """Bundles of one clock; where the run states nothing of their instants, what they tell."""
    if any(one.jitter is not None for one in bundles):
        return bundles
    found_s = instants_s(bundles, excitation, shift_s)
    if found_s:
        notes.append(
            f"{bundles[0].kind}: instants of samples spread by {1e3 * found_s:.2g} ms, as the "
            "noise of what moves tells; the run states nothing of it, and it is counted as noise"
        )
    return [with_instants(one, found_s, ESTIMATED) for one in bundles]


def _pose(
    run: Run, pose: "pd.DataFrame", excitation: Excitation, shift_s: float, notes: list[str]
) -> Bundle | None:
    names = [f"{axis}_m" for axis in "xyz"] + [f"{axis}_deg" for axis in ("roll", "pitch", "yaw")]
    flags = pose["flags"].fillna(0).to_numpy(dtype=int)
    good = pose[names].notna().all(axis=1).to_numpy()
    good = good & ((flags & int(FrameFlag.REPEATED | FrameFlag.BLACK | FrameFlag.NO_MARKER)) == 0)
    seen = pose[good].sort_values("t_s", kind="stable")
    if len(seen) < LEAST_FRAMES:
        notes.append(f"{len(seen)} usable poses are too few")
        return None
    t_s = seen["t_s"].to_numpy(dtype=float)
    value = seen[names].to_numpy(dtype=float) * _DEGREES
    # An angle that passes 180 deg comes back at -180.
    value[:, 3:] = np.unwrap(value[:, 3:], axis=0)
    covariance = stated_covariance(seen) * np.outer(_DEGREES, _DEGREES)
    rest = at_rest(t_s, excitation, shift_s)
    if run.start.motion_start_known and np.count_nonzero(rest) >= LEAST_REST_FRAMES:
        spread = np.array([about_line(t_s[rest], column) for column in value[rest].T])
        stated = np.sqrt(np.diag(covariance))
        if not np.isfinite(stated).all() or (stated == 0.0).any():
            covariance = np.diag(spread**2)
        else:
            # What a dozen frames say of their spread is sure to a quarter.
            factor = np.where(spread > 1.5 * stated, spread / stated, 1.0)
            covariance = covariance * np.outer(factor, factor)
            if (factor > 1.0).any():
                wide = [POSE_AXES[i] for i in np.flatnonzero(factor > 1.0)]
                notes.append(
                    f"poses at rest spread more than pose.csv states ({', '.join(wide)}): the "
                    "spread is taken"
                )
    elif not np.isfinite(covariance).all():
        spread = np.array([noise_floor(t_s, one, excitation, shift_s) for one in value.T])
        covariance = np.diag(spread**2)
        notes.append("pose.csv states no sigma and there was no rest: the noise is an estimate")
    floor = np.array([LEAST_NOISE_M] * 3 + [LEAST_NOISE_RAD] * 3)
    covariance = covariance + np.diag(floor**2)
    return Bundle(
        names=tuple(POSE_AXES),
        units=("m", "m", "m", "rad", "rad", "rad"),
        t_s=t_s,
        value=value,
        covariance=covariance,
        segments=segments(excitation, shift_s, float(t_s[0]), float(t_s[-1])),
        record=run.name,
        kind="pose",
        base_share=BASE_SHARE,
        tones_hz=tuple(tones_hz(Machine.from_rig(run.rig))),
    )


def names_of(recordings: Sequence[Recording]) -> str:
    """Their names in words."""
    return ", ".join(one.run.name for one in recordings)
