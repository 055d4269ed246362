"""A run as the engine sees it: bundles of channels with times, noise and stretches of time."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.channels import pose_of, tension_of, with_instants_of
from analysis.engine.bundle import Bundle
from analysis.engine.tones import RESONANT, resonant
from analysis.engine.until import cut
from analysis.series import measured_cables
from cdpr8.errors import DataError
from cdpr8.rigfile import Rig
from cdpr8.rigfile.excitation import Excitation
from cdpr8.runfolder import Run
from model import Task

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

HANGS_SIGMAS, HANGS_SHARE = 4.0, 0.03
"""A cable hangs slack where so much of its samples lies within so many sigmas of zero: one whose
tension only comes to zero and turns is there for less."""

OUTPUT_HZ, ABRUPT_HZ = 333.0, 1332.0
"""Rows a second: what cubics through them miss of a ring is 0.08 of the noise, rms. Where a motion
begins or ends at once, tones of 60 and 80 Hz ring, of which 333 Hz miss 4 and 12 %, more than the
noise. Four rows a step take half as long again."""

STUCK_HZ = 33.0
"""Nor are rows far apart where a platform rings while its cables stick on their pulleys: they are
as many times as close as that is faster than this, ten a period, as its steps have to be. Cubics
through ten rows a period miss 0.3 % of a tone; through three, as at 100 Hz, a quarter."""


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
    offset_s
        Of each: how far off all of its instants may be, beside what any cell's may.
    """

    run: Run
    excitation: Excitation
    shift_s: float
    cables: tuple[int, ...]
    bundles: tuple[Bundle, ...]
    has_pose: bool
    notes: tuple[str, ...]
    averaged_s2: tuple[float, ...]
    offset_s: tuple[float, ...]

    @property
    def rig(self) -> Rig:
        """The machine as the run has it."""
        return self.run.rig

    def until(self, share: float, words: str) -> "Recording":
        """As much of it as can be foretold.

        Parameters
        ----------
        share
            Of its time.
        words
            What a reader must know where that is not all, with a place for `until_s`.
        """
        if share >= 1.0:
            return self
        bundles = tuple(cut(one, share) for one in self.bundles)
        until_s = max(one.end_s for bundle in bundles for one in bundle.segments)
        return replace(self, bundles=bundles, notes=(*self.notes, words.format(until_s=until_s)))

    @property
    def hanging(self) -> tuple[int, ...]:
        """Cables that hang slack in a part of the motion: their tension lies at zero, not below."""
        tensions = (one for one in self.bundles if one.kind == "tension")
        return tuple(
            cable
            for cable, one in zip(self.cables, tensions, strict=True)
            if _hangs(one.value[:, 0], float(np.sqrt(one.covariance[0, 0])))
        )

    def output_hz(self, task: Task) -> float:
        """Rows a second of a simulation of it.

        Parameters
        ----------
        task
            What is simulated.
        """
        abrupt = self.excitation.ramp_s == 0.0 or self.excitation.ending == "at_once"
        of_stuck_hz = OUTPUT_HZ * max(1.0, np.ceil(task.stuck_hz / STUCK_HZ))
        return ABRUPT_HZ if abrupt else float(min(of_stuck_hz, ABRUPT_HZ))


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
    read = [tension_of(run, cable, excitation, shift_s, notes) for cable in cables]
    tensions = [one.bundle for one in read]
    if any(one.late is not None for one in tensions):
        alike = [str(c) for c, one in zip(cables, tensions, strict=True) if one.late is not None]
        notes.append(
            f"cable {', '.join(alike)}: values are asked for in step with the amplifier's output, "
            "so that how old they are stays for seconds what it is, and is not known: what is as "
            "little in time as that (a lag, a late drive, damping) cannot be told; ask at uneven "
            "times, or let the amplifiers put out values faster"
        )
    bundles = with_instants_of(tensions, excitation, shift_s, notes)
    seen = None if pose is None else pose_of(run, pose, excitation, shift_s, notes)
    if seen is not None:
        bundles += with_instants_of([seen], excitation, shift_s, notes)
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
        tuple(one.averaged_s2 for one in read),
        tuple(one.offset_s for one in read),
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
