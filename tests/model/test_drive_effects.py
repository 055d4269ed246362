"""What a drive makes of a command: larger, faster, later, turned, distorted, loose."""

from dataclasses import replace

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import Task
from model.effects import ActiveEffect
from model.motion import RampedSine


def test_the_drive_may_be_larger_faster_later_distorted_and_loose(rig: Rig) -> None:
    course = RampedSine.from_excitation(Excitation(rest_s=0.5, motion_s=4.0, ramp_s=0.5))
    time_s = np.linspace(1.2, 3.8, 2000)
    pose = course.at(time_s)[0][:, 4]

    def driven(name: str, **values: float) -> np.ndarray:
        task = Task(rig, motion=course, effects=[ActiveEffect(name, values)])
        return task.driven.at(time_s)[0][:, 4]

    assert driven("drive_amplitude", amplitude_share=0.1) == pytest.approx(1.1 * pose)
    late = course.at(time_s - 0.02)[0][:, 4]
    assert driven("drive_phase", late_s=0.02) == pytest.approx(late)
    fast = course.at(0.5 + 1.01 * (time_s - 0.5))[0][:, 4]
    assert driven("drive_frequency", frequency_share=0.01) == pytest.approx(fast)
    added = driven("drive_harmonic", harmonic_share=0.1, order=3.0) - pose
    assert np.abs(added).max() == pytest.approx(np.deg2rad(0.2), rel=0.01)
    loose = driven("drive_backlash", backlash_deg=0.2)
    assert np.abs(loose).max() == pytest.approx(np.deg2rad(1.8), rel=0.03)
    assert np.abs(loose - pose).max() <= np.deg2rad(0.2) * 1.001


def test_a_tone_may_be_off_while_its_ramps_last_as_commanded(rig: Rig) -> None:
    course = RampedSine.from_excitation(Excitation(rest_s=0.5, motion_s=4.0, ramp_s=0.5))
    time_s = np.linspace(0.0, course.duration_s, 3000)
    other = replace(course, frequency_hz=1.01 * course.frequency_hz)
    slow = {"frequency_share": 0.01, "ramps_kept_share": 1.0}
    for beside in ([], [ActiveEffect("drive_backlash", {"backlash_deg": 0.2})]):
        tuned = Task(rig, motion=course, effects=[*beside, ActiveEffect("drive_frequency", slow)])
        plain = Task(rig, motion=other, effects=beside)
        assert tuned.driven.at(time_s)[0] == pytest.approx(plain.driven.at(time_s)[0], abs=1e-9)


def test_a_phase_turns_the_sine_and_leaves_its_ramps(rig: Rig) -> None:
    asked = Excitation(rest_s=0.5, motion_s=4.0, ramp_s=0.5, frequency_hz=1.03)
    course = RampedSine.from_excitation(asked)
    values = {"late_s": 0.02, "phase_share": 1.0}
    for beside in ([], [ActiveEffect("drive_backlash", {"backlash_deg": 0.2})]):
        acting = [ActiveEffect("drive_phase", values), *beside]
        driven = Task(rig, motion=course, effects=acting).driven
        # By 0.02 s at 2.06 Hz: by twice as long at half of that.
        back = replace(course, phase_rad=-2.0 * np.pi * 2.06 * 0.02)
        plain = Task(rig, motion=back, effects=beside).driven
        time_s = np.linspace(0.0, course.duration_s, 3000)
        assert driven.at(time_s)[0] == pytest.approx(plain.at(time_s)[0], abs=1e-12)
    assert driven.start_s == course.start_s


def test_a_gear_with_play_stands_until_the_other_flank_is_reached(rig: Rig) -> None:
    course = RampedSine.from_excitation(Excitation(rest_s=0.0, motion_s=3.0, ramp_s=0.5))
    quick = {"backlash_deg": 0.2, "servo_s": 2e-3}
    loose = Task(rig, motion=course, effects=[ActiveEffect("drive_backlash", quick)]).driven
    time_s = np.linspace(1.0, 2.0, 4001)
    angle = np.rad2deg(loose.at(time_s)[0][:, 4])
    stands = np.abs(loose.at(time_s)[1][:, 4]) < 0.5 * np.abs(course.at(time_s)[1][:, 4])
    # It goes on where the drive is 0.4 deg back from its peak of 2 deg: twice in each cycle.
    a_way = np.arccos(1.0 - 0.4 / 2.0) / np.pi
    assert stands.mean() == pytest.approx(a_way, abs=0.03)
    assert np.abs(angle[stands]) == pytest.approx(1.8, abs=0.02)


def test_a_servo_of_second_order_smooths_late_what_play_takes(rig: Rig) -> None:
    """The Gaussian, late, and the filter itself, up to the platform's tones."""
    from scipy.signal import bilinear, lfilter

    course = RampedSine.from_excitation(Excitation(rest_s=0.5, motion_s=3.0, ramp_s=0.5))
    turns, damping, most = 2.0 * np.pi * 30.0, 0.8, np.deg2rad(0.2)
    quick = {
        "backlash_deg": 0.2,
        "servo_s": np.sqrt(4.0 * damping**2 - 2.0) / turns,
        "servo_late_s": 2.0 * damping / turns,
    }
    loose = Task(rig, motion=course, effects=[ActiveEffect("drive_backlash", quick)]).driven
    time_s = np.arange(0.0, 3.5, 1e-4)
    angle = course.at(time_s)[0][:, 4]
    held = np.zeros_like(angle)
    for i in range(1, len(angle)):
        held[i] = np.clip(held[i - 1], angle[i] - most, angle[i] + most)
    filtered = bilinear([turns**2], [1.0, 2.0 * damping * turns, turns**2], fs=1e4)
    expected = lfilter(*filtered, held - angle)
    found = loose.at(time_s)[0][:, 4] - angle
    assert np.abs(found - expected).max() < 0.05 * most
    early = Task(
        rig, motion=course, effects=[ActiveEffect("drive_backlash", {**quick, "servo_late_s": 0.0})]
    ).driven
    assert np.abs(early.at(time_s)[0][:, 4] - angle - expected).max() > 0.1 * most


def test_backlash_moves_as_its_rates_say(rig: Rig) -> None:
    course = RampedSine.from_excitation(Excitation(rest_s=0.0, motion_s=2.0, ramp_s=0.5))
    loose = Task(rig, motion=course, effects=[ActiveEffect("drive_backlash")]).driven
    time_s = np.linspace(0.6, 1.4, 4001)
    pose, rate, acceleration = (values[:, 4] for values in loose.at(time_s))
    assert np.gradient(pose, time_s)[1:-1] == pytest.approx(rate[1:-1], abs=2e-2 * rate.max())
    jumps = np.gradient(rate, time_s)[1:-1] - acceleration[1:-1]
    assert np.median(np.abs(jumps)) < 1e-2 * np.abs(acceleration).max()
