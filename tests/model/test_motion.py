import numpy as np
import pytest

from cdpr8.rigfile import Excitation
from model.motion import RampedSine
from model.steps import divide

RECORDED = RampedSine.from_excitation(Excitation(rest_s=1.0, motion_s=8.0, ramp_s=0.5))
OTHERS = [
    RampedSine.from_excitation(
        Excitation(rest_s=1.0, motion_s=8.0, ramp_s=0.5, ramp=ramp, ending=ending)
    )
    for ramp, ending in [
        ("raised_cosine", "ramp_within"),
        ("cubic", "ramp_beyond"),
        ("septic", "at_once"),
    ]
]
AT_ONCE = RampedSine.from_excitation(Excitation(rest_s=1.0, motion_s=8.0, ramp_s=0.0))


@pytest.mark.parametrize("motion", [RECORDED, AT_ONCE, *OTHERS])
def test_rates_and_accelerations_are_derivatives(motion: RampedSine) -> None:
    time_s = np.linspace(0.01, 9.9, 4001)
    time_s = time_s[np.abs(time_s[:, None] - motion.breaks_s).min(axis=1) > 1e-3]
    dt = 1e-5
    _, rate, acceleration = motion.at(time_s)
    (ahead, rate_ahead, _), (behind, rate_behind, _) = (
        motion.at(time_s + dt),
        motion.at(time_s - dt),
    )
    assert (ahead - behind) / (2 * dt) == pytest.approx(rate, abs=1e-6)
    assert (rate_ahead - rate_behind) / (2 * dt) == pytest.approx(acceleration, abs=1e-4)


@pytest.mark.parametrize("at_s", [1.0, 1.5, 8.5, 9.0])
def test_a_ramp_keeps_the_acceleration_continuous(at_s: float) -> None:
    for before, after in zip(
        RECORDED.at(np.array(at_s - 1e-9)), RECORDED.at(np.array(at_s + 1e-9)), strict=True
    ):
        assert before == pytest.approx(after, abs=1e-5)


@pytest.mark.parametrize("motion", OTHERS[:2])
def test_other_ramps_rise_and_fall_whole(motion: RampedSine) -> None:
    whole = np.deg2rad(2.0)
    first, last = motion.steady_window_s
    assert last == motion.end_s - 0.5
    for edge in (motion.start_s, motion.end_s):
        for values in motion.at(np.array([edge - 1e-7, edge + 1e-7]))[:2]:
            assert np.abs(values).max() < 1e-4
    angle, rate, _ = motion.at(np.array([first - 1e-9, first + 1e-9]))
    assert np.ptp(angle[:, 4]) < 1e-8 * whole + 1e-9
    assert np.ptp(rate[:, 4]) < 1e-6


def test_a_motion_that_ends_at_once_is_steady_to_its_end() -> None:
    motion = OTHERS[2]
    assert motion.steady_window_s == (1.5, 9.0)
    angle = motion.at(np.array(8.999))[0][4]
    assert angle == pytest.approx(np.deg2rad(2.0) * np.sin(2.0 * np.pi * 2.06 * 7.999))


def test_the_platform_rests_before_and_after_and_is_steady_between() -> None:
    for values in RECORDED.at(np.array([0.0, 0.999, 9.001, 10.0])):
        assert not values.any()
    time_s = np.linspace(*RECORDED.steady_window_s, 500)
    pitch = RECORDED.at(time_s)[0][:, 4]
    expected = np.deg2rad(2.0) * np.sin(2 * np.pi * 2.06 * (time_s - 1.0))
    assert pitch == pytest.approx(expected, abs=1e-15)


def test_without_a_ramp_the_motion_starts_at_full_speed() -> None:
    start, before = np.array(1.0), np.array(0.9)
    full = np.deg2rad(2.0) * 2 * np.pi * 2.06
    assert AT_ONCE.at(start)[1][4] == pytest.approx(full)
    assert AT_ONCE.at(start, within_s=before)[1][4] == 0.0


@pytest.mark.parametrize(("axis", "column"), [("roll", 3), ("pitch", 4), ("yaw", 5)])
def test_the_axis_is_the_one_named(axis: str, column: int) -> None:
    pose = RampedSine.from_excitation(Excitation(axis=axis)).at(np.array([3.1]))[0]
    assert np.flatnonzero(pose[0]).tolist() == [column]


def test_steps_meet_every_output_and_every_break() -> None:
    motion = RampedSine.from_excitation(
        Excitation(rest_s=1.0, motion_start_s=1.00037, motion_s=2.0, ramp_s=0.3)
    )
    steps = divide(motion, output_rate_hz=100.0, longest_step_s=1e-3)
    assert steps.output_s == pytest.approx(np.arange(401) / 100.0, abs=1e-12)
    for moment in motion.breaks_s:
        assert np.abs(steps.point_s - moment).min() < 1e-12
    assert steps.point_s[steps.jump_point] == pytest.approx(1.00037, abs=1e-12)
    assert steps.step_s.min() > 0
    assert steps.step_s.max() <= 1e-3 * (1 + 1e-9)
