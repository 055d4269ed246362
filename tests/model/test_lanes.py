"""Sixteen side by side: the same numbers as one by one, each lane its own."""

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import ActiveEffect, Task, jacobian, lanes, simulate, simulate_many
from model.lane_sine import sine_cosine
from model.library import lanes as layout
from model.simulator import run
from model.summary import summarise

SHORT = Excitation(rest_s=0.1, motion_s=0.8, ramp_s=0.1)


def with_mass(rig: Rig, factor: float) -> Rig:
    mass = rig.platform.mass_kg
    scaled = mass.model_copy(update={"value": factor * mass.value})
    return rig.model_copy(update={"platform": rig.platform.model_copy(update={"mass_kg": scaled})})


def test_the_kernels_slots_are_those_the_laws_are_written_for() -> None:
    assert lanes.LANES == layout.LANES
    assert layout.WORK["end"] * layout.LANES == lanes.WORK
    for name in set(layout.WORK) - {"end"}:
        assert getattr(lanes, name.upper()) == layout.WORK[name] * layout.LANES
    for name in ("base", "anchor", "rest_length", "stiffness", "pretension"):
        assert getattr(lanes, name.upper()) == layout.CABLE[name] * layout.LANES
    assert layout.PLATFORM["end"] * layout.LANES == lanes.PLATFORM


def test_sine_and_cosine_are_those_of_the_library() -> None:
    angles = np.linspace(-3.2, 3.2, 20001)
    sine, cosine = sine_cosine(angles)
    assert np.abs(sine - np.sin(angles)).max() < 3e-16
    assert np.abs(cosine - np.cos(angles)).max() < 3e-16


def test_lanes_of_many_kinds_are_what_each_is_alone(rig: Rig) -> None:
    tasks = [
        Task(
            with_mass(rig, 1.0 + 0.01 * n), SHORT.model_copy(update={"frequency_hz": 1.0 + 0.2 * n})
        )
        for n in range(20)
    ]
    tasks += [Task(rig, SHORT, drive="winch"), Task(rig, SHORT, nominal=with_mass(rig, 1.1))]
    tasks += [Task(rig, SHORT, effects=[ActiveEffect("cable_viscous", cables=(3,))])]
    for task, lane in zip(tasks, simulate_many(tasks), strict=True):
        alone = run(task)
        assert lane.pose == pytest.approx(alone.pose, abs=1e-10)
        assert lane.tension_n == pytest.approx(alone.tension_n, abs=1e-9)
        assert lane.cable_offset_m == pytest.approx(alone.cable_offset_m, abs=1e-12)
        assert lane.outcome == alone.outcome
        assert lane.stats.derivatives == alone.stats.derivatives
        assert lane.provenance == alone.provenance


def test_a_lane_that_blows_up_leaves_the_others_alone(rig: Rig) -> None:
    cable = rig.cable[2]
    gaining = cable.damping_1_per_s.model_copy(update={"value": -80.0})
    faulty = rig.model_copy(
        update={
            "cable": (
                *rig.cable[:2],
                cable.model_copy(update={"damping_1_per_s": gaining}),
                *rig.cable[3:],
            )
        }
    )
    bad, good = simulate_many([Task(faulty, SHORT), Task(rig, SHORT)])
    alone = simulate(faulty, SHORT)
    assert bad.outcome == alone.outcome
    assert bad.outcome.status == "blow_up"
    assert len(bad.t_s) == len(alone.t_s)
    assert np.isfinite(bad.pose).all()
    assert good.pose == pytest.approx(simulate(rig, SHORT).pose, abs=1e-10)


def test_results_are_reduced_where_they_are_made(rig: Rig) -> None:
    tasks = [Task(rig, SHORT.model_copy(update={"amplitude_deg": a})) for a in (1.0, 2.0)]
    kept = simulate_many(tasks, summarise)
    alone = [summarise(run(task)) for task in tasks]
    assert [one.max_pitch_deg for one in kept] == pytest.approx(
        [one.max_pitch_deg for one in alone], rel=1e-9
    )


def test_a_jacobian_by_lanes_is_that_of_single_runs(rig: Rig) -> None:
    def task_of(point: np.ndarray) -> Task:
        effects = [
            ActiveEffect("cable_viscous", {"viscous_n_s_per_m": float(point[0])}),
            ActiveEffect("stiffness", {"stiffness_share": float(point[1])}),
        ]
        return Task(rig, SHORT, effects=effects, nominal=rig)

    def output(simulation) -> np.ndarray:
        return np.concatenate([simulation.pose[::50, 4], simulation.tension_n[::50, 0]])

    point, step = np.array([4.0, 0.02]), np.array([1e-3, 1e-5])
    value, slope = jacobian(task_of, point, output, step)
    assert value == pytest.approx(output(run(task_of(point))), abs=1e-9)
    for column in range(2):
        far = np.eye(2)[column] * 30 * step
        plain = output(run(task_of(point + far))) - output(run(task_of(point - far)))
        expected = plain / (2 * 30 * step[column])
        assert slope[:, column] == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


def test_the_winch_pays_out_what_the_course_asks(rig: Rig) -> None:
    slow = Excitation(
        rest_s=0.3,
        motion_s=4.0,
        ramp_s=1.0,
        frequency_hz=0.5,
        drive="wrench",
        platform_offset_m=(0.0, 0.0, 0.0),
        cable_offset_m=0.0,
    )
    pulled, wound = simulate(rig, slow), simulate(rig, slow, drive="winch")
    # The platform follows either way, but winches need no more than the forces of inertia.
    assert np.abs(wound.pose[:, 4]).max() == pytest.approx(np.deg2rad(2.0), rel=0.1)
    assert np.abs(wound.tension_variation_n).max() < 0.2 * np.abs(pulled.tension_variation_n).max()
    assert np.abs(wound.pose[wound.t_s < 0.3]).max() < 1e-12
    assert wound.provenance["drive"] == "winch"


def test_few_tasks_run_one_by_one_with_the_same_result(rig: Rig) -> None:
    tasks = [Task(with_mass(rig, 1.0 + 0.01 * n), SHORT) for n in range(3)]
    side_by_side = simulate_many(tasks)
    for one, other in zip(simulate_many(tasks, fewest=4), side_by_side, strict=True):
        assert one.tension_n == pytest.approx(other.tension_n, abs=1e-9)
        assert one.stats.derivatives == other.stats.derivatives


def test_lanes_with_two_drives_among_them_each_follow_their_own(rig: Rig) -> None:
    late = ActiveEffect("drive_phase", {"late_s": 0.01})
    other = ActiveEffect("drive_amplitude", {"amplitude_share": 0.02})
    tasks = [Task(rig, SHORT, effects=[one] if one else []) for one in (None, other, None, other)]
    tasks += [Task(rig, SHORT, effects=[late])]
    for task, lane in zip(tasks, simulate_many(tasks), strict=True):
        assert lane.pose == pytest.approx(run(task).pose, abs=1e-10)


def test_a_pulley_is_pressed_by_what_acts_in_the_cable_in_both_kernels(rig: Rig) -> None:
    pressed = ActiveEffect("pulley_capstan", {"friction": 0.1, "loaded_share": 0.5})
    stiffer = ActiveEffect("cable_stiffening", {"cubic_n_per_m3": 5e8})
    tasks = [Task(rig, SHORT, effects=one) for one in ([pressed], [pressed, stiffer], [stiffer])]
    alone, both, without = simulate_many(tasks)
    for task, lane in zip(tasks, (alone, both, without), strict=True):
        assert lane.tension_n == pytest.approx(run(task).tension_n, abs=1e-7)
    apart = alone.tension_n - run(Task(rig, SHORT)).tension_n
    assert np.abs(both.tension_n - without.tension_n - apart).max() > 0.05


def test_lanes_are_disturbed_each_when_its_drive_is(rig: Rig) -> None:
    moved = SHORT.model_copy(update={"platform_offset_m": (1e-3, 0.0, 0.0), "rest_s": 0.2})
    late = [
        ActiveEffect("drive_phase", {"late_s": 0.05, "disturbed_late_share": share})
        for share in (0.0, 1.0)
    ]
    tasks = [Task(rig, moved, effects=[one]) for one in late]
    for task, lane, disturbed_s in zip(tasks, simulate_many(tasks), (0.2, 0.25), strict=True):
        offset_m = lane.pose[:, 0]
        assert np.abs(offset_m[lane.t_s < disturbed_s - 1e-6]).max() < 1e-12
        assert offset_m[lane.t_s > disturbed_s - 1e-6][0] == pytest.approx(1e-3, abs=1e-6)
        assert lane.pose == pytest.approx(run(task).pose, abs=1e-10)
