"""CDPR-8 as a system for the engine: runs of one machine, simulated as they were recorded."""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.as_recorded import as_clipped, as_lost, as_seen
from analysis.diagnosis.candidates import candidates
from analysis.diagnosis.fineness import finer_steps
from analysis.diagnosis.guard import GUARDS, guard_of, without_bias
from analysis.diagnosis.library_values import library_values
from analysis.diagnosis.lost_frames import lost_frames
from analysis.diagnosis.moving import OUTSIDE, Moved, Moving, Values, active, nothing
from analysis.diagnosis.nuisances import STRINGS, Meaning, nuisances
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sharing import Alike, Share, lanes_from, shares
from analysis.diagnosis.sight import Sight, seen_by
from analysis.diagnosis.sighting import sighting_of
from analysis.diagnosis.strung import GROWN_WORDS, Strung, strung
from analysis.diagnosis.trim import Trim
from analysis.engine.bundle import Bundle
from analysis.engine.candidate import Candidate
from analysis.engine.system import Nuisance, Point, Prediction
from cdpr8.crew import Crew
from model import Simulation, Task, simulate_many
from model.library.discovery import library
from model.motion import RampedSine
from model.rest import tones_hz
from model.simulator import run as simulate_task

Array = NDArray[np.float64]
Key = tuple[object, ...]
"""Equal where the same is simulated."""

LATE_S = 0.3
"""Cameras and cells may be late by so much: a simulation goes on for longer than what is seen."""


@dataclass(frozen=True)
class _Job:
    """One run of one point: what to simulate and how to look at it."""

    key: Key
    task: Task
    sight: Sight


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
        self._strung = [False] * len(recordings)
        self._moving = self._moved_by()
        self.sighting = sighting_of(recordings[0].rig)
        times = [
            (one.excitation.start_s + one.shift_s, one.excitation.end_s + one.shift_s)
            for one in recordings
        ]
        posed = any(one.has_pose for one in recordings)
        slack = sorted({cable for one in recordings for cable in one.hanging})
        self._candidates = tuple(
            as_seen(one, slack)
            for one in candidates(effects, times, self.sighting.frame_hz)
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
        shown_n = self._shown()
        nominal = self._nominal()
        self.peaks_n = _peaks(nominal, shown_n)
        self._candidates = tuple(
            as_clipped(one, np.subtract(self.peaks_n, shown_n)) for one in self._candidates
        )
        self._finer = [self._finer_steps(record) for record in range(len(recordings))]
        if len(recordings) == 1:
            self._candidates = self._as_frames_show(nominal[0])

    def with_strings(self) -> "RecordedMachine":
        """The same machine, what its cables are as strings simulated in runs that show it.

        Where strings grow by themselves, a run counts up to there.
        """
        found = copy(self)
        found._strung = [True] * len(self.recordings)
        found._moving = found._moved_by()
        told = [found._strings(record) for record in range(len(self.recordings))]
        found.recordings = tuple(
            one.until(strings.foretold, GROWN_WORDS)
            for one, strings in zip(self.recordings, told, strict=True)
        )
        found.bundles = tuple(bundle for one in found.recordings for bundle in one.bundles)
        found._strung = [
            strings.shown_in(one.bundles)
            for one, strings in zip(found.recordings, told, strict=True)
        ]
        found._moving = found._moved_by()
        found._crew = Crew(found, self._workers)
        return found

    def looked_at_in(self, bundles: Sequence[Bundle]) -> "RecordedMachine":
        """The same machine, where less of its recordings counts.

        Parameters
        ----------
        bundles
            Its bundles, in which segments may end earlier.
        """
        left = iter(bundles)
        found = copy(self)
        found.bundles = tuple(bundles)
        found.recordings = tuple(
            replace(one, bundles=tuple(next(left) for _ in one.bundles)) for one in self.recordings
        )
        return found

    def known_as(self, known: Sequence[Nuisance]) -> "RecordedMachine":
        """The same machine, its nuisances known otherwise.

        Parameters
        ----------
        known
            Its nuisances, of which sigmas may be others.
        """
        found = copy(self)
        found._known = tuple(known)
        found._moving = found._moved_by()
        found._crew = Crew(found, self._workers)
        return found

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
        asked = [self._alike(points, record) for record in range(len(self.recordings))]
        self.simulated += sum(one.simulations for every in asked for one in every)
        work = shares(asked, self._workers)
        found: list[dict[int, Prediction]] = [{} for _ in self.recordings]
        for share, seen in zip(work, self._crew.do(work), strict=True):
            found[share.record].update(seen)
        return [
            reduce([bundle for of_record, none in zip(found, self._nothing, strict=True)
                    for bundle in of_record.get(place, none)])
            for place in range(len(points))
        ]  # fmt: skip

    def tones_hz(self, point: Point) -> Array:
        """See `Ringing`."""
        asked = point.records
        names = [one.run.name for one in self.recordings]
        record = names.index(asked[0]) if asked else 0
        return tones_hz(self.job(point, record).task.machine)

    def bend(self, here: Point, there: Point) -> Array:
        """See `Bent`."""
        names = [one.run.name for one in self.recordings]
        asked = [i for i, name in enumerate(names) if not there.records or name in there.records]
        return self.trim.bend(here, there, asked)

    @property
    def trim(self) -> Trim:
        """What a trim of the platform does."""
        return Trim(self._meanings, self._known, self._pretension_n)

    def _pretension_n(self, point: Point, record: int) -> Array:
        """What cables are tightened to in a run, shape (8,), N."""
        return np.asarray(self.job(point, record).task.machine.pretension)

    def _alike(self, points: Sequence[Point], record: int) -> list[Alike]:
        """What is simulated of one run, like beside like."""
        together: dict[Key, dict[int, Point]] = {}
        name = self.recordings[record].run.name
        for place, point in enumerate(points):
            if not point.records or name in point.records:
                together.setdefault(self._key(point, record), {})[place] = point
        found = []
        for key in sorted(together, key=str):
            first = next(iter(together[key].values()))
            found.append(Alike(together[key], len(GUARDS[first.ring])))
        return found

    def _key(self, point: Point, record: int) -> Key:
        """Equal where the same is simulated, however it is looked at."""
        inside = [
            (name, tuple(sorted(one.values.items())), tuple(sorted(one.shapes.items())))
            for name, one in sorted(point.effects.items())
            if library()[name].acts.side not in OUTSIDE
        ]
        motion = _cut(self.recordings[record], point.upto)
        moved = point.nuisance[self._moving[record].inside(point.effects)].tobytes()
        return len(inside), *inside, point.ring, motion and motion.duration_s, moved

    def do(self, work: Share) -> dict[int, Prediction]:
        """What is seen of a share: place of the point -> its samples."""
        all_jobs = {
            place: [self.job(point, work.record, guard) for guard in GUARDS[point.ring]]
            for place, point in work.points.items()
        }
        tasks = {job.key: job.task for jobs in all_jobs.values() for job in jobs}
        recording, finer = self.recordings[work.record], self._finer[work.record]
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

    def job(self, point: Point, record: int, guard: float = 0.0) -> _Job:
        """What one run of a point is, its cables damped by a share of the guard."""
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
        return _Job(key, task, Sight(outside, start_s, moved.pose_zero, moved.late_s))

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
        return self._moving[record].by(point.nuisance, values)

    def _moved_by(self) -> list[Moving]:
        """What nuisances move in each run."""
        return [
            Moving(self._meanings, self._known, record, strung=shown)
            for record, shown in enumerate(self._strung)
        ]

    def _strings(self, record: int) -> Strung:
        """What a run shows of its strings, whatever is on."""

        def see(points: Sequence[Point]) -> list[Prediction]:
            found = self.do(Share(record, dict(enumerate(points))))
            return [found[place] for place in range(len(points))]

        strings = np.array([one.effect == STRINGS for one in self._meanings])
        return strung(see, strings, self.recordings[record].bundles)

    def _finer_steps(self, record: int) -> dict[str, float]:
        job = self.job(Point(np.zeros(len(self._known))), record)
        return finer_steps(self.recordings[record], job.task, job.sight)

    def _nominal(self) -> list[Simulation]:
        """Each run as the rig file has the machine."""
        nominal = Point(np.zeros(len(self._known)))
        tasks = [self.job(nominal, record).task for record in range(len(self.recordings))]
        return [
            simulate_task(task, output_rate_hz=one.output_hz(task))
            for task, one in zip(tasks, self.recordings, strict=True)
        ]

    def _as_frames_show(self, nominal: Simulation) -> tuple[Candidate, ...]:
        """Candidates, dropped frames just where poses show them; elsewhere, where they do not."""
        if all(one.name != "frames_dropped" for one in self._candidates):
            return self._candidates
        sight = self.job(Point(np.zeros(len(self._known))), 0).sight
        lost_s = lost_frames(self.recordings[0], nominal, sight, self.sighting.frame_hz)
        return tuple(
            as_lost(one, lost_s) if lost_s and one.name == "frames_dropped" else one
            for one in self._candidates
        )

    def _shown(self) -> Array:
        """Highest tension that each cell showed in any run, N; none: less than anything."""
        highest = np.full(8, -np.inf)
        for bundle in self.bundles:
            if bundle.kind == "tension":
                cables = [int(name.removeprefix("tension ")) - 1 for name in bundle.names]
                highest[cables] = np.maximum(highest[cables], np.nanmax(bundle.value, axis=0))
        return highest


def _peaks(nominal: Sequence[Simulation], shown_n: Array) -> list[float]:
    """Highest tension of each cable over all runs, as simulated or as recorded, N.

    A cell that clips does so below what the rig file has, or below what it was seen to show.
    """
    highest = np.max([run.tension_n.max(axis=0) for run in nominal], axis=0)
    return [float(one) for one in np.maximum(highest, shown_n)]


def _cut(recording: Recording, upto: float) -> RampedSine | None:
    """The motion with as much of the time after its start as samples are asked for; None: all."""
    if upto >= 1.0:
        return None
    last_s = max(float(one.t_s[0] + upto * (one.t_s[-1] - one.t_s[0])) for one in recording.bundles)
    whole = RampedSine.from_excitation(recording.excitation)
    # Whole tenths: recordings that are cut alike share their times.
    until_s = np.ceil(10.0 * (last_s - recording.shift_s + LATE_S)) / 10.0
    return replace(whole, duration_s=float(until_s)) if until_s < whole.duration_s else None
