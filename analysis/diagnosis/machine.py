"""CDPR-8 as a system for the engine: runs of one machine, simulated as they were recorded."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.candidates import candidates, library_values
from analysis.diagnosis.crew import Crew
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

LOOKING = 0.3
"""What it takes to look at a simulation once more, of what it takes to simulate."""

LATE_S = 0.3
"""Cameras and cells may be late by so much: a simulation goes on for longer than what is seen."""

GROUP = 16
"""As many tasks as lanes are simulated by one process, and looked at."""


@dataclass(frozen=True)
class _Job:
    """One run of one point: what to simulate and how to look at it."""

    key: tuple[object, ...]
    task: Task
    sight: Sight


@dataclass(frozen=True)
class Share:
    """Some points of one run: place of the point -> what to simulate."""

    record: int
    points: Mapping[int, Point]


class RecordedMachine:
    """Runs of one machine.

    Parameters
    ----------
    recordings
        The runs.
    effects
        Names of the effects to look at; None: all.
    workers
        Processes.
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
        self._sigmas = np.array([one.sigma for one in self._known])
        self._moving = [_moving(self._meanings, i) for i in range(len(recordings))]
        self._inside = [
            np.flatnonzero([one.record in (-1, i) and _acts_inside(one) for one in self._meanings])
            for i in range(len(recordings))
        ]
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
        self._crew: Crew[Share, dict[int, Prediction]] = Crew(self, workers)
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
        for share, seen in zip(shares, self._crew.do(shares), strict=True):
            found[share.record].update(seen)
        return [
            reduce([bundle for of_record, none in zip(found, self._nothing, strict=True)
                    for bundle in of_record.get(place, none)])
            for place in range(len(points))
        ]  # fmt: skip

    def _shares(self, points: Sequence[Point], record: int) -> list[Share]:
        """One run of all points, in shares that are simulated side by side."""
        together: dict[tuple[object, ...], dict[int, Point]] = {}
        name = self.recordings[record].run.name
        for place, point in enumerate(points):
            if not point.records or name in point.records:
                together.setdefault(self._key(point, record), {})[place] = point
        # Like simulations beside each other.
        alike = [together[key] for key in sorted(together, key=str)]
        count = sum(len(GUARDS[next(iter(places.values())).ring]) for places in alike)
        self.simulated += count
        # As many for each process, and each about as long.
        parts = self._rounds(count) * self._workers
        cost = np.array([1.0 + LOOKING * (len(places) - 1) for places in alike])
        part = (np.cumsum(cost) - 0.5 * cost) * parts // cost.sum()
        shares = []
        for number in range(parts):
            chosen = [alike[i] for i in np.flatnonzero(part == number)]
            if chosen:
                of = {place: one for places in chosen for place, one in places.items()}
                shares.append(Share(record, of))
        return shares

    def _rounds(self, count: int) -> int:
        """How many shares each process does of so many simulations."""
        return max(-(-count // (GROUP * self._workers)), 1)

    def _key(self, point: Point, record: int) -> tuple[object, ...]:
        """Equal where the same is simulated, however it is looked at."""
        inside = [
            (name, tuple(sorted(one.values.items())), tuple(sorted(one.shapes.items())))
            for name, one in sorted(point.effects.items())
            if library()[name].acts.side not in _OUTSIDE
        ]
        motion = _cut(self.recordings[record], point.upto)
        moved = point.nuisance[self._inside[record]].tobytes()
        return len(inside), *inside, point.ring, motion and motion.duration_s, moved

    def do(self, work: Share) -> dict[int, Prediction]:
        """What is seen of a share: place of the point -> its samples."""
        all_jobs = {
            place: [self.job(point, work.record, guard) for guard in GUARDS[point.ring]]
            for place, point in work.points.items()
        }
        tasks = {job.key: job.task for jobs in all_jobs.values() for job in jobs}
        solved = simulate_many(list(tasks.values()), output_rate_hz=OUTPUT_HZ, fewest=LANES_FROM)
        done = dict(zip(tasks, solved, strict=True))
        seen: dict[tuple[object, ...], Prediction] = {}
        found: dict[int, Prediction] = {}
        for place, jobs in all_jobs.items():
            key = tuple((job.key, job.sight.key) for job in jobs)
            if key not in seen:
                simulation = without_bias([done[job.key] for job in jobs])
                seen[key] = seen_by(self.recordings[work.record], simulation, jobs[0].sight)
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
        every = [_active(name, _plain(values[name])) for name in sorted(values)]
        active = [one for one in every if not one.is_nothing]
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
        amounts = point.nuisance * self._sigmas
        start_s, pose_zero, late_s = recording.shift_s, np.zeros(6), np.zeros(8)
        for (effect, parameter), (of, where) in self._moving[record].items():
            moved = amounts[of]
            if not moved.any():
                continue
            if effect == "start":
                start_s += float(moved[0])
            elif effect == "pose_zero":
                pose_zero[where] += moved
            elif effect == "sampling":
                late_s[where] += moved
            else:
                mine = values.setdefault(effect, _nothing(effect))
                if where is None:
                    mine[parameter] = mine.get(parameter, 0.0) + float(moved[0])
                else:
                    column = np.array(mine.get(parameter, np.zeros(8)))
                    column[where] += moved
                    mine[parameter] = column
        return values, start_s, pose_zero, late_s

    def _nominal_peaks(self) -> list[float]:
        """Highest simulated tension of each cable over all runs, N."""
        nominal = Point(np.zeros(len(self._known)))
        jobs = [self.job(nominal, record) for record in range(len(self.recordings))]
        runs = [simulate_task(job.task, output_rate_hz=OUTPUT_HZ) for job in jobs]
        highest = np.max([run.tension_n.max(axis=0) for run in runs], axis=0)
        return [float(one) for one in highest]


_OUTSIDE = ("cell", "camera", "clock")


def _acts_inside(meaning: Meaning) -> bool:
    """Whether a nuisance changes what is simulated, and not only how that is looked at."""
    known = library().get(meaning.effect)
    return known is not None and known.acts.side not in _OUTSIDE


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


def _plain(values: Mapping[str, Any]) -> tuple[tuple[str, Any], ...]:
    """Numbers of an effect, to be told apart by value."""
    return tuple(
        (name, tuple(one.tolist()) if isinstance(one, np.ndarray) else one)
        for name, one in values.items()
    )


@lru_cache(maxsize=4096)
def _active(name: str, values: tuple[tuple[str, Any], ...]) -> ActiveEffect:
    """An effect, its numbers clipped to the library's range: of neighbours most have the same."""
    given, found = dict(values), {}
    for one in library()[name].parameters:
        if one.name in given:
            clipped = np.clip(given[one.name], one.low, one.high)
            found[one.name] = (
                tuple(float(v) for v in clipped) if np.ndim(clipped) else float(clipped)
            )
    return ActiveEffect(name, found)


_Moving = dict[tuple[str, str], tuple[NDArray[np.int64], NDArray[np.int64] | None]]


def _moving(meanings: Sequence[Meaning], record: int) -> _Moving:
    """Of each number in one run: which nuisances move it, and where; None: it has no places."""
    found: dict[tuple[str, str], list[tuple[int, int]]] = {}
    for i, one in enumerate(meanings):
        if one.record in (-1, record):
            where = one.axis if one.effect == "pose_zero" else one.cable - 1
            found.setdefault((one.effect, one.parameter), []).append((i, where))
    return {
        key: (np.array([i for i, _ in pairs]),
              None if pairs[0][1] < 0 else np.array([where for _, where in pairs]))
        for key, pairs in found.items()
    }  # fmt: skip
