"""CDPR-8 as a system for the engine: runs of one machine, simulated as they were recorded."""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.as_recorded import as_clipped, as_lost, as_seen
from analysis.diagnosis.candidates import candidates
from analysis.diagnosis.fineness import finer_steps
from analysis.diagnosis.guard import GUARDS
from analysis.diagnosis.lost_frames import lost_frames
from analysis.diagnosis.moving import Moving
from analysis.diagnosis.nuisances import STRINGS, Meaning, nuisances
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sharing import Alike, Share, shares
from analysis.diagnosis.sighting import Sighting, sighting_of
from analysis.diagnosis.simulated_runs import Job, Key, SimulatedRuns
from analysis.diagnosis.strung import GROWN_WORDS, Strung, strung
from analysis.diagnosis.trim import Trim
from analysis.engine.bundle import Bundle
from analysis.engine.candidate import Candidate
from analysis.engine.system import Nuisance, Point, Prediction
from cdpr8.crew import Crew
from model import Simulation
from model.rest import tones_hz
from model.simulator import run as simulate_task

Array = NDArray[np.float64]


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
        self._runs = SimulatedRuns(
            self.recordings, self._moved_by(), sighting_of(recordings[0].rig), (1e3,) * 8
        )
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
        self._nothing = [[np.zeros_like(bundle.value) for bundle in one.bundles]
                         for one in recordings]  # fmt: skip
        self.simulated = 0
        """Simulations run so far."""
        shown_n = self._shown()
        nominal = self._nominal()
        self._runs = replace(self._runs, peaks_n=_peaks(nominal, shown_n))
        self._candidates = tuple(
            as_clipped(one, np.subtract(self.peaks_n, shown_n)) for one in self._candidates
        )
        finer = tuple(self._finer_steps(record) for record in range(len(recordings)))
        self._runs = replace(self._runs, finer=finer)
        self._crew = self._crew_of()
        if len(recordings) == 1:
            self._candidates = self._as_frames_show(nominal[0])

    def with_strings(self) -> "RecordedMachine":
        """The same machine, what its cables are as strings simulated in runs that show it.

        Where strings grow by themselves, a run counts up to there.
        """
        found = copy(self)
        found._strung = [True] * len(self.recordings)
        found._runs = replace(self._runs, moving=found._moved_by())
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
        found._runs = replace(self._runs, recordings=found.recordings, moving=found._moved_by())
        found._crew = found._crew_of()
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
        found._runs = replace(self._runs, moving=found._moved_by())
        found._crew = found._crew_of()
        return found

    def with_peaks(self, peaks_n: Sequence[float]) -> "RecordedMachine":
        """The same machine, the highest tensions those of others.

        Parameters
        ----------
        peaks_n
            Of each cable, N.
        """
        found = copy(self)
        found._runs = replace(self._runs, peaks_n=tuple(peaks_n))
        found._crew = found._crew_of()
        return found

    @property
    def sighting(self) -> Sighting:
        """How the camera sees the platform."""
        return self._runs.sighting

    @property
    def peaks_n(self) -> Sequence[float]:
        """Highest tension of each cable over all runs, N."""
        return self._runs.peaks_n

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

    def job(self, point: Point, record: int) -> Job:
        """What one run of a point is."""
        return self._runs.job(point, record)

    def _pretension_n(self, point: Point, record: int) -> Array:
        """What cables are tightened to in a run, shape (8,), N."""
        return np.asarray(self.job(point, record).task.machine.pretension)

    def _alike(self, points: Sequence[Point], record: int) -> list[Alike]:
        """What is simulated of one run, like beside like."""
        together: dict[Key, dict[int, Point]] = {}
        name = self.recordings[record].run.name
        for place, point in enumerate(points):
            if not point.records or name in point.records:
                together.setdefault(self._runs.key(point, record), {})[place] = point
        found = []
        for key in sorted(together, key=str):
            first = next(iter(together[key].values()))
            found.append(Alike(together[key], len(GUARDS[first.ring])))
        return found

    def _crew_of(self) -> Crew[Share, dict[int, Prediction]]:
        """Processes that simulate runs as they are now."""
        return Crew(self._runs, self._workers)

    def _moved_by(self) -> tuple[Moving, ...]:
        """What nuisances move in each run."""
        return tuple(
            Moving(self._meanings, self._known, record, strung=shown)
            for record, shown in enumerate(self._strung)
        )

    def _strings(self, record: int) -> Strung:
        """What a run shows of its strings, whatever is on."""

        def see(points: Sequence[Point]) -> list[Prediction]:
            found = self._runs.do(Share(record, dict(enumerate(points))))
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


def _peaks(nominal: Sequence[Simulation], shown_n: Array) -> tuple[float, ...]:
    """Highest tension of each cable over all runs, as simulated or as recorded, N.

    A cell that clips does so below what the rig file has, or below what it was seen to show.
    """
    highest = np.max([run.tension_n.max(axis=0) for run in nominal], axis=0)
    return tuple(float(one) for one in np.maximum(highest, shown_n))
