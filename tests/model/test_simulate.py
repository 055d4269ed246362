import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from cdpr8.errors import UsageError
from cdpr8.rigfile import Excitation, Rig
from cdpr8.rigfile.parameter import Scalar
from model import Disturbance, Simulation, Strings, Task, simulate
from model.check import free_energy, step_halving
from model.simulator import run

MIRRORED_CABLES = [1, 0, 3, 2, 7, 6, 5, 4]
MIRRORED_POSE = np.array([1, -1, 1, -1, 1, -1])

SHORT = Excitation(rest_s=0.3, motion_s=1.0, ramp_s=0.2)


def test_rest_is_still_and_the_disturbances_act_when_the_motion_starts(rig: Rig) -> None:
    run = simulate(rig, SHORT)
    before, start = run.t_s < 0.3 - 1e-9, np.argmin(np.abs(run.t_s - 0.3))
    assert np.abs(run.pose[before]).max() < 1e-13
    assert not run.cable_offset_m[before].any()
    assert run.pose[start, 0] == pytest.approx(1e-4, rel=1e-9)
    assert run.cable_offset_m[start] == pytest.approx(np.full(8, 1e-4))
    assert run.rest_tension_n == pytest.approx(
        [cable.pretension_n.value for cable in rig.cable], abs=1e-9
    )


def test_the_paper_case_starts_in_the_commanded_state(paper_run: Simulation) -> None:
    full_rate = np.deg2rad(2.0) * 2 * np.pi * 2.06
    assert paper_run.pose[0].tolist() == [1e-4, 0, 0, 0, 0, 0]
    assert paper_run.pose_rate[0] == pytest.approx([0, 0, 0, 0, full_rate, 0])


def test_cables_that_are_other_strings_are_those_of_another_rig_file(rig: Rig) -> None:
    struck = Disturbance(cable_offset_m=2e-3)
    heavier = tuple(0.01 * number for number in range(8))
    found = run(Task(rig, SHORT, disturbance=struck, strings=Strings(heavier, -0.5)))
    cables = tuple(
        cable.model_copy(
            update={
                "line_density_kg_per_m": scaled(cable.line_density_kg_per_m, 1.0 + share),
                "damping_1_per_s": scaled(cable.damping_1_per_s, 0.5),
            }
        )
        for cable, share in zip(rig.cable, heavier, strict=True)
    )
    other = simulate(rig.model_copy(update={"cable": cables}), SHORT, disturbance=struck)
    assert found.cable_offset_m == pytest.approx(other.cable_offset_m, abs=1e-12)
    plain = simulate(rig, SHORT, disturbance=struck)
    assert np.abs(found.cable_offset_m - plain.cable_offset_m).max() > 1e-4
    light = Task(rig, strings=Strings(density_share=-2.0)).machine.line_density
    assert np.all(light > 0.0)


def scaled(row: Scalar, factor: float) -> Scalar:
    return row.model_copy(update={"value": factor * row.value})


def test_every_cable_may_have_its_own_offset(rig: Rig) -> None:
    offsets = tuple(1e-5 * number for number in range(1, 9))
    run = simulate(rig, SHORT, disturbance=Disturbance(cable_offset_m=offsets))
    start = np.argmin(np.abs(run.t_s - 0.3))
    assert run.cable_offset_m[start] == pytest.approx(offsets)


def test_a_motion_that_starts_between_two_outputs_is_only_shifted(rig: Rig) -> None:
    shift = 0.00037
    on = simulate(rig, SHORT.model_copy(update={"motion_start_s": 0.3}), output_rate_hz=1e3)
    off = simulate(rig, SHORT.model_copy(update={"motion_start_s": 0.3 + shift}))
    moving = slice(301, 1300)
    moved = CubicSpline(on.t_s[moving], on.pose[moving])(off.t_s[400:1200] - shift)
    assert off.pose[400:1200] == pytest.approx(moved, abs=1e-8)


def test_left_and_right_are_mirror_images(rig: Rig) -> None:
    def run(sideways: float) -> Simulation:
        offset = Disturbance((1e-4, sideways, 2e-4), 1e-4)
        return simulate(rig, SHORT, disturbance=offset)

    left, right = run(3e-4), run(-3e-4)
    assert np.abs(left.pose[:, 1]).max() > 1e-4
    assert left.pose == pytest.approx(right.pose * MIRRORED_POSE, abs=1e-12)
    assert left.tension_n == pytest.approx(right.tension_n[:, MIRRORED_CABLES], abs=1e-9)
    assert left.cable_offset_m == pytest.approx(right.cable_offset_m[:, MIRRORED_CABLES], abs=1e-12)


def test_rk4_at_the_papers_step_agrees_with_dop853(
    rig: Rig, paper: Excitation, paper_run: Simulation
) -> None:
    other = simulate(rig, paper, method="rk4")
    assert other.stats.longest_step_s == pytest.approx(1e-4)
    assert other.stats.derivatives == 4 * other.stats.steps == 400_000
    assert np.abs(other.pose - paper_run.pose).max() < 1e-8
    assert np.abs(other.cable_offset_m - paper_run.cable_offset_m).max() < 1e-5 * 1e-4
    assert np.abs(other.tension_n - paper_run.tension_n).max() < 1e-6


@pytest.mark.parametrize("method", ["dop853", "rk4"])
def test_free_vibration_keeps_its_energy_for_10_s(rig: Rig, method: str) -> None:
    check = free_energy(rig, method=method)
    assert check.tolerance == 1e-6
    assert check.passed, check.sentence()


def test_a_step_that_is_too_long_fails_both_checks(rig: Rig) -> None:
    how = {"output_rate_hz": 25.0, "method": "rk4"}
    coarse = simulate(rig, SHORT, step_s=0.02, **how)
    assert not step_halving(rig, coarse, SHORT, **how).passed
    assert not free_energy(rig, method="rk4", step_s=0.005).passed


def test_halving_the_step_changes_nothing_that_counts(rig: Rig) -> None:
    check = step_halving(rig, simulate(rig, SHORT), SHORT)
    assert check.passed, check.sentence()
    assert check.value > 0.0, "the finer run took other steps"


def test_a_slack_cable_is_a_status_with_its_number_and_time(rig: Rig) -> None:
    run = simulate(rig, SHORT.model_copy(update={"amplitude_deg": 6.0}))
    outcome = run.outcome
    assert outcome.status == "slack"
    assert outcome.cable is not None
    assert outcome.time_s is not None
    slack = run.tension_n[:, outcome.cable - 1] == 0.0
    assert run.t_s[slack][0] == pytest.approx(outcome.time_s, abs=1e-9)
    assert 0.0 < outcome.slack_share < 1.0
    assert f"cable {outcome.cable}" in outcome.sentence()
    assert run.tension_n.min() == 0.0
    assert np.isfinite(run.pose).all()
    assert len(run.t_s) == 1601


def test_a_cable_that_gains_energy_blows_up_and_the_run_ends_there(rig: Rig) -> None:
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
    run = simulate(faulty, SHORT)
    assert run.outcome.status == "blow_up"
    assert run.outcome.time_s is not None
    assert run.t_s[-1] < run.outcome.time_s < SHORT.end_s
    for values in (run.pose, run.pose_rate, run.tension_n, run.cable_offset_m):
        assert len(values) == len(run.t_s)
        assert np.isfinite(values).all()


def test_an_unstable_step_is_a_blow_up_and_not_a_nan(rig: Rig) -> None:
    run = simulate(rig, SHORT, method="rk4", step_s=0.2, output_rate_hz=5.0)
    assert run.outcome.status == "blow_up"
    assert np.isfinite(run.pose).all()


def test_a_rig_with_fast_cables_takes_more_steps(rig: Rig) -> None:
    thin = tuple(
        cable.model_copy(
            update={
                "line_density_kg_per_m": cable.line_density_kg_per_m.model_copy(
                    update={"value": 9e-7}
                )
            }
        )
        for cable in rig.cable
    )
    run = simulate(rig.model_copy(update={"cable": thin}), SHORT)
    assert run.stats.longest_step_s == pytest.approx(1e-3 / 8)
    assert len(run.t_s) == 1601


def test_the_table_has_the_names_and_units_of_the_edge(rig: Rig) -> None:
    run = simulate(rig, SHORT)
    frame = run.to_frame()
    assert [*frame.columns[:7]] == ["t_s", "x_m", "y_m", "z_m", "roll_deg", "pitch_deg", "yaw_deg"]
    assert frame["pitch_deg"].to_numpy() == pytest.approx(np.rad2deg(run.pose[:, 4]))
    assert frame["tension_7_n"].to_numpy() == pytest.approx(run.tension_n[:, 6])
    assert frame["cable_8_m"].to_numpy() == pytest.approx(run.cable_offset_m[:, 7])
    assert len(frame) == len(run.t_s) == 1601


def test_axial_velocity_is_the_rate_of_the_length(rig: Rig) -> None:
    run = simulate(rig, SHORT, output_rate_hz=2000.0)
    rate = np.gradient(run.elongation_m, run.t_s, axis=0)
    beside_the_jump = slice(604, -1)
    rate = rate[beside_the_jump]
    assert run.axial_velocity_m_per_s[beside_the_jump] == pytest.approx(rate, abs=1e-4)
    assert np.abs(rate).max() > 0.02


def test_a_result_says_what_it_came_from(rig: Rig) -> None:
    provenance = simulate(rig, SHORT).provenance
    assert provenance["rig"] == rig.name
    assert provenance["excitation"]["motion_s"] == 1.0
    assert {"numba", "numpy"} <= set(provenance["versions"])
    other = rig.model_copy(update={"name": "another"})
    assert simulate(other, SHORT).provenance["rig_sha256"] != provenance["rig_sha256"]


def test_the_same_question_gets_the_same_answer_to_the_bit(rig: Rig) -> None:
    first, second = simulate(rig, SHORT), simulate(rig, SHORT)
    assert np.array_equal(first.pose, second.pose)
    assert np.array_equal(first.tension_n, second.tension_n)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"method": "euler"}, "dop853, dp5, rk4"),
        ({"output_rate_hz": 0.0}, "above 0"),
        ({"step_s": -1.0}, "above 0"),
        ({"step_s": 1e-9}, "steps"),
        ({"output_rate_hz": 0.1}, "output rate"),
    ],
)
def test_a_wrong_argument_says_what_is_allowed(rig: Rig, wrong: dict, says: str) -> None:
    with pytest.raises(UsageError) as caught:
        simulate(rig, SHORT, **wrong)
    assert says in caught.value.sentence()
