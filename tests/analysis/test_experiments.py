"""The next experiment: proposed where rivals remain, recordable, and telling them apart."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recorded_by import STILL, by_model

from analysis.diagnosis import outlook
from analysis.diagnosis.experiments import campaign, next_experiment, survey
from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.measurements import AGAIN, BREAKAWAY, SCALE, TAP, WEIGHTS, measurement
from analysis.diagnosis.menu import experiments as menu
from analysis.diagnosis.menu import with_pretension, write_rig
from analysis.diagnosis.outlook import ENOUGH
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.telling import Rival, Telling, information_bits
from analysis.engine.calibrate import Calibrated
from analysis.engine.cause import Cause
from analysis.engine.cause import Rival as Other
from analysis.engine.diagnosis import Diagnosis
from analysis.engine.fitted import Fitted
from analysis.engine.judge import Judgement
from analysis.engine.lens import Lens
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.screen import Screen
from analysis.engine.search import Search
from analysis.engine.sensitivity import term_columns
from cdpr8.rigfile import Excitation, load_rig
from cdpr8.rigfile.checks import structure_matrix_at_rest
from model import ActiveEffect

SHORT = Excitation(motion_s=5.0, **STILL)
NAMES = ("cable_viscous", "cable_structural")


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    damped = ActiveEffect("cable_viscous", {"viscous_n_s_per_m": 8.0})
    return by_model(tmp_path_factory.mktemp("runs") / "damped", [damped], SHORT)


@pytest.fixture(scope="module")
def undecided(recorded: Recording) -> tuple[RecordedMachine, Diagnosis]:
    """Viscous and structural damping, fitted both, as if the run could not tell them apart."""
    machine = RecordedMachine([recorded], NAMES, workers=1)
    seen = look(machine)
    candidates = {one.name: one for one in machine.candidates}
    at, columns = seen.calibrated.at, seen.calibrated.columns
    terms = term_columns(machine, seen.lens, machine.candidates, at, columns)
    screen = Screen(seen.calibrated.problem, candidates, terms)
    refiner = Refiner(machine, seen.lens, seen.data, seen.calibrated)
    null = refiner.fit(screen.null())
    fitted = [refiner.fit(screen.best_of(name)) for name in NAMES]
    return machine, _ambiguous(
        machine, seen.lens, seen.data, seen.calibrated, null, fitted, refiner
    )


def _ambiguous(
    machine: RecordedMachine,
    lens: Lens,
    data: np.ndarray,
    calibrated: Calibrated,
    null: Fitted,
    fitted: list[Fitted],
    refiner: Refiner,
) -> Diagnosis:
    first, second = fitted
    rival = Other(NAMES[1], 0.45, second)
    cause = Cause(NAMES[0], 0.55, 1.0, (rival,), {}, {}, {}, {}, {}, ())
    judgement = Judgement("ambiguous", (cause,), first, (0.55, 0.45, 0.0))
    searched = Search(machine, lens, data, calibrated, (), null, (first, second, null), refiner)
    return Diagnosis(machine, calibrated, (), searched, judgement, None, None)


def test_the_menu_has_other_motions_that_leave_every_cable_taut(recorded: Recording) -> None:
    found = menu([recorded])
    words = " / ".join(one.what for one in found)
    for part in ("Hz", "roll", "slow", "stopped at once", "hold", "60 s", "inner tension"):
        assert part in words
    own = recorded.excitation
    for one in found:
        asked = one.excitation
        same = (asked.axis, asked.amplitude_deg, asked.frequency_hz) == (
            own.axis, own.amplitude_deg, own.frequency_hz
        )  # fmt: skip
        assert not same or one.repeats > 1.0 or one.rig is not recorded.rig
        assert one.minutes > 0.0
    assert not any("hold" in one.what for one in menu([recorded], ["pulley_coulomb"]))


def test_another_pretension_still_hangs_in_balance(recorded: Recording) -> None:
    changed = with_pretension(recorded.rig, 1.6)
    assert changed is not None
    structure = structure_matrix_at_rest(recorded.rig)
    before, after = (
        np.array([cable.pretension_n.value for cable in rig.cable])
        for rig in (recorded.rig, changed)
    )
    assert structure @ after == pytest.approx(structure @ before, abs=1e-5)
    assert after.mean() > 1.3 * before.mean()


def test_every_experiment_is_a_rig_file_that_can_be_recorded(
    recorded: Recording, tmp_path: Path
) -> None:
    for number, one in enumerate(menu([recorded])):
        rig = load_rig(write_rig(one, recorded, tmp_path / f"next_{number}.toml"))
        assert rig.excitation == one.excitation
        assert rig.cable == one.rig.cable or "inner tension" in one.what


def test_information_is_none_for_the_same_and_all_for_what_is_far_apart() -> None:
    weights = np.array([0.5, 0.5])
    assert information_bits(np.zeros((2, 2)), weights) == pytest.approx(0.0)
    apart = 200.0 * (1.0 - np.eye(2))
    assert information_bits(apart, weights) == pytest.approx(1.0)


@pytest.mark.long
def test_another_frequency_tells_viscous_from_structural_damping(
    undecided: tuple[RecordedMachine, Diagnosis], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    machine, diagnosis = undecided
    short = ("at 1 Hz", "at 4 Hz", "stopped")
    few = [one for one in menu(machine.recordings) if any(part in one.what for part in short)]
    monkeypatch.setattr(outlook, "experiments", lambda *_: few)
    looked = survey(machine, diagnosis, workers=1)
    assert looked is not None
    assert [one.name for one in looked.rivals] == list(NAMES)
    said = next_experiment(machine, diagnosis, looked, tmp_path)
    assert said is not None
    assert said["separates"] == list(NAMES)
    assert said["expected_log_odds"] > ENOUGH
    assert said["command"] == f"rig record --rig {tmp_path / 'next_1.toml'}"
    assert load_rig(tmp_path / "next_1.toml").excitation.frequency_hz != SHORT.frequency_hz
    planned = campaign(machine, looked, tmp_path)
    assert len(planned) == len(few)
    assert all(load_rig(Path(one["rig_file"])) for one in planned)
    assert planned[0]["excitation"] == said["excitation"]


def test_what_is_uncertain_makes_less_sure(
    undecided: tuple[RecordedMachine, Diagnosis],
) -> None:
    machine, diagnosis = undecided
    assert diagnosis.search is not None
    first, second, _ = diagnosis.search.fitted
    rivals = (Rival(NAMES[0], 0.5, first), Rival(NAMES[1], 0.5, second))
    one = next(one for one in menu(machine.recordings) if "at 4 Hz" in one.what)
    seen = Telling(machine, diagnosis.calibrated.rotation, rivals, one, 1)
    assert 0.0 < seen.log_odds()[0, 1] < seen.at_most()[0, 1]


def test_where_no_motion_tells_a_measurement_is_named(
    undecided: tuple[RecordedMachine, Diagnosis], monkeypatch: pytest.MonkeyPatch
) -> None:
    machine, diagnosis = undecided
    monkeypatch.setattr(outlook, "experiments", lambda *_: [])
    looked = survey(machine, diagnosis, workers=1)
    said = next_experiment(machine, diagnosis, looked)
    assert said is not None
    assert said["excitation"] is None
    assert "no motion in the list tells" in said["what"]


def test_a_named_cause_is_checked_by_its_rig_file_and_nothing_named_by_none(
    undecided: tuple[RecordedMachine, Diagnosis],
) -> None:
    machine, diagnosis = undecided
    assert diagnosis.judgement is not None
    near = replace(diagnosis.judgement, verdict="unexplained")
    for judgement, wanted in ((near, True), (replace(near, causes=()), False)):
        said = next_experiment(machine, replace(diagnosis, judgement=judgement), None)
        assert said is not None
        assert "half the amplitude" in said["what"]
        assert ("improved.toml" in said["what"]) is wanted


@pytest.mark.parametrize(
    ("one", "other", "found"),
    [
        ("camera_latency", "cable_viscous", TAP),
        ("cell_lag", "camera_latency", TAP),
        ("stiffness", "cell_gain", WEIGHTS),
        ("pulley_coulomb", "pulley_capstan", BREAKAWAY),
        ("mass", "umbilical", SCALE),
        ("air_drag", "nothing left out", None),
        ("camera_latency", "camera_gain", None),
        ("cable_modes", "cable_end_forcing", AGAIN),
    ],
)
def test_a_measurement_for_every_pair(one: str, other: str, found: object) -> None:
    said = measurement(one, other)
    assert said == measurement(other, one)
    assert said.minutes > 0.0
    assert found is None or said is found
