"""How the motion began and ended: by which ramp, where the run does not state it.

A run that another program recorded seldom says by which law its drive fades in. An undamped
platform remembers it: a raised cosine where a quintic is simulated leaves a ring of 0.3 N, and
looks like left-out physics. Each law is held against the onset, all parameters free within what is
known of them, up to the end of the ramp: over so short a time a ring stays in proportion to how
far parameters are off. Each ending is held against what follows the steady motion.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.one_thread import one_thread_each
from analysis.diagnosis.recording import Recording, recording
from analysis.engine.followed import Followed
from analysis.engine.ring_samples import Samples
from cdpr8.rigfile.excitation import Ending, Excitation, Ramp
from cdpr8.runfolder import Run

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

STEPS = 4
"""So often parameters are improved for each law."""

CLEARLY, SHARE = 60.0, 0.5
"""Another law than the first is taken where the squared misfit falls by this, and what is left
beyond noise to this share: what was left out there explains no such part of it."""

ENDS_SHARE = 0.2
"""Another ending is taken where it leaves this share of the squared misfit: the ring's phase is
lost by then, and leaves as much for each, but a swing of the platform is far larger."""


def as_it_moved(
    run: Run, pose: "pd.DataFrame | None", shift_s: float = 0.0
) -> tuple[Run, list[str]]:
    """The run with the ramp and the ending that its samples show, where `start.json` states none.

    Parameters
    ----------
    run
        As loaded.
    pose
        Columns of pose.csv; None: there is none.
    shift_s
        How much later than it says the motion started.

    Returns
    -------
    Run, list of str
        And what a reader must know where that is not what a rig file means by default.
    """
    if not _is_open(run.start.excitation):
        return run, []
    with one_thread_each():
        excitation, notes = excitation_of(recording(run, pose, shift_s))
    return (moved_by(run, excitation), notes) if notes else (run, notes)


def moved_by(run: Run, excitation: Excitation) -> Run:
    """The run, its motion of another excitation than it says."""
    return replace(run, start=run.start.model_copy(update={"excitation": excitation}))


def excitation_of(seen: Recording) -> tuple[Excitation, list[str]]:
    """The excitation as samples show it, where `start.json` leaves its ramp or ending open.

    Parameters
    ----------
    seen
        The recording.

    Returns
    -------
    Excitation, list of str
        As stated, and nothing, where the samples show no other; else what a reader must know.
    """
    excitation = seen.excitation
    stated = excitation.model_fields_set
    if not _is_open(excitation):
        return excitation, []
    found: dict[str, str] = {}
    notes = []
    if "ramp" not in stated and (ramp := _ramp(seen)) != excitation.ramp:
        found["ramp"] = ramp
        notes.append(
            f"the motion fades in as a {ramp.replace('_', ' ')}, which its onset shows and "
            f'start.json does not say: simulated so (`ramp = "{ramp}"`)'
        )
        seen = replace(seen, excitation=excitation.model_copy(update=found))
    if "ending" not in stated and (ending := _ending(seen)) != excitation.ending:
        found["ending"] = ending
        notes.append(
            f"the motion ends {ENDS[ending]}, which the recording shows and start.json does not "
            f'say: simulated so (`ending = "{ending}"`)'
        )
    return (excitation.model_copy(update=found) if found else excitation), notes


def _is_open(excitation: Excitation) -> bool:
    """Whether there is a ramp or an ending that is not stated."""
    moves = excitation.amplitude_deg != 0.0 and excitation.ramp_s != 0.0
    return moves and not {"ramp", "ending"} <= excitation.model_fields_set


ENDS: dict[Ending, str] = {
    "ramp_within": "fading out over the last ramp_s of motion_s",
    "ramp_beyond": "fading out after motion_s",
    "at_once": "at once",
}


def _ramp(seen: Recording) -> Ramp:
    """The law whose onset leaves least, if it leaves far less than the one that is the default."""
    excitation = seen.excitation
    first_s, last_s = _span(seen)
    upto_s = excitation.start_s + seen.shift_s + excitation.ramp_s
    share = min((upto_s - first_s) / (last_s - first_s), 1.0)
    if share <= 0.0:
        return excitation.ramp
    costs = onset_costs(seen, share)
    best = min(costs, key=lambda law: costs[law].cost)
    default, least = costs[excitation.ramp], costs[best]
    clear = least.cost < default.cost - CLEARLY and least.excess < SHARE * default.excess
    return best if clear else excitation.ramp


class Onset(NamedTuple):
    """What one ramp leaves of the onset: squared misfit and strain of parameters, and samples."""

    cost: float
    samples: int

    @property
    def excess(self) -> float:
        """What is left beyond noise."""
        return self.cost - self.samples


def onset_costs(seen: Recording, share: float) -> dict[Ramp, Onset]:
    """What each ramp leaves of the first part of a recording, parameters free.

    Parameters
    ----------
    seen
        The recording.
    share
        The part, as a share of its time.
    """
    machine, samples = _samples(seen, share)
    start = Followed(np.zeros(len(machine.nuisances)), None)
    points, steps = start.neighbours()
    here, *moved = samples.residuals([start.point, *points])
    columns = (here - np.array(moved)) / steps[:, None]
    matrix = columns @ columns.T + np.eye(len(columns))
    laws: Sequence[Ramp] = get_args(Ramp)
    found: dict[Ramp, Onset] = {}
    for law in laws:
        _, of_law = _samples(_moving(seen, {"ramp": law}), share)
        at = start.nuisance
        (left,) = of_law.residuals([start.point])
        cost = float(left @ left)
        for _ in range(STEPS):
            # Gauss and Newton's steps, by the differences of the first law.
            there = at + np.linalg.solve(matrix, columns @ left - at)
            (closer,) = of_law.residuals([Followed(there, None).point])
            lower = float(closer @ closer + there @ there)
            if not lower < cost:
                break
            at, left, cost = there, closer, lower
        found[law] = Onset(cost, len(here))
    return found


def _ending(seen: Recording) -> Ending:
    """The ending that leaves least of what follows the steady motion, if that is far less."""
    excitation = seen.excitation
    first_s, last_s = _span(seen)
    from_s = excitation.start_s + seen.shift_s + excitation.motion_s - excitation.ramp_s
    share = (from_s - first_s) / (last_s - first_s)
    if share >= 1.0:
        return excitation.ending
    left = {}
    endings: Sequence[Ending] = get_args(Ending)
    for ending in endings:
        machine, samples = _samples(_moving(seen, {"ending": ending}), 1.0)
        (all_of_it,) = samples.residuals([Followed(np.zeros(len(machine.nuisances)), None).point])
        left[ending] = float(np.sum(all_of_it[samples.shares > share] ** 2))
    best = min(left, key=lambda one: left[one])
    return best if left[best] < ENDS_SHARE * left[excitation.ending] else excitation.ending


def _samples(seen: Recording, share: float) -> tuple[RecordedMachine, Samples]:
    machine = RecordedMachine([seen], workers=1)
    return machine, Samples(machine, everything=True, share=share)


def _moving(seen: Recording, changed: dict[str, str]) -> Recording:
    """The same samples, of a machine that was moved otherwise."""
    moved: Excitation = seen.excitation.model_copy(update=changed)
    return replace(seen, excitation=moved)


def _span(seen: Recording) -> tuple[float, float]:
    """First and last instant of all samples, s."""
    first = min(float(one.t_s[0]) for one in seen.bundles)
    return first, max(float(one.t_s[-1]) for one in seen.bundles)
