"""The plant moves as the paper's equations where nothing is concealed, and otherwise not."""

import ast
from pathlib import Path

import numpy as np
import pytest

import analysis.challenge.plant as plant_package
from analysis.challenge.case import Case, PlannedRun
from analysis.challenge.plant.concealed import Concealed, catalogue
from analysis.challenge.plant.machine import Machine, Offset
from analysis.challenge.plant.plant import STEP_S, Course, simulate
from analysis.challenge.plant.pulley import straight, wrapped
from analysis.challenge.plant.record import Measured, Sensing, measure
from analysis.challenge.plant.sensors import KNEE_N, CellFault, Faults, read_cells
from analysis.challenge.truth import drawn_offset
from analysis.diagnosis.candidates import candidates
from analysis.diagnosis.library_values import library_values
from analysis.diagnosis.sighting import Sighting
from analysis.engine.candidate import Setting
from cdpr8.rigfile import Excitation, Rig, load_rig, packaged_rig_path
from model import ActiveEffect
from model import simulate as simulate_model
from model.effects import library

SHORT = Excitation(frequency_hz=2.0, rest_s=0.3, motion_s=2.0, ramp_s=0.4)


@pytest.fixture(scope="module")
def rig() -> Rig:
    return load_rig(packaged_rig_path()).model_copy(update={"excitation": SHORT})


@pytest.fixture(scope="module")
def sound(rig: Rig) -> Case:
    sensing = Sensing.drawn(np.random.default_rng(1))
    run = PlannedRun(rig, np.random.SeedSequence(2))
    return Case("short", "single", (run,), sensing, Offset.none())


@pytest.fixture(scope="module")
def usual(sound: Case) -> Measured:
    return sound.made(sound.runs[0], noise=False, step_s=1e-3)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"axis": "roll", "frequency_hz": 4.0},
        {"axis": "yaw"},
        {"ramp_s": 0.0, "motion_s": 1.125, "rest_s": 0.5},
    ],
    ids=["pitch", "roll", "yaw", "stopped at once"],
)
def test_with_nothing_concealed_the_plant_is_the_model(rig: Rig, changes: dict) -> None:
    excitation = SHORT.model_copy(update=changes)
    course = simulate(rig, excitation)
    model = simulate_model(rig, excitation)
    for found, wanted in (
        (course.tension_n, model.tension_variation_n + model.rest_tension_n),
        (course.pose[:, 3:], model.pose[:, 3:]),
        (course.pose[:, :3], model.pose[:, :3]),
    ):
        at_rows = np.stack(
            [np.interp(model.t_s, course.t_s, found[:, j]) for j in range(found.shape[1])], axis=1
        )
        amplitude = np.abs(wanted - wanted[0]).max()
        # Ringing is out of phase by the step squared, and is all there is of the small positions.
        limit = 1e-3 if excitation.ramp_s > 0.0 and amplitude > 1e-3 else 4e-3
        assert np.abs(at_rows - wanted).max() < limit * amplitude


def test_half_the_step_leaves_a_quarter_of_the_difference(rig: Rig) -> None:
    model = simulate_model(rig, SHORT)
    off = []
    for step_s in (STEP_S, STEP_S / 2.0):
        course = simulate(rig, SHORT, step_s=step_s)
        tension = np.interp(model.t_s, course.t_s, course.tension_n[:, 2])
        off.append(np.abs(tension - model.tension_n[:, 2]).max())
    assert off[1] < 0.35 * off[0]


def test_a_true_machine_hangs_still_until_the_drive_starts(rig: Rig) -> None:
    offset = drawn_offset(rig, np.random.default_rng(3))
    course = simulate(rig, SHORT, offset)
    rest = course.t_s < SHORT.start_s
    assert np.ptp(course.tension_n[rest], axis=0).max() < 1e-4
    assert np.abs(course.tension_n[0] - Machine.from_rig(rig).pretension).max() > 0.01


@pytest.mark.parametrize("name", ["frame_compliance", "pulley_inertia"])
def test_what_is_concealed_hangs_still_too_and_is_let_go_without_a_jolt(
    rig: Rig, name: str
) -> None:
    effect = catalogue()[name]
    offset = drawn_offset(rig, np.random.default_rng(3))
    details = dict(effect.draw(np.random.default_rng(5)))
    cables = () if effect.cables == "none" else tuple(range(1, 9))
    hidden = Concealed(effect, effect.typical, cables, details).parts(Machine.from_rig(rig)).hidden
    away = SHORT.model_copy(update={"platform_offset_m": (1e-4, 0.0, 0.0)})
    course = simulate(rig, away, offset, hidden)
    rest = course.t_s < SHORT.start_s
    assert np.ptp(course.tension_n[rest], axis=0).max() < 1e-3
    usual = simulate(rig, away, offset)
    soon = (course.t_s > SHORT.start_s) & (course.t_s < SHORT.start_s + 2e-3)
    for one in (course, usual):
        jump = one.tension_n[soon] - one.tension_n[rest].mean(axis=0)
        # 0.1 mm of 1600 N/m, and not what a wheel's grip would pull on top of it.
        assert np.abs(jump).max() < 0.25


@pytest.mark.parametrize("name", sorted(catalogue()))
def test_every_effect_shows_in_the_record(sound: Case, usual: Measured, name: str) -> None:
    effect = catalogue()[name]
    details = dict(effect.draw(np.random.default_rng(4)))
    if name == "cell_saturation":
        details = {"rest_n": 15.6, "top_n": 23.0}
    if name == "frames_dropped":
        details = {"at_s": 1.0}
    # One and two are alike by symmetry: swapped, they would not show.
    cables = () if effect.cables == "none" else (1, 3)
    concealed = Concealed(effect, effect.typical, cables, details)
    run = sound.runs[0]
    changed = sound.with_concealed(concealed).made(run, noise=False, step_s=1e-3)
    tension = np.abs(changed.tension_n - usual.tension_n).max()
    pose = np.abs(changed.pose - usual.pose).max()
    assert np.isfinite(changed.tension_n).all()
    if effect.side in ("camera", "clock"):
        assert tension == 0.0
        assert pose > 1e-6
    else:
        assert tension > 1e-4
    if effect.side == "cell":
        assert pose == 0.0
        others = np.delete(changed.tension_n - usual.tension_n, (0, 2), axis=1)
        assert np.abs(others).max() == 0.0


@pytest.mark.parametrize("name", [k for k, one in sorted(catalogue().items()) if one.straight])
def test_what_is_said_to_act_in_proportion_does(sound: Case, usual: Measured, name: str) -> None:
    effect = catalogue()[name]
    details = dict(effect.draw(np.random.default_rng(4)))
    cables = () if effect.cables == "none" else (1, 3)
    run, changes = sound.runs[0], []
    for share in (0.005, 0.01):
        concealed = Concealed(effect, share * effect.typical, cables, details)
        made = sound.with_concealed(concealed).made(run, noise=False, step_s=1e-3)
        change = np.concatenate([(made.tension_n - usual.tension_n).ravel(), made.pose.ravel()])
        change[usual.tension_n.size :] -= usual.pose.ravel()
        changes.append(change)
    once, twice = changes
    # A ring is out of phase soon; a square would be off by half.
    assert np.linalg.norm(twice - 2.0 * once) < 0.25 * np.linalg.norm(twice)


def test_a_heavier_cable_is_the_model_s(rig: Rig) -> None:
    """The share is of the weight: what it sags by goes with its square."""
    effect = catalogue()["cable_sag"]
    concealed = Concealed(effect, 3.0, tuple(range(1, 9)), {})
    course = simulate(rig, SHORT, hidden=concealed.parts(Machine.from_rig(rig)).hidden)
    heavy = (ActiveEffect("cable_sag", {"weight_share": 3.0}),)
    model, bare = simulate_model(rig, SHORT, effects=heavy), simulate_model(rig, SHORT)
    found = np.stack(
        [np.interp(model.t_s, course.t_s, course.tension_n[:, i]) for i in range(8)], axis=1
    )
    # Later a ring is out of phase: a parabola is not quite a catenary.
    begun = model.t_s < SHORT.start_s + 0.15
    off, change = (model.tension_n - one for one in (found, bare.tension_n))
    assert np.abs(off[begun]).max() < 0.05 * np.abs(change[begun]).max()


@pytest.mark.parametrize(
    "name", ["cable_viscous", "cable_relaxation", "cable_hysteresis", "cable_structural",
             "pulley_coulomb", "platform_damping", "air_drag"],
)  # fmt: skip
def test_what_dissipates_lets_a_free_platform_come_to_rest(rig: Rig, name: str) -> None:
    effect = catalogue()[name]
    excitation = SHORT.model_copy(update={"ramp_s": 0.0, "motion_s": 0.625, "rest_s": 1.5})
    details = dict(effect.draw(np.random.default_rng(5)))
    cables = () if effect.cables == "none" else tuple(range(1, 9))
    hidden = Concealed(effect, effect.typical, cables, details).parts(Machine.from_rig(rig)).hidden
    swings = []
    for chosen in ({}, {"hidden": hidden}):
        course = simulate(rig, excitation, step_s=5e-4, **chosen)
        last = course.t_s > course.t_s[-1] - 0.5
        swings.append(np.ptp(course.pose[last, 4]))
    assert swings[1] < 0.97 * swings[0]


def test_a_cell_that_bends_into_its_limit_is_among_what_is_fitted() -> None:
    """Where little of a tension's range is cut off, all of it is in the bend."""
    t_s = np.linspace(0.0, 1.0, 1001)
    tension = np.tile((23.0 + 0.3 * np.sin(6.0 * t_s))[:, None], (1, 8))
    limits, peaks = np.zeros(8), [23.3] * 8
    limits[3] = 23.2
    seen = read_cells(t_s, tension, CellFault(limit_n=limits))
    share = KNEE_N / 0.1
    setting = Setting({"clipped_n@4": 0.1}, {"knee_share": share})
    values = library_values("cell_saturation", setting, peaks, 0, Sighting(16.0, {}))
    assert values is not None
    law = library()["cell_saturation"].measure
    assert law is not None
    found = law(t_s, tension, **{name: np.array(one) for name, one in values.items()})
    assert found == pytest.approx(seen, abs=1e-9)
    (shape,) = candidates(["cell_saturation"], [(0.0, 1.0)], 16.0)[0].shapes
    assert shape.low < share < shape.high


def test_what_a_wheel_loses_to_its_grip_is_within_what_is_fitted(rig: Rig) -> None:
    effect = catalogue()["pulley_inertia"]
    excitation = SHORT.model_copy(update={"ramp_s": 0.0, "motion_s": 0.625, "rest_s": 3.0})
    hidden = Concealed(effect, 0.2, tuple(range(1, 9)), {}).parts(Machine.from_rig(rig)).hidden
    course = simulate(rig, excitation, hidden=hidden)
    (inertia,) = candidates(["pulley_inertia"], [(0.0, 1.0)], 16.0)
    grip = next(one for one in inertia.shapes if one.name == "grip_s")

    def swing(t_s: np.ndarray, pitch: np.ndarray) -> float:
        return float(np.ptp(pitch[t_s > t_s[-1] - 0.5]))

    firm, loose = (
        simulate_model(rig, excitation, effects=(
            ActiveEffect("pulley_inertia", {"equivalent_kg": 0.2, "grip_s": one}),
        ))
        for one in (grip.low, grip.default)
    )  # fmt: skip
    lossy, plant = swing(loose.t_s, loose.pose[:, 4]), swing(course.t_s, course.pose[:, 4])
    assert lossy < plant < swing(firm.t_s, firm.pose[:, 4])


def test_a_wheel_of_no_radius_is_a_point_and_a_small_one_pays_out_to_first_order() -> None:
    base, start = np.array([1.8, 1.6, 1.4]), np.array([0.1, 0.1, -0.1])
    length, *direction = straight(start, base)
    rise = np.arcsin(direction[2])
    for radius in (1e-9, 1e-3):
        path = wrapped(start, base, radius)[0]
        first_order = length + radius * (np.pi / 2.0 + rise - np.cos(rise))
        assert path == pytest.approx(first_order, abs=2.0 * radius**2 + 1e-14)


def test_the_force_on_a_wheel_pulls_along_the_shortening_path() -> None:
    base, start, step = np.array([1.8, 1.6, 1.4]), np.array([0.1, 0.1, -0.1]), 1e-6
    direction = np.array(wrapped(start, base, 0.05)[1:])
    slope = [
        (wrapped(start + step * e, base, 0.05)[0] - wrapped(start - step * e, base, 0.05)[0])
        / (2.0 * step)
        for e in np.eye(3)
    ]
    assert -direction == pytest.approx(np.array(slope), abs=1e-8)


def test_times_and_noise_do_not_tell_what_is_concealed(sound: Case) -> None:
    run = sound.runs[0]
    zero = Concealed(catalogue()["cell_zero"], 1.0, (1,), {})
    usual, changed = sound.made(run), sound.with_concealed(zero).made(run)
    assert np.array_equal(usual.tension_t_s, changed.tension_t_s)
    assert changed.tension_n - usual.tension_n == pytest.approx(
        np.tile([1.0, 0, 0, 0, 0, 0, 0, 0], (len(usual.tension_n), 1))
    )


def test_the_pose_noise_is_that_of_its_covariance(sound: Case) -> None:
    still = np.arange(0.0, 240.0, 0.05)
    course = Course(still, np.zeros((len(still), 8)), np.zeros((len(still), 6)))
    measured = measure(course, sound.sensing, Faults(), np.random.SeedSequence(6))
    root = np.linalg.cholesky(measured.covariance)
    white = np.linalg.solve(root, (measured.pose - course.pose[0])[:, :, None])[:, :, 0]
    assert np.cov(white.T) == pytest.approx(np.eye(6), abs=0.1)


def test_the_plant_imports_of_ours_the_ground_floor_alone() -> None:
    allowed = ("cdpr8", "analysis.challenge.plant")
    ours = ("analysis", "model", "rig", "vision")
    found = set()
    for path in Path(plant_package.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0
                found.add(str(node.module))
    assert not {
        name for name in found if name.split(".")[0] in ours and not name.startswith(allowed)
    }
