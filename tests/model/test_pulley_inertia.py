"""A pulley that has to be turned: at the end of the cable, or between two springs."""

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import ActiveEffect, Task, simulate_many
from model.effects import library
from model.simulator import run
from tests.model.harness import STIFFNESS, cable_response


def test_pulley_inertia_goes_with_the_acceleration() -> None:
    effect = library()["pulley_inertia"]
    slow, fast = cable_response(effect), cable_response(effect, frequency_hz=4.0)
    assert slow.in_phase[1] == pytest.approx(-0.05 * (4 * np.pi) ** 2 * 5e-3, rel=0.02)
    assert fast.in_phase[1] == pytest.approx(4 * slow.in_phase[1], rel=0.02)
    # A platform rings at some 10 Hz: what follows late there would damp it, or shake it.
    rung = cable_response(effect, frequency_hz=10.0)
    assert abs(rung.quadrature[1]) < 5e-3 * abs(rung.in_phase[1])


def test_a_rim_between_two_springs_is_newton_s() -> None:
    """T = k_f (x - s), m s'' = k_f (x - s) - k_b s - b m s', x as the cable is moved."""
    share, mass, bearing = 0.2, 0.5, 20.0
    values = {"equivalent_kg": mass, "front_share": share, "bearing_per_s": bearing, "grip_s": 1e-3}
    front, back = STIFFNESS / share, STIFFNESS / (1.0 - share)
    for hertz in (2.0, 8.0):
        answer = cable_response(
            library()["pulley_inertia"], values, frequency_hz=hertz, cycles=int(2.0 * hertz)
        )
        turn = 2.0j * np.pi * hertz
        rim = front / (mass * turn**2 + bearing * mass * turn + front + back)
        beyond = 5e-3 * (front * (1.0 - rim) - STIFFNESS)
        assert answer.in_phase[1] == pytest.approx(beyond.real, rel=0.02)
        assert answer.quadrature[1] == pytest.approx(beyond.imag, rel=0.05)


def test_a_platform_held_at_its_disturbance_has_taken_the_rims_along(rig: Rig) -> None:
    offset_m = np.array([1e-3, 0.0, 0.0])
    moved = Excitation(
        rest_s=0.2, motion_s=0.2, ramp_s=0.1, platform_offset_m=tuple(offset_m), cable_offset_m=0.0
    )
    plain = run(Task(rig, moved))
    after = int(np.argmax(plain.t_s > 0.2 - 1e-6))
    longer_m = plain.elongation_m[after]
    assert np.abs(longer_m).max() > 1e-4
    for share in (0.0, 0.5, 1.0):
        values = {"equivalent_kg": 0.05, "grip_s": 2e-3, "let_go_share": share}
        task = Task(rig, moved, effects=[ActiveEffect("pulley_inertia", values)])
        alone, lane = run(task), simulate_many([task])[0]
        dragged_n = (alone.tension_n - plain.tension_n)[after]
        behind_m = (1.0 - share) * longer_m
        assert dragged_n == pytest.approx(0.05 / 2e-3**2 * behind_m, abs=1e-6)
        assert lane.tension_n == pytest.approx(alone.tension_n, abs=1e-7)


def test_a_machine_that_begins_to_move_at_once_has_its_rims_moving(rig: Rig) -> None:
    """X*' jumps where there is no ramp: a rim that went along drags nothing then."""
    still = (0.0, 0.0, 0.0)
    at_once = Excitation(
        rest_s=0.2, motion_s=0.2, ramp_s=0.0, platform_offset_m=still, cable_offset_m=0.0
    )
    plain = run(Task(rig, at_once))
    after = int(np.argmax(plain.t_s > 0.2 - 1e-6))
    faster = np.gradient(plain.elongation_m[after : after + 5], plain.t_s[1], axis=0)[0]
    assert np.abs(faster).max() > 0.01
    for share in (0.0, 1.0):
        values = {"equivalent_kg": 0.05, "damping_ratio": 0.3, "let_go_share": share}
        task = Task(rig, at_once, effects=[ActiveEffect("pulley_inertia", values)])
        alone, lane = run(task), simulate_many([task])[0]
        dragged_n = (alone.tension_n - plain.tension_n)[after]
        behind = (1.0 - share) * faster
        assert dragged_n == pytest.approx(2.0 * 0.3 * 0.05 / 2e-3 * behind, abs=0.02)
        assert lane.tension_n == pytest.approx(alone.tension_n, abs=1e-7)
