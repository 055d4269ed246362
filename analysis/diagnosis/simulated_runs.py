"""Runs of one machine as points have them: what is simulated, and how that is looked at."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.guard import GUARDS, guard_of, without_bias
from analysis.diagnosis.library_values import library_values
from analysis.diagnosis.moving import OUTSIDE, Moved, Moving, Values, active, nothing
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sharing import Share, lanes_from
from analysis.diagnosis.sight import Sight, seen_by
from analysis.diagnosis.sighting import Sighting
from analysis.engine.system import Point, Prediction
from model import Simulation, Task, simulate_many
from model.library.discovery import library
from model.motion import RampedSine

Array = NDArray[np.float64]
Key = tuple[object, ...]
"""Equal where the same is simulated."""

LATE_S = 0.3
"""Cameras and cells may be late by so much: a simulation goes on for longer than what is seen."""


@dataclass(frozen=True)
class Job:
    """One run of one point: what to simulate and how to look at it."""

    key: Key
    task: Task
    sight: Sight


@dataclass(frozen=True)
class SimulatedRuns:
    """Runs of one machine, simulated as they were recorded.

    Attributes
    ----------
    recordings
        The runs.
    moving
        What nuisances move in each.
    sighting
        How the camera sees the platform.
    peaks_n
        Highest tension of each cable over all runs, N.
    finer
        Of each run: method -> so many times as many steps for each tone.
    """

    recordings: tuple[Recording, ...]
    moving: tuple[Moving, ...]
    sighting: Sighting
    peaks_n: tuple[float, ...]
    finer: tuple[Mapping[str, float], ...] = ()

    @cached_property
    def _guards(self) -> list[Array]:
        return [guard_of(one.rig, one.excitation.frequency_hz) for one in self.recordings]

    def do(self, work: Share) -> dict[int, Prediction]:
        """What is seen of a share.

        Parameters
        ----------
        work
            The share.

        Returns
        -------
        dict
            Place of the point -> its samples.
        """
        all_jobs = {
            place: [self.job(point, work.record, guard) for guard in GUARDS[point.ring]]
            for place, point in work.points.items()
        }
        tasks = {job.key: job.task for jobs in all_jobs.values() for job in jobs}
        recording, finer = self.recordings[work.record], self.finer[work.record]
        alike: dict[tuple[float, str, float], list[Key]] = {}
        for key, task in tasks.items():
            rows_hz = recording.output_hz(task)
            alike.setdefault((rows_hz, *task.thrifty(rows_hz, finer)), []).append(key)
        done: dict[Key, Simulation] = {}
        for (rows_hz, method, step_s), keys in alike.items():
            mine = [tasks[key] for key in keys]
            fewest = lanes_from({one.name for task in mine for one in task.acting})
            solved = simulate_many(
                mine, method=method, step_s=step_s, output_rate_hz=rows_hz, fewest=fewest
            )
            done.update(zip(keys, solved, strict=True))
        seen: dict[tuple[object, ...], Prediction] = {}
        found: dict[int, Prediction] = {}
        for place, jobs in all_jobs.items():
            key = tuple((job.key, job.sight.key) for job in jobs)
            if key not in seen:
                simulation = without_bias([done[job.key] for job in jobs])
                seen[key] = seen_by(recording, simulation, jobs[0].sight)
            found[place] = seen[key]
        return found

    def job(self, point: Point, record: int, guard: float = 0.0) -> Job:
        """What one run of a point is.

        Parameters
        ----------
        point, record
            Which run of which point.
        guard
            Its cables are damped by such a share of their guard.
        """
        recording = self.recordings[record]
        moved = self._moved(point, record)
        if guard:
            mine = moved.values.setdefault("cable_viscous", nothing("cable_viscous"))
            damping = guard * self._guards[record]
            mine["viscous_n_s_per_m"] = mine["viscous_n_s_per_m"] + damping
        acting = active(moved.values)
        inside = tuple(one for one in acting if one.effect.acts.side not in OUTSIDE)
        outside = tuple(one for one in acting if one.effect.acts.side in OUTSIDE)
        motion = _cut(recording, point.upto)
        start_s = recording.shift_s + moved.late_start_s
        task = Task(
            rig=recording.rig,
            excitation=recording.excitation,
            motion=motion,
            effects=inside,
            nominal=recording.rig,
            strings=moved.strings,
        )
        numbers = ((one.name, *sorted(one.values.items())) for one in inside)
        key = (motion and motion.duration_s, moved.strings, *numbers)
        return Job(key, task, Sight(outside, start_s, moved.pose_zero, moved.late_s))

    def _moved(self, point: Point, record: int) -> Moved:
        values: Values = {}
        for name, setting in point.effects.items():
            own = library_values(
                name, setting, self.peaks_n, record, self.sighting, len(self.recordings)
            )
            if own is not None:
                values[name] = {
                    key: np.array(one, dtype=float) if isinstance(one, tuple) else one
                    for key, one in own.items()
                }
        return self.moving[record].by(point.nuisance, values)

    def key(self, point: Point, record: int) -> Key:
        """Equal where the same is simulated, however it is looked at.

        Parameters
        ----------
        point, record
            Which run of which point.
        """
        inside = [
            (name, tuple(sorted(one.values.items())), tuple(sorted(one.shapes.items())))
            for name, one in sorted(point.effects.items())
            if library()[name].acts.side not in OUTSIDE
        ]
        motion = _cut(self.recordings[record], point.upto)
        moved = point.nuisance[self.moving[record].inside(point.effects)].tobytes()
        return len(inside), *inside, point.ring, motion and motion.duration_s, moved


def _cut(recording: Recording, upto: float) -> RampedSine | None:
    """The motion with as much of the time after its start as samples are asked for; None: all."""
    if upto >= 1.0:
        return None
    last_s = max(float(one.t_s[0] + upto * (one.t_s[-1] - one.t_s[0])) for one in recording.bundles)
    whole = RampedSine.from_excitation(recording.excitation)
    # Whole tenths: recordings that are cut alike share their times.
    until_s = np.ceil(10.0 * (last_s - recording.shift_s + LATE_S)) / 10.0
    return replace(whole, duration_s=float(until_s)) if until_s < whole.duration_s else None
