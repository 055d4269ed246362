"""The outsider moves as the paper's equations where nothing is concealed, and otherwise not."""

import json
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from analysis.challenge.case import Case, PlannedRun
from analysis.challenge.draw import Slot, draw_case, slots
from analysis.challenge.make import make
from analysis.challenge.outsider.camera import CameraFault, exposed_at
from analysis.challenge.outsider.concealed import Concealed, catalogue
from analysis.challenge.outsider.entrant import Outsider
from analysis.challenge.outsider.machine import Machine, Offset
from analysis.challenge.outsider.plant import Course, rest_wrench, simulate
from analysis.challenge.outsider.record import Measured, Sensing
from analysis.challenge.outsider.rigs import drawn, drawn_offset, packaged, swung
from analysis.challenge.outsider.shutter import rolled
from analysis.challenge.plants import plant_named
from analysis.challenge.report import report
from analysis.challenge.score import score
from analysis.challenge.seal import open_seal
from analysis.challenge.visibility import Metric, look
from cdpr8.rigfile import Excitation, Rig
from cdpr8.runfolder import load_run
from model import simulate as simulate_model
from model.effects import ActiveEffect, library

SHORT = Excitation(rest_s=0.2, motion_s=1.2, ramp_s=0.3)
STEP_S = 2.5e-4
PLAN = [Slot(1, "single", ("cell_zero",), ("strong",))]

CELL_SIDE, CAMERA_SIDE = {"cell"}, {"camera", "clock"}


def asked(**changes: object) -> Rig:
    excitation = Excitation.model_validate(SHORT.model_dump() | changes)
    return packaged().model_copy(update={"excitation": excitation})


def another(excitation: Excitation) -> Rig:
    return drawn(excitation, np.random.default_rng(5))


@pytest.fixture(scope="module")
def sound() -> Case:
    run = PlannedRun(asked(), np.random.SeedSequence(2))
    sensing = Sensing.drawn(np.random.default_rng(1))
    return Case("short", "single", (run,), sensing, Offset.none(), (), Outsider())


@pytest.fixture(scope="module")
def usual(sound: Case) -> Measured:
    return sound.made(sound.runs[0], noise=False, step_s=STEP_S)


def at_rows(course: Course, t_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tensions and angles where a course and rows of the model meet."""
    rows = np.rint(t_s / (course.t_s[1] - course.t_s[0])).astype(int)
    return course.tension_n[rows], course.pose[rows, 3:]


@pytest.mark.parametrize(
    "rig",
    [
        asked(),
        asked(axis="roll", frequency_hz=4.0),
        asked(axis="yaw", ramp="septic", ending="ramp_beyond"),
        another(Excitation.model_validate(SHORT.model_dump() | {"frequency_hz": 1.4})),
    ],
    ids=["pitch", "roll", "yaw, another ramp", "another machine"],
)
def test_with_nothing_concealed_the_outsider_is_the_model(rig: Rig) -> None:
    course = simulate(rig, Offset.none())
    model = simulate_model(rig, rig.excitation)
    shown = model.t_s <= course.t_s[-1]
    tension, angles = at_rows(course, model.t_s[shown])
    assert np.abs(tension - model.tension_n[shown]).max() < 2e-6
    assert np.abs(angles - model.pose[shown, 3:]).max() < 2e-8


@pytest.mark.parametrize(("stays", "trimmed"), [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0)])
def test_a_machine_that_is_off_is_the_model_s_where_its_drive_stays_and_it_was_trimmed(
    stays: float, trimmed: float
) -> None:
    rig, anchor_m = asked(), np.zeros((8, 3))
    anchor_m[3] = -2e-3, 4e-3, 6e-3
    off = Offset.none().with_added(
        centre_m=np.array([0.01, 0.0, -0.02]), mass_share=0.1, anchor_m=anchor_m
    )
    course = simulate(rig, off)
    effects = [
        ActiveEffect("mass", {"mass_share": 0.1}),
        ActiveEffect(
            "centre_of_mass",
            {
                "centre_x_m": 0.01,
                "centre_z_m": -0.02,
                "centre_y_m": 0.0,
                "drive_stays_share": stays,
            },
        ),
        ActiveEffect(
            "geometry",
            {f"base_{a}_m": 0.0 for a in "xyz"}
            | {f"anchor_{a}_m": tuple(anchor_m[:, k]) for k, a in enumerate("xyz")},
        ),
        ActiveEffect("pretension", {"pretension_offset_n": 0.0, "trimmed_share": trimmed}),
    ]
    model = simulate_model(rig, rig.excitation, effects=effects, nominal=rig)
    shown = model.t_s <= course.t_s[-1]
    tension, _ = at_rows(course, model.t_s[shown])
    missed_n = np.abs(tension - model.tension_n[shown]).max()
    assert missed_n < 1e-5 if stays and trimmed else missed_n > 0.02


def test_a_true_machine_hangs_still_until_the_drive_starts() -> None:
    rig = asked()
    offset = drawn_offset(rig, np.random.default_rng(3))
    course = simulate(rig, offset, step_s=STEP_S)
    rest = course.t_s < rig.excitation.start_s
    assert np.ptp(course.tension_n[rest], axis=0).max() < 1e-8
    assert np.abs(course.pose[rest]).max() < 1e-10
    assert 0.01 < np.abs(course.tension_n[0] - Machine.from_rig(rig).pretension).max() < 0.2


def one_of(name: str, generator: np.random.Generator, share: float = 1.0) -> Concealed:
    effect = catalogue()[name]
    details = dict(effect.draw(generator))
    if name == "cell_saturation":
        details = {"rest_n": 15.6, "top_n": 23.0}
    if name == "frames_dropped":
        details = {"before_0": 8.0}
    # One and two are alike by symmetry: swapped, they would not show.
    cables = () if not effect.cables else (1, 3)
    return Concealed(effect, share * effect.typical, cables, details)


@pytest.mark.parametrize("name", sorted(set(catalogue()) - {"cable_slack"}))
def test_every_effect_shows_where_it_should(sound: Case, usual: Measured, name: str) -> None:
    one = one_of(name, np.random.default_rng(4))
    changed = sound.with_concealed(one).made(sound.runs[0], noise=False, step_s=STEP_S)
    tension = np.abs(changed.tension_n - usual.tension_n).max(axis=0)
    pose = np.abs(changed.pose - usual.pose).max()
    assert np.isfinite(changed.tension_n).all()
    if one.effect.side in CAMERA_SIDE:
        assert tension.max() == 0.0
        assert pose > 1e-6
    else:
        assert tension.max() > 1e-4
    if one.effect.side in CELL_SIDE:
        assert pose == 0.0
        assert np.delete(tension, (0, 2)).max() == 0.0


def test_a_cable_that_cannot_push_shows_where_it_would_have_to() -> None:
    plant, generator = Outsider(), np.random.default_rng(6)
    (rig,), _, offset = plant.planned("single", ["cable_slack"], generator)
    rig = rig.model_copy(update={"excitation": SHORT})
    assert swung(Machine.from_rig(rig), SHORT).min() < 0.0
    slack = plant.placed("cable_slack", rig, offset, generator)
    pushed, hung = (plant.happened(rig, offset, each, STEP_S) for each in ([], [slack]))
    assert pushed.tension_n.min() < -0.3
    assert hung.tension_n.min() == 0.0


@pytest.mark.parametrize("name", [k for k, one in sorted(catalogue().items()) if one.straight])
def test_what_is_said_to_act_in_proportion_does(sound: Case, usual: Measured, name: str) -> None:
    changes = []
    for share in (0.005, 0.01):
        one = one_of(name, np.random.default_rng(4), share)
        made = sound.with_concealed(one).made(sound.runs[0], noise=False, step_s=STEP_S)
        changes.append(made.tension_n - usual.tension_n)
    once, twice = changes
    # A square would be off by half.
    assert np.linalg.norm(twice - 2.0 * once) < 0.2 * np.linalg.norm(twice)


@pytest.mark.parametrize(
    "name",
    ["cable_viscous", "cable_relaxation", "cable_hysteresis", "cable_structural",
     "pulley_coulomb", "pulley_stribeck", "pulley_presliding", "pulley_inertia",
     "platform_damping", "air_drag", "umbilical"],
)  # fmt: skip
def test_what_dissipates_takes_from_a_free_swing(name: str) -> None:
    """The drive stops at once: what is left rings, and with these less and less."""
    rig = asked(motion_s=0.73, rest_s=1.2, ending="at_once", cable_offset_m=0.0)
    one = one_of(name, np.random.default_rng(5))
    one = replace(one, cables=tuple(range(1, 9)) if one.cables else ())
    swings = []
    for concealed in ([], [one]):
        # A stop at once is a blow: bristles follow it by short steps only.
        course = Outsider().happened(rig, Offset.none(), concealed, Outsider().fine_step_s)
        free = course.pose[course.t_s > rig.excitation.end_s + 0.05, 4]
        swings.append([np.std(part) for part in np.array_split(free - free.mean(), 3)])
    kept, lost = swings
    assert lost[2] / lost[0] < kept[2] / kept[0] * 0.999


def test_frames_are_exposed_when_their_stamps_faults_say() -> None:
    stamp_s = np.array([1.0, 1.0625, 1.125])
    late = exposed_at(stamp_s, 0.0625, CameraFault(latency_s=0.01))
    assert late == pytest.approx(stamp_s - 0.01)
    lost = exposed_at(stamp_s, 0.0625, CameraFault(lost_before=(1, 2)))
    assert lost == pytest.approx([1.0, 1.125, 1.25])
    fast = exposed_at(stamp_s, 0.0625, CameraFault(drift_share=0.01))
    assert fast == pytest.approx(stamp_s / 1.01)


def test_a_rolling_shutter_that_reads_at_once_sees_what_is_there() -> None:
    def motion(at_s: np.ndarray) -> np.ndarray:
        rates = np.array([1e-3, -2e-3, 3e-3, 0.02, 0.04, -0.01])
        return np.asarray(at_s)[..., None] * rates

    at_s = np.array([0.5, 1.0])
    assert rolled(motion, at_s, 1e-12) == pytest.approx(motion(at_s), abs=1e-8)
    # A row lasts so long that the plate's middle is seen a hundredth of a second later.
    later = rolled(motion, at_s, 1e-4) - motion(at_s)
    assert later[:, 4] == pytest.approx(0.04 * 0.012, rel=0.2)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folders = tuple(tmp_path_factory.mktemp("outsider") / name for name in ("first", "second"))
    nothing = [Slot(1, "single", (), ())]
    for folder in folders:
        make(folder, 1, 7, plant="outsider", plan=nothing)
    return folders


def test_the_same_seed_makes_the_same_bytes(made: tuple[Path, Path]) -> None:
    first, second = (
        {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.*")}
        for folder in made
    )
    assert len(first) >= 10
    assert first == second


def test_a_case_is_a_run_by_the_schemas_and_says_nothing_of_its_truth(
    made: tuple[Path, Path],
) -> None:
    import jsonschema

    folder = made[0] / "case_0001" / "run01"
    run = load_run(folder)
    assert run.notes == ()
    assert run.start.simulated
    assert not run.rig.physics
    assert len(run.pose) == len(run.frames)
    schemas = files("cdpr8.runfolder") / "schemas" / "v1"
    for name in ("start", "stop"):
        schema = json.loads((schemas / f"{name}.schema.json").read_text())
        jsonschema.validate(json.loads((folder / f"{name}.json").read_text()), schema)
    truth, _ = open_seal(made[0])
    assert truth["plant"] == json.loads((made[0] / "index.json").read_text())["plant"]
    written = {path.name for path in folder.iterdir()}
    assert not {"sealed.json", "truth.json"} & written
    assert "effects" not in (folder / "start.json").read_text()


def test_every_effect_and_its_told_numbers_are_those_of_the_design() -> None:
    generator, rig = np.random.default_rng(8), asked()
    known, plant = library(), plant_named("outsider")
    for name, effect in catalogue().items():
        one = plant.placed(name, rig, Offset.none(), generator)
        wanted = set(plant.told(one, rig))
        assert wanted <= {parameter.name for parameter in known[name].parameters}, name
        assert effect.least <= abs(one.size) <= effect.most
        kin = "clock" if name == "frames_dropped" else effect.side
        assert kin in ("plant", "parameter", "drive", "cell", "camera", "clock")


def test_slots_of_the_outsider_hold_all_its_effects_and_no_clash() -> None:
    plan = slots(240, np.random.default_rng(0), plant=plant_named("outsider"))
    names = [name for slot in plan for name in slot.effects]
    assert set(names) == set(catalogue())
    frictions = {"pulley_coulomb", "pulley_stribeck", "pulley_capstan", "pulley_presliding"}
    assert not any(len(frictions & set(slot.effects)) > 1 for slot in plan)


def test_a_campaign_is_six_runs_of_one_machine_and_true_machines_balance() -> None:
    case = draw_case(
        Slot(1, "campaign", ("pulley_coulomb",), ("typical",)),
        np.random.SeedSequence(9),
        plant_named("outsider"),
    )
    assert len(case.runs) == 6
    assert len({run.rig.cable[0].stiffness_n_per_m.value for run in case.runs}) == 1
    for run in case.runs:
        nominal = Machine.from_rig(run.rig)
        drive = rest_wrench(nominal, run.excitation)
        true = case.offset.applied(nominal, drive)
        assert np.abs(true.structure @ true.pretension + true.weight + drive).max() < 1e-9


def test_visibility_tells_what_the_machine_absorbs_from_what_it_does_not(sound: Case) -> None:
    metric = Metric.of(sound, 1e-3)

    def seen(name: str, size: float, cables: tuple[int, ...]) -> tuple[float, float]:
        shown = Concealed(catalogue()[name], size, cables, {})
        found = look(sound.with_concealed(shown), metric, rivals=False)[0]
        return found.whole, found.stands_out

    # Four sigmas of one stiffness: seen at most as four sigmas, however large the change.
    whole, stands_out = seen("stiffness", 0.08, (1,))
    assert whole > 20.0
    assert 1.0 < stands_out < 4.2
    # A cell's lag is no machine's.
    whole, stands_out = seen("cell_lag", 0.01, (1,))
    assert stands_out > 0.4 * whole


@pytest.mark.slow
def test_a_challenge_of_the_outsider_is_scored_and_its_page_says_whose_it_is(
    tmp_path: Path,
) -> None:
    make(tmp_path, 1, 11, plant="outsider", plan=PLAN)
    found = score(tmp_path)
    (zero,) = found.grades[0].truth
    assert zero["visible"]
    assert zero["parameters"] == {"zero_n": zero["size"]}
    assert len(zero["rivals"]) == len(catalogue()) - 1
    page = report(found)
    assert "by the outsider" in page
    assert "--plant outsider --kind single" in page
