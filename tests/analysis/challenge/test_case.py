"""Cases repeat by their seed, say nothing of what they conceal, and their truth stays sealed."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.challenge.case import Case, PlannedRun
from analysis.challenge.draw import Slot, draw_case, slots
from analysis.challenge.make import make
from analysis.challenge.plant.concealed import Concealed, catalogue
from analysis.challenge.plant.machine import Offset
from analysis.challenge.plant.record import Sensing
from analysis.challenge.plants import plant_named
from analysis.challenge.rig_text import rig_text
from analysis.challenge.rigs import cdpr8, drawn_machine, with_pretension
from analysis.challenge.seal import open_seal
from analysis.challenge.strength import holds, tamed
from analysis.challenge.truth import drawn_offset
from analysis.challenge.visibility import Metric, look
from analysis.challenge.whitened import whitened
from cdpr8.errors import DataError
from cdpr8.rigfile import Excitation, Rig, parse_rig
from cdpr8.runfolder import load_run
from model import observe, simulate

NOTHING = [Slot(1, "single", (), ())]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folders = tuple(tmp_path_factory.mktemp("made") / name for name in ("first", "second"))
    for folder in folders:
        make(folder, 1, 7, plan=NOTHING)
    return folders


def test_the_same_seed_makes_the_same_bytes(made: tuple[Path, Path]) -> None:
    first, second = (
        {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.*")}
        for folder in made
    )
    assert len(first) >= 10
    assert first == second


def test_a_case_is_a_run_that_says_it_is_simulated_and_nothing_more(
    made: tuple[Path, Path],
) -> None:
    run = load_run(made[0] / "case_0001" / "run01")
    assert run.start.simulated
    assert "challenge case" in str(run.start.reconstruction)
    assert run.notes == ()
    assert not run.rig.physics
    assert len(run.pose) == len(run.frames)
    index = json.loads((made[0] / "index.json").read_text())
    assert index["cases"] == {"case_0001": {"kind": "single", "runs": ["run01"]}}


def test_the_truth_opens_and_a_changed_truth_does_not(made: tuple[Path, Path]) -> None:
    truth, digest = open_seal(made[1])
    assert truth["cases"][0]["effects"] == []
    assert digest in (made[1] / "seal.sha256").read_text()
    path = made[1] / "sealed.json"
    original = path.read_bytes()
    path.write_bytes(original.replace(b'"kind": "single"', b'"kind": "double"'))
    with pytest.raises(DataError, match="the seal is broken"):
        open_seal(made[1])
    path.write_bytes(original)


def test_a_folder_that_holds_something_is_refused(made: tuple[Path, Path]) -> None:
    with pytest.raises(DataError, match="not empty"):
        make(made[0], 1, 7, plan=NOTHING)


def test_a_quarter_conceal_nothing_and_every_effect_comes() -> None:
    plan = slots(240, np.random.default_rng(0))
    for kind in ("single", "campaign"):
        counts = [len(slot.effects) for slot in plan if slot.kind == kind]
        assert [counts.count(n) for n in (0, 1, 2)] == [30, 60, 30]
    names = [name for slot in plan for name in slot.effects]
    assert {names.count(name) for name in catalogue()} <= {5, 6}
    assert not any({"pulley_coulomb", "pulley_stribeck"} <= set(slot.effects) for slot in plan)


def test_other_machines_are_sound_rigs_at_any_pretension() -> None:
    generator = np.random.default_rng(8)
    for _ in range(3):
        rig = drawn_machine(generator)
        again = parse_rig(rig_text(rig), "written", Path())
        assert again.cable == rig.cable
        tighter = with_pretension(rig, 1.5)
        assert tighter is not None
        parse_rig(rig_text(tighter), "tighter", Path())


def test_a_drawn_machine_moves_with_every_cable_taut() -> None:
    case = draw_case(Slot(1, "single", (), ()), np.random.SeedSequence(9))
    measured = case.made(case.runs[0], noise=False)
    assert measured.tension_n.min() > 0.3


def with_true_numbers(rig: Rig, offset: Offset) -> Rig:
    """What the rig file would say if it knew."""

    def moved(row: Any, by: Any) -> Any:
        value = np.array(row.value) + by
        return row.model_copy(update={"value": tuple(value) if value.ndim else float(value)})

    def scaled(row: Any, share: float) -> Any:
        return moved(row, row.value * share)

    cables = tuple(
        cable.model_copy(
            update={
                "base_m": moved(cable.base_m, offset.base_m[i] - offset.centre_m),
                "anchor_m": moved(cable.anchor_m, offset.anchor_m[i] - offset.centre_m),
                "stiffness_n_per_m": scaled(cable.stiffness_n_per_m, offset.stiffness_share[i]),
                "pretension_n": moved(cable.pretension_n, offset.pretension_n[i]),
                "line_density_kg_per_m": scaled(
                    cable.line_density_kg_per_m, offset.density_share[i]
                ),
                "damping_1_per_s": scaled(cable.damping_1_per_s, offset.loss_share[i]),
            }
        )
        for i, cable in enumerate(rig.cable)
    )
    platform = rig.platform.model_copy(
        update={
            "mass_kg": scaled(rig.platform.mass_kg, offset.mass_share),
            "inertia_kg_m2": moved(rig.platform.inertia_kg_m2, offset.inertia_kg_m2),
        }
    )
    return rig.model_copy(update={"cable": cables, "platform": platform})


@pytest.mark.parametrize("ramp_s", [0.3, 0.0], ids=["ramped", "let go"])
def test_where_nothing_is_concealed_true_numbers_explain_a_run_to_its_noise(
    ramp_s: float,
) -> None:
    excitation = Excitation(frequency_hz=2.0, rest_s=1.0, motion_s=1.125, ramp_s=ramp_s)
    rig = cdpr8().model_copy(update={"excitation": excitation})
    generator = np.random.default_rng(12)
    offset = drawn_offset(rig, generator)
    run = PlannedRun(rig, np.random.SeedSequence(13))
    case = Case("null", "single", (run,), Sensing.drawn(generator), offset)
    measured = case.made(run)
    model = simulate(with_true_numbers(rig, offset), excitation, nominal=rig, output_rate_hz=2e3)
    seen = observe(model, [], tension_t_s=measured.tension_t_s, pose_t_s=measured.pose_t_s)
    left = (measured.tension_n - seen.tension_n) / case.sensing.tension_noise_n
    assert np.sqrt(np.mean(left**2)) == pytest.approx(1.0, abs=0.06)
    angles = (measured.pose - seen.pose)[:, 3:] / np.sqrt(
        np.diagonal(measured.covariance, axis1=1, axis2=2)[:, 3:]
    )
    assert np.sqrt(np.mean(angles**2)) == pytest.approx(1.0, abs=0.2)


@pytest.fixture(scope="module")
def short() -> Case:
    excitation = Excitation(frequency_hz=2.0, rest_s=0.3, motion_s=1.0, ramp_s=0.3)
    rig = cdpr8().model_copy(update={"excitation": excitation})
    run = PlannedRun(rig, np.random.SeedSequence(2))
    sensing = Sensing.drawn(np.random.default_rng(1))
    return Case("short", "single", (run,), sensing, Offset.none())


def test_visibility_tells_what_the_machine_absorbs_from_what_it_does_not(short: Case) -> None:
    metric = Metric.of(short)
    effects = catalogue()

    def seen(name: str, size: float, cables: tuple[int, ...]) -> tuple[float, float]:
        shown = Concealed(effects[name], size, cables, {})
        found = look(short.with_concealed(shown), metric, rivals=False)[0]
        return found.whole, found.stands_out

    # Four sigmas of one stiffness: seen at most as four sigmas, however large the change.
    whole, stands_out = seen("stiffness", 0.08, (1,))
    assert whole > 20.0
    assert 1.0 < stands_out < 4.2
    # A wheel leads its cable a little elsewhere, as a base point does that is a little off.
    whole, stands_out = seen("pulley_geometry", 2e-3, tuple(range(1, 9)))
    assert whole > 20.0
    assert stands_out < 6.0
    # A cell's lag is no machine's.
    whole, stands_out = seen("cell_lag", 0.01, (1,))
    assert stands_out > 0.5 * whole
    # Twice the drift stands out twice as far.
    one, two = (seen("cell_drift", size, (1,))[1] for size in (0.01, 0.02))
    assert two == pytest.approx(2.0 * one, rel=0.05)


def test_what_every_quartz_is_off_by_is_no_mismatch(short: Case) -> None:
    metric = Metric.of(short)

    def stands_out(name: str, size: float) -> float:
        shown = Concealed(catalogue()[name], size, (), {})
        return look(short.with_concealed(shown), metric, rivals=False)[0].stands_out

    for name, one_sigma in (("drive_frequency", 30e-6), ("clock_drift", 30.0)):
        assert stands_out(name, 2.0 * one_sigma) < 2.1
        assert stands_out(name, 60.0 * one_sigma) > 1.5 * stands_out(name, 15.0 * one_sigma)


def test_a_machine_that_comes_apart_says_so_and_is_no_run(short: Case) -> None:
    # Dampers this stiff cannot be integrated by steps this long.
    dampers = Concealed(catalogue()["cable_viscous"], 2e4, tuple(range(1, 9)), {})
    case = short.with_concealed(dampers)
    course = case.happened(case.runs[0], 1e-3)
    assert np.isnan(course.pose[-1]).all()
    assert np.isnan(course.tension_n[-1]).all()
    assert not holds(case, 1e-3)
    metric = Metric.of(short)
    assert metric.length(whitened(case, 1e-3) - metric.known.data) > 1e5
    tame = tamed(case)
    assert 1.0 < tame.concealed[0].size < 2e4
    assert holds(tame, 5e-4)


def test_bristles_are_not_made_smaller_for_steps_that_are_too_long() -> None:
    # They relax as fast, however weak: in the steps by which a swing is looked at they fly apart.
    slot = Slot(1, "single", ("pulley_stribeck",), ("limit",))
    case = draw_case(slot, np.random.SeedSequence(3), plant_named("outsider"))
    assert not holds(case, case.plant.look_step_s)
    assert tamed(case).concealed == case.concealed


def test_a_machine_that_cannot_be_integrated_is_no_case(
    short: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("analysis.challenge.strength.holds", lambda *_: False)
    dampers = Concealed(catalogue()["cable_viscous"], 1.0, (1,), {})
    with pytest.raises(DataError, match="cable_viscous"):
        tamed(short.with_concealed(dampers))


@pytest.mark.slow
def test_a_strong_effect_is_visible_and_told_from_its_rivals(tmp_path: Path) -> None:
    plan = [
        Slot(1, "single", ("cell_lag",), ("strong",)),
        Slot(2, "single", ("pulley_coulomb",), ("limit",)),
    ]
    make(tmp_path, 2, 11, plan=plan)
    lag, coulomb = (case["effects"][0] for case in open_seal(tmp_path)[0]["cases"])
    assert lag["visible"]
    assert lag["separable"]
    assert lag["parameters"] == {"lag_s": lag["size"]}
    assert len(lag["rivals"]) == len(catalogue()) - 1
    assert coulomb["size"] < 0.2
    assert coulomb["visible"]
    assert coulomb["detection_limit"] < coulomb["size"]
