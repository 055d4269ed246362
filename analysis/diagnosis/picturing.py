"""The arrays of the figures, made of a diagnosis by simulating before and after once more."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.diagnosis.pictures import Array, Channel, Pictures, Record, Stretch

if TYPE_CHECKING:
    from analysis.diagnosis.machine import RecordedMachine
    from analysis.diagnosis.recording import Recording
    from analysis.engine.diagnosis import Diagnosis
    from analysis.engine.system import Point


def picture(machine: "RecordedMachine", diagnosis: "Diagnosis") -> Pictures:
    """Simulate before and after once more, and keep what the figures draw.

    Parameters
    ----------
    machine, diagnosis
        What was found.
    """
    from analysis.engine.system import Point
    from analysis.engine.whiten import sigmas_of

    judgement, search = diagnosis.judgement, diagnosis.search
    problem = diagnosis.calibrated.problem
    named = judgement is not None and bool(judgement.chosen.hypothesis.parts)
    if judgement is None or search is None:
        points = (Point(diagnosis.calibrated.at),) * 2
        left = (problem.residual, problem.residual)
    else:
        after = judgement.chosen
        # Where nothing is on, what is judged is led to the phase of the ring, where that could be.
        before = search.null if named else after
        points = (before.point, after.point)
        left = (before.problem.residual, after.problem.residual)
    places = range(len(machine.recordings))
    seen = [[_seen(machine, point, place) for place in places] for point in points]
    if search is not None and search.faint:
        # What was led to the phase of the ring is judged with it.
        before_it, after_it = ([one for shown, _ in stage for one in shown] for stage in seen)
        left = (search.data - search.lens(before_it), search.data - search.lens(after_it))
    lines = [_harmonics(machine, problem.labels, one) for one in left]
    records, channels = [], []
    first = 0
    for place, recording in enumerate(machine.recordings):
        (shown, plain), (better, cables) = (stage[place] for stage in seen)
        excitation = recording.excitation
        records.append(
            Record(
                recording.run.name,
                excitation.start_s + recording.shift_s,
                excitation.frequency_hz,
                excitation.axis,
                _stretches(recording.bundles),
                _peaks(machine, place),
            )
        )
        for b, bundle in enumerate(recording.bundles):
            sigmas = sigmas_of(bundle)
            for c, name in enumerate(bundle.names):
                cable = recording.cables[b] if bundle.kind == "tension" else 0
                stiffness = recording.rig.cable[cable - 1].stiffness_n_per_m.value if cable else 0.0
                state = [plain[0][b], cables[0][b], cables[1][b]] if cable else [np.zeros(0)] * 3
                channels.append(
                    Channel(
                        record=bundle.record,
                        kind=bundle.kind,
                        name=name,
                        unit=bundle.units[c],
                        cable=cable,
                        stiffness_n_per_m=stiffness,
                        t_s=bundle.t_s,
                        recorded=bundle.value[:, c],
                        sigma=sigmas[:, c],
                        before=shown[b][:, c],
                        after=better[b][:, c],
                        elongation_before_m=state[0],
                        elongation_m=state[1],
                        rate_m_per_s=state[2],
                        harmonics_before=lines[0][first + b][c],
                        harmonics_after=lines[1][first + b][c],
                    )
                )
        first += len(recording.bundles)
    return Pictures(tuple(records), tuple(channels), named)


def with_causes(machine: "RecordedMachine", diagnosis: "Diagnosis") -> list["Recording"] | None:
    """The runs as the named causes alone make them, all parameters as the rig file has them.

    Parameters
    ----------
    machine, diagnosis
        What was found; None where causes were not asked for.
    """
    if diagnosis.judgement is None:
        return None
    # Parameters that made up for what is missing would hide it.
    point = replace(diagnosis.judgement.chosen.point, nuisance=np.zeros(len(machine.nuisances)))
    found = []
    for place, recording in enumerate(machine.recordings):
        made = zip(recording.bundles, _seen(machine, point, place)[0], strict=True)
        bundles = tuple(replace(bundle, value=value) for bundle, value in made)
        found.append(replace(recording, bundles=bundles))
    return found


def _seen(
    machine: "RecordedMachine", point: "Point", place: int
) -> tuple[list[Array], tuple[list[Array], list[Array]]]:
    """What would be recorded at a point, and elongation and rate of the cables, by bundle."""
    from analysis.diagnosis.sight import seen_by
    from model.simulator import run

    recording = machine.recordings[place]
    job = machine.job(point, place)
    simulation = run(job.task, output_rate_hz=recording.output_hz(job.task))
    elongation: list[Array] = []
    rate: list[Array] = []
    for cable, bundle in zip(recording.cables, recording.bundles, strict=False):
        t_s = bundle.t_s - job.sight.start_s
        for kept, all_ in (
            (elongation, simulation.elongation_m),
            (rate, simulation.axial_velocity_m_per_s),
        ):
            kept.append(np.interp(t_s, simulation.t_s, all_[:, cable - 1]))
    return seen_by(recording, simulation, job.sight), (elongation, rate)


def _peaks(machine: "RecordedMachine", place: int) -> tuple[float, float, float] | None:
    """See `Record.peaks_deg`."""
    from analysis.diagnosis.sight import seen_by
    from analysis.engine.system import Point
    from model.simulator import run

    recording = machine.recordings[place]
    name = f"{recording.excitation.axis}_deg"
    if not recording.has_pose or name not in recording.bundles[-1].names:
        return None
    bundle = recording.bundles[-1]
    column = bundle.names.index(name)
    job = machine.job(Point(np.zeros(len(machine.nuisances))), place)
    simulation = run(job.task, output_rate_hz=recording.output_hz(job.task))
    inside = np.zeros(len(bundle.t_s), dtype=bool)
    fine = np.zeros(len(simulation.t_s), dtype=bool)
    for one in _stretches(recording.bundles):
        if one.repeats:
            inside |= (bundle.t_s >= one.start_s) & (bundle.t_s < one.end_s)
            fine |= (simulation.t_s + job.sight.start_s >= one.start_s) & (
                simulation.t_s + job.sight.start_s < one.end_s
            )
    if not inside.any() or not fine.any():
        return None
    at_rest = bundle.t_s < recording.excitation.start_s + recording.shift_s
    recorded = bundle.value[:, column]
    recorded = recorded - (recorded[at_rest].mean() if at_rest.any() else recorded[inside].mean())
    framed = seen_by(recording, simulation, job.sight)[-1][:, column]
    peaks = [
        np.abs(simulation.pose[fine, column]),
        np.abs(framed[inside]),
        np.abs(recorded[inside]),
    ]
    values = [float(np.rad2deg(one.max())) for one in peaks]
    return values[0], values[1], values[2]


def _stretches(bundles: Sequence[Any]) -> tuple[Stretch, ...]:
    return tuple(
        Stretch(s.name, s.start_s, s.end_s, s.held_out, s.fundamental_hz is not None)
        for s in bundles[0].segments
    )


def _harmonics(machine: "RecordedMachine", labels: Any, residual: Array) -> list[list[Array]]:
    """Rms residual at each harmonic, in units of noise: bundle -> channel -> shape (h,)."""
    found = []
    for b, bundle in enumerate(machine.bundles):
        rows = []
        for c in range(len(bundle.names)):
            own = (labels.bundle == b) & (labels.channel == c) & ~labels.free & (labels.order == 0)
            line = np.round(labels.line[own]).astype(int)
            power = np.bincount(line, residual[own] ** 2)
            rows.append(np.sqrt(power / np.maximum(np.bincount(line), 1)))
        found.append(rows)
    return found
