"""CDPR-8's runs as a system: what a cell that clips is measured against, and its tones."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recorded_by import STILL, by_model

from analysis.diagnosis.candidates import SATURATION_STEP_N
from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sight import seen_by
from analysis.engine.array import Array
from analysis.engine.candidate import Setting
from analysis.engine.system import Point, Prediction, Ringing, own_nuisances
from analysis.engine.until import Until
from analysis.engine.whiten import sigmas_of
from cdpr8.rigfile import Excitation
from model.simulator import run

NAMES = ("cell_saturation", "stiffness")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    excitation = Excitation(motion_s=3.0, **STILL)
    return by_model(tmp_path_factory.mktemp("runs") / "plain", [], excitation)


def higher(recorded: Recording, cable: int, by_n: float) -> Recording:
    """The same run, of which one cable shows more than its rig file lets expect."""
    bundles = tuple(
        replace(one, value=one.value + by_n) if one.names == (f"tension {cable}",) else one
        for one in recorded.bundles
    )
    return replace(recorded, bundles=bundles)


def test_a_cell_clips_below_the_highest_tension_that_was_simulated_or_recorded(
    recorded: Recording,
) -> None:
    plain = RecordedMachine([recorded], NAMES, workers=1)
    more = RecordedMachine([higher(recorded, 7, 1.0)], NAMES, workers=1)
    less = RecordedMachine([higher(recorded, 7, -1.0)], NAMES, workers=1)
    shown = max(float(one.value.max()) for one in more.bundles if one.names == ("tension 7",))
    assert more.peaks_n[6] == pytest.approx(shown)
    assert more.peaks_n[6] > plain.peaks_n[6] + 0.9
    assert less.peaks_n[6] == pytest.approx(plain.peaks_n[6], abs=0.05)
    assert more.peaks_n[:6] == plain.peaks_n[:6]


def test_a_cell_is_looked_for_to_clip_where_it_shows_no_more(recorded: Recording) -> None:
    """However far that is below what other runs let expect: a smaller step does nothing in this."""
    clipped = higher(recorded, 7, -1.0)
    machine = RecordedMachine([clipped], NAMES, workers=1)
    saturation = next(one for one in machine.candidates if one.name == "cell_saturation")
    steps = {one.place: one.step for one in saturation.terms}
    shown = max(float(one.value.max()) for one in clipped.bundles if one.names == ("tension 7",))
    assert machine.peaks_n[6] - steps["7"] == pytest.approx(shown)
    assert [steps[place] for place in "123456"] == [SATURATION_STEP_N] * 6


def test_cables_that_hang_slack_are_shown_by_samples(recorded: Recording) -> None:
    bundles = tuple(
        replace(one, value=np.maximum(one.value - np.median(one.value) + 0.5, 0.0))
        if one.names == ("tension 4",)
        else one
        for one in recorded.bundles
    )
    slack = replace(recorded, bundles=bundles)
    (plain,) = RecordedMachine([recorded], ("cable_slack",), workers=1).candidates
    (hangs,) = RecordedMachine([recorded, slack], ("cable_slack",), workers=1).candidates
    assert plain.shown == ()
    assert hangs.shown == ("slack_m@4",)
    assert plain.prior < hangs.prior


def test_where_less_counts_a_machine_is_looked_at_in_less_and_simulated_as_before(
    recorded: Recording,
) -> None:
    whole = RecordedMachine([recorded, recorded], NAMES, workers=1)
    cut = Until(whole, 0.5)
    machine = whole.looked_at_in(cut.bundles)
    for one in machine.recordings:
        ends = [segment.end_s for bundle in one.bundles for segment in bundle.segments]
        assert max(ends) == cut.end_s < recorded.bundles[0].segments[-1].end_s
    assert machine.bundles == tuple(b for one in machine.recordings for b in one.bundles)
    assert whole.recordings == (recorded, recorded)
    nominal = Point(np.zeros(len(machine.nuisances)))
    (left,), (all_,) = (one.simulate([nominal], lambda found: found) for one in (machine, whole))
    assert all(np.array_equal(a, b) for a, b in zip(left, all_, strict=True))


def test_a_run_that_is_not_asked_for_is_not_simulated(recorded: Recording, tmp_path: Path) -> None:
    other = by_model(tmp_path / "other", [], Excitation(amplitude_deg=1.0, motion_s=2.0, **STILL))
    machine = RecordedMachine([recorded, other], NAMES, workers=1)
    nominal = Point(np.zeros(len(machine.nuisances)))
    (whole,) = machine.simulate([nominal], lambda found: found)
    both = machine.simulated
    for one, there in ((recorded, slice(0, 9)), (other, slice(9, 18))):
        machine.simulated = 0
        alone = replace(nominal, records=(one.run.name,))
        (seen,) = machine.simulate([alone], lambda found: found)
        assert 2 * machine.simulated == both
        for found, wanted in zip(seen[there], whole[there], strict=True):
            assert found == pytest.approx(wanted, abs=1e-12)


def test_the_machine_says_how_stiffness_moves_its_tones(recorded: Recording) -> None:
    machine = RecordedMachine([recorded], NAMES, workers=1)
    assert isinstance(machine, Ringing)
    nuisance = np.zeros(len(machine.nuisances))
    nominal = machine.tones_hz(Point(nuisance))
    assert nominal == pytest.approx(machine.bundles[0].tones_hz)
    sigmas = []
    for i, meaning in enumerate(machine.meanings):
        if meaning.effect == "stiffness":
            nuisance[i] = 1.0
            sigmas.append(machine.nuisances[i].sigma)
    # All cables stiffer by one sigma: tones rise by half of that, but for what pretension holds,
    # which is most of the softest.
    share = machine.tones_hz(Point(nuisance)) / nominal - 1.0
    assert np.all((share > 0.0) & (share < 0.5 * np.mean(sigmas)))
    assert share[1:] == pytest.approx(0.5 * np.mean(sigmas), rel=0.2)


def test_a_trim_of_what_is_off_bends_nothing(recorded: Recording) -> None:
    """Cables are as tight as where the trim, and anchors and mass, had moved one by one."""
    machine = RecordedMachine([recorded], NAMES, workers=1)
    rng, here = np.random.default_rng(1), np.zeros(len(machine.nuisances))
    kinds = [one.effect for one in machine.meanings]
    moved = [i for i, kind in enumerate(kinds) if kind in ("geometry", "mass", "pretension")]
    here[moved] = rng.standard_normal(len(moved))
    (trim,) = [i for i, one in enumerate(machine.meanings) if one.parameter == "trimmed_share"]
    change = np.zeros(len(here))
    change[moved] = 0.5 * rng.standard_normal(len(moved))
    here[trim], change[trim] = 0.3, 0.5
    only_trim = np.where(np.arange(len(here)) == trim, change, 0.0)
    there = here + change

    def tight_n(nuisance: Array) -> Array:
        return machine.job(Point(nuisance), 0).task.machine.pretension

    parts = tight_n(here + only_trim) + tight_n(here + change - only_trim) - 2.0 * tight_n(here)
    straight = there + machine.bend(Point(here), Point(there))
    assert np.abs(tight_n(there) - tight_n(here) - parts).max() > 0.05
    assert tight_n(straight) - tight_n(here) == pytest.approx(parts, abs=1e-9)
    assert machine.bend(Point(here), Point(here + change - only_trim)) == pytest.approx(0.0)


def beside(recorded: Recording, found: Prediction, wanted: Prediction) -> float:
    """How far two predictions are apart, in units of noise, rms of the channel that is farthest."""
    return max(
        float(np.sqrt(np.mean(((one - other) / sigmas_of(bundle)) ** 2, axis=0)).max())
        for bundle, one, other in zip(recorded.bundles, found, wanted, strict=True)
    )


def test_however_high_a_machine_rings_that_is_let_go_its_rows_are_close_enough(
    tmp_path: Path,
) -> None:
    # The motion ends at once, at the top of its swing.
    let_go = {"frequency_hz": 1.5, "motion_s": 4.1667, "ramp_s": 0.0, "rest_s": 2.0}
    recorded = by_model(tmp_path, [], Excitation(amplitude_deg=2.0, **let_go, **STILL))
    machine = RecordedMachine([recorded], NAMES, workers=1)
    nominal = Point(np.zeros(len(machine.nuisances)), ring="as_is")
    job = machine.job(nominal, 0)
    finer = run(job.task, output_rate_hz=10.0 * recorded.output_hz(job.task))
    (seen,) = machine.simulate([nominal], lambda found: found)
    assert beside(recorded, seen, seen_by(recorded, finer, job.sight)) < 0.05


def test_rows_are_close_enough_where_a_platform_rings_while_its_cables_stick(
    tmp_path: Path,
) -> None:
    pushed = STILL | {"platform_offset_m": (1e-4, 0.0, 0.0)}
    recorded = by_model(tmp_path, [], Excitation(motion_s=1.5, **pushed))
    machine = RecordedMachine([recorded], ("pulley_capstan",), workers=1)
    rubs = Setting({f"friction@{i}": 0.1 for i in range(1, 9)}, {"presliding_m": 4e-5})
    plain = Point(np.zeros(len(machine.nuisances)), ring="as_is")
    stuck = machine.job(replace(plain, effects={"pulley_capstan": rubs}), 0)
    rows_hz = [recorded.output_hz(task) for task in (machine.job(plain, 0).task, stuck.task)]
    assert rows_hz[1] > rows_hz[0]
    coarse, rows, finer = (
        seen_by(recorded, run(stuck.task, output_rate_hz=rate_hz, step_s=1e-4), stuck.sight)
        for rate_hz in (*rows_hz, 10.0 * rows_hz[1])
    )
    # Rows of a plain run would miss more than the noise; corners of what slips are left.
    misses = [beside(recorded, one, finer) for one in (coarse, rows)]
    assert misses[0] > 1.0
    assert misses[1] < misses[0] / 4.0


@pytest.mark.parametrize(("friction", "times"), [(0.0, 1.0), (0.003, 2.0), (0.01, 3.0), (0.1, 4.0)])
def test_rows_are_as_many_times_as_close_as_that_rings_fast(
    recorded: Recording, friction: float, times: float
) -> None:
    machine = RecordedMachine([recorded], ("pulley_capstan",), workers=1)
    rubs = Setting({f"friction@{i}": friction for i in range(1, 9)}, {"presliding_m": 4e-5})
    plain = Point(np.zeros(len(machine.nuisances)))
    stuck = machine.job(replace(plain, effects={"pulley_capstan": rubs}), 0).task
    assert recorded.output_hz(stuck) == times * recorded.output_hz(machine.job(plain, 0).task)
    # Ten in each period, but for what rings faster than rows are ever close.
    assert times == 4.0 or recorded.output_hz(stuck) > 10.0 * stuck.stuck_hz


def test_what_is_off_in_every_run_is_off_once(recorded: Recording) -> None:
    other = replace(recorded, run=replace(recorded.run, folder=Path("other")))
    machine = RecordedMachine([recorded, other], NAMES, workers=1)
    tight = [one.record for one in machine.meanings if one.parameter == "pretension_offset_n"]
    assert sorted(set(tight)) == [-1, 0, 1]
    own = own_nuisances(machine.nuisances)
    assert {term for name, term in own if name == "pretension"} == {
        f"pretension_offset_n@{cable}" for cable in range(1, 9)
    }
    nuisance = np.zeros(len(machine.nuisances))
    for i, one in enumerate(machine.meanings):
        if one.parameter == "pretension_offset_n" and one.cable == 3:
            nuisance[i] = {-1: 2.0, 0: 1.0, 1: -1.0}[one.record]
    sigma = recorded.rig.cable[2].pretension_n.sigma
    for record, sigmas in ((0, 3.0), (1, 1.0)):
        offset = machine.job(Point(nuisance), record).task.effects[0].values["pretension_offset_n"]
        assert offset[2] == pytest.approx(sigmas * sigma)


def test_a_trim_of_several_runs_bends_what_is_off_in_all_of_them(recorded: Recording) -> None:
    other = replace(recorded, run=replace(recorded.run, folder=Path("other")))
    machine = RecordedMachine([recorded, other], NAMES, workers=1)
    here, there = (Point(np.full(len(machine.nuisances), size)) for size in (0.2, 0.7))
    both = machine.bend(here, there)
    of = np.array([one.record for one in machine.meanings])
    assert np.abs(both[of == -1]).max() > 0.01
    assert both[of >= 0] == pytest.approx(0.0, abs=1e-9)
    asked = machine.bend(here, replace(there, records=(recorded.run.name,)))
    assert asked == pytest.approx(both)


def test_what_a_cable_is_as_a_string_is_simulated_where_strings_vibrate(
    recorded: Recording,
) -> None:
    machine = RecordedMachine([recorded], NAMES, workers=1)
    nominal = Point(np.zeros(len(machine.nuisances)))
    heavier = nominal.nuisance.copy()
    for i, one in enumerate(machine.meanings):
        if one.parameter == "density_share" and one.cable == 5:
            heavier[i] = 2.0
            density = recorded.rig.cable[4].line_density_kg_per_m
    points = [nominal, replace(nominal, nuisance=heavier)]
    before, after = machine.simulate(points, lambda found: found)
    one_alone = machine.simulated
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))
    shaken = {"cable_end_forcing": Setting({f"forcing_share@{i}": 1.0 for i in range(1, 9)}, {})}
    points = [replace(one, effects=shaken) for one in points]
    before, after = machine.simulate(points, lambda found: found)
    assert machine.simulated == 3 * one_alone
    assert max(np.abs(a - b).max() for a, b in zip(before, after, strict=True)) > 1e-3
    changed = [machine.job(one, 0).task.machine.line_density for one in points]
    ratio = 1.0 + 2.0 * density.sigma / density.value
    assert changed[1] / changed[0] == pytest.approx([1, 1, 1, 1, ratio, 1, 1, 1])
