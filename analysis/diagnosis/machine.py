"""CDPR-8 as a system for the engine: runs of one machine, simulated as they were recorded."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.candidates import candidates, library_values
from analysis.diagnosis.guard import GUARDS, guard_of, without_bias
from analysis.diagnosis.nuisances import Meaning, nuisances
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sight import Sight, seen_by
from analysis.engine.system import Bundle, Candidate, Nuisance, Point, Prediction
from model import ActiveEffect, Task, simulate_many
from model.library.discovery import library
from model.motion import RampedSine
from model.simulator import run as simulate_task

Array = NDArray[np.float64]

OUTPUT_HZ = 333.0
"""Rows a second: what cubics through them miss of a free ring is 0.08 of the noise, rms."""

LANES_FROM = 8
"""Fewer tasks than this are faster one by one."""

LATE_S = 0.3
"""Cameras and cells may be late by so much: a simulation goes on for longer than what is seen."""

GROUP = 16
"""As many tasks as lanes are simulated by one thread, and looked at."""


@dataclass(frozen=True)
class _Job:
    """One run of one point: what to simulate and how to look at it."""

    key: tuple[object, ...]
    task: Task
    sight: Sight


@dataclass(frozen=True)
class _Share:
    """Some points of one run: place of the point -> what to simulate for it."""

    record: int
    jobs: Mapping[int, Sequence[_Job]]


class RecordedMachine:
    """Runs of one machine.

    Parameters
    ----------
    recordings
        The runs.
    effects
        Names of the effects to look at; None: all.
    workers
        Threads.
    """

    def __init__(
        self,
        recordings: Sequence[Recording],
        effects: Sequence[str] | None = None,
        workers: int = 2,
    ) -> None:
        self.recordings = tuple(recordings)
        self.name = ", ".join(one.run.name for one in recordings)
        self.bundles: tuple[Bundle, ...] = tuple(
            bundle for one in recordings for bundle in one.bundles
        )
        self._known, self._meanings = nuisances(self.recordings)
        camera = recordings[0].rig.camera
        self.frame_hz = camera.fps if camera is not None else 16.0
        times = [
            (one.excitation.start_s + one.shift_s, one.excitation.end_s + one.shift_s)
            for one in recordings
        ]
        posed = any(one.has_pose for one in recordings)
        self._candidates = tuple(
            one
            for one in candidates(effects, times, self.frame_hz)
            if posed or one.side not in ("camera", "clock")
        )
        self._workers = workers
        self._guards = [guard_of(one.rig, one.excitation.frequency_hz) for one in recordings]
        self._nothing = [[np.zeros_like(bundle.value) for bundle in one.bundles]
                         for one in recordings]  # fmt: skip
        self.simulated = 0
        """Simulations run so far."""
        self.peaks_n = [1e3] * 8
        self.peaks_n = self._nominal_peaks()

    @property
    def nuisances(self) -> Sequence[Nuisance]:
        """See `System`."""
        return self._known

    @property
    def meanings(self) -> Sequence[Meaning]:
        """What each nuisance moves."""
        return self._meanings

    @property
    def candidates(self) -> Sequence[Candidate]:
        """See `System`."""
        return self._candidates

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`.

        A platform without damping of its own rings on for the whole of a run. Cables that are
        damped a little end the ring, and bias what is in quadrature by a share that is in
        proportion to the damping: that of half the damping, twice, less that of the whole has the
        ring of neither and no bias to first order.
        """
        shares = [part for record in range(len(self.recordings))
                  for part in self._shares(points, record)]  # fmt: skip
        found: list[dict[int, Prediction]] = [{} for _ in self.recordings]
        for share, seen in zip(shares, self._all(shares), strict=True):
            found[share.record].update(seen)
        return [
            reduce([bundle for of_record, none in zip(found, self._nothing, strict=True)
                    for bundle in of_record.get(place, none)])
            for place in range(len(points))
        ]  # fmt: skip

    def _shares(self, points: Sequence[Point], record: int) -> list[_Share]:
        """One run of all points, in shares that are simulated side by side."""
        together: dict[tuple[object, ...], dict[int, list[_Job]]] = {}
        name = self.recordings[record].run.name
        for place, point in enumerate(points):
            if point.records and name not in point.records:
                continue
            jobs = [self.job(point, record, share) for share in GUARDS[point.ring]]
            together.setdefault(tuple(job.key for job in jobs), {})[place] = jobs
        # Like simulations beside each other.
        alike = [together[key] for key in sorted(together, key=str)]
        count = len({job.key for places in alike for jobs in places.values() for job in jobs})
        self.simulated += count
        if not count:
            return []
        size = 1 if count / self._workers < LANES_FROM else min(GROUP, -(-count // self._workers))
        each = max(size * len(alike) // count, 1)
        return [
            _Share(record, {place: jobs for places in alike[first : first + each]
                            for place, jobs in places.items()})
            for first in range(0, len(alike), each)
        ]  # fmt: skip

    def _all(self, shares: Sequence[_Share]) -> list[dict[int, Prediction]]:
        if self._workers == 1 or len(shares) == 1:
            return [self._seen(share) for share in shares]
        with ThreadPoolExecutor(self._workers) as pool:
            return list(pool.map(self._seen, shares))

    def _seen(self, share: _Share) -> dict[int, Prediction]:
        """What is seen of a share: point -> its samples."""
        tasks = {job.key: job.task for jobs in share.jobs.values() for job in jobs}
        solved = simulate_many(list(tasks.values()), output_rate_hz=OUTPUT_HZ, fewest=LANES_FROM)
        done = dict(zip(tasks, solved, strict=True))
        seen: dict[tuple[object, ...], Prediction] = {}
        found: dict[int, Prediction] = {}
        for place, jobs in share.jobs.items():
            key = tuple((job.key, job.sight.key) for job in jobs)
            if key not in seen:
                simulation = without_bias([done[job.key] for job in jobs])
                seen[key] = seen_by(self.recordings[share.record], simulation, jobs[0].sight)
            found[place] = seen[key]
        return found

    def job(self, point: Point, record: int, guard: float = 0.0) -> _Job:
        """What one run of a point is, its cables damped by a share of the guard."""
        recording = self.recordings[record]
        values, start_s, pose_zero, late_s = self._moved(point, record)
        if guard:
            mine = values.setdefault("cable_viscous", _nothing("cable_viscous"))
            damping = guard * self._guards[record]
            mine["viscous_n_s_per_m"] = mine["viscous_n_s_per_m"] + damping
        active = []
        for name in sorted(values):
            effect = ActiveEffect(name, _within(name, values[name]))
            if not effect.is_nothing:
                active.append(effect)
        inside = tuple(one for one in active if one.effect.acts.side not in _OUTSIDE)
        outside = tuple(one for one in active if one.effect.acts.side in _OUTSIDE)
        motion = _cut(recording, point.upto)
        task = Task(
            rig=recording.rig,
            excitation=recording.excitation,
            motion=motion,
            effects=inside,
            nominal=recording.rig,
        )
        key = (motion and motion.duration_s, *((one.name, *sorted(one.values.items()))
                                               for one in inside))  # fmt: skip
        return _Job(key, task, Sight(outside, start_s, pose_zero, late_s))

    def _moved(
        self, point: Point, record: int
    ) -> tuple[dict[str, dict[str, Any]], float, Array, Array]:
        """Effects with their numbers, start, the pose's zero and the cells' lateness."""
        recording = self.recordings[record]
        values: dict[str, dict[str, Any]] = {}
        for name, setting in point.effects.items():
            own = library_values(
                name, setting, self.peaks_n, record, self.frame_hz, len(self.recordings)
            )
            if own is not None:
                values[name] = {
                    key: np.array(one, dtype=float) if isinstance(one, tuple) else one
                    for key, one in own.items()
                }
        start_s, pose_zero, late_s = recording.shift_s, np.zeros(6), np.zeros(8)
        for i in np.flatnonzero(point.nuisance):
            meaning = self._meanings[i]
            if meaning.record not in (-1, record):
                continue
            amount = float(point.nuisance[i]) * self._known[i].sigma
            if meaning.effect == "start":
                start_s += amount
            elif meaning.effect == "pose_zero":
                pose_zero[meaning.axis] += amount
            elif meaning.effect == "sampling":
                late_s[meaning.cable - 1] += amount
            else:
                mine = values.setdefault(meaning.effect, _nothing(meaning.effect))
                if meaning.cable:
                    column = np.array(mine.get(meaning.parameter, np.zeros(8)))
                    column[meaning.cable - 1] += amount
                    mine[meaning.parameter] = column
                else:
                    mine[meaning.parameter] = mine.get(meaning.parameter, 0.0) + amount
        return values, start_s, pose_zero, late_s

    def _nominal_peaks(self) -> list[float]:
        """Highest simulated tension of each cable over all runs, N."""
        nominal = Point(np.zeros(len(self._known)))
        jobs = [self.job(nominal, record) for record in range(len(self.recordings))]
        runs = [simulate_task(job.task, output_rate_hz=OUTPUT_HZ) for job in jobs]
        highest = np.max([run.tension_n.max(axis=0) for run in runs], axis=0)
        return [float(one) for one in highest]


_OUTSIDE = ("cell", "camera", "clock")


def _cut(recording: Recording, upto: float) -> RampedSine | None:
    """The motion with as much of the time after its start as samples are asked for; None: all."""
    if upto >= 1.0:
        return None
    last_s = max(float(one.t_s[0] + upto * (one.t_s[-1] - one.t_s[0])) for one in recording.bundles)
    whole = RampedSine.from_excitation(recording.excitation)
    # Whole tenths: recordings that are cut alike share their times.
    until_s = np.ceil(10.0 * (last_s - recording.shift_s + LATE_S)) / 10.0
    return replace(whole, duration_s=float(until_s)) if until_s < whole.duration_s else None


def _nothing(name: str) -> dict[str, Any]:
    """An effect with all magnitudes zero, so that only what is moved acts."""
    return {
        one.name: np.zeros(8) if one.per_cable else 0.0
        for one in library()[name].parameters
        if one.magnitude
    }


def _within(name: str, values: Mapping[str, Any]) -> dict[str, float | tuple[float, ...]]:
    """Clipped to the library's range, as plain numbers."""
    found: dict[str, float | tuple[float, ...]] = {}
    for one in library()[name].parameters:
        if one.name in values:
            clipped = np.clip(values[one.name], one.low, one.high)
            found[one.name] = (
                tuple(float(v) for v in clipped) if np.ndim(clipped) else float(clipped)
            )
    return found
