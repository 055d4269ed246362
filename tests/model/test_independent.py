"""Agreement with SciPy on the paper's equations written a second time, by other means.

Rotations are products of three elementary matrices, the platform turns by Euler's equations in its
own frame, all cables go together as arrays, and the drive comes out of the same function backwards.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from cdpr8.rigfile import Excitation, Rig
from model import Machine, Simulation
from model.kernel import derivative

GRAVITY = 9.80665


def _turn(roll, pitch, yaw):
    c, s = math.cos, math.sin
    about_x = np.array([[1, 0, 0], [0, c(roll), -s(roll)], [0, s(roll), c(roll)]])
    about_y = np.array([[c(pitch), 0, s(pitch)], [0, 1, 0], [-s(pitch), 0, c(pitch)]])
    about_z = np.array([[c(yaw), -s(yaw), 0], [s(yaw), c(yaw), 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def _body_rates(roll, pitch):
    """E: angular velocity in the platform frame = E [roll', pitch', yaw']."""
    return np.array(
        [
            [1, 0, -math.sin(pitch)],
            [0, math.cos(roll), math.sin(roll) * math.cos(pitch)],
            [0, -math.sin(roll), math.cos(roll) * math.cos(pitch)],
        ]
    )


def _body_rates_change(roll, pitch, roll_rate, pitch_rate):
    """E' by the chain rule."""
    by_roll = np.array(
        [
            [0, 0, 0],
            [0, -math.sin(roll), math.cos(roll) * math.cos(pitch)],
            [0, -math.cos(roll), -math.sin(roll) * math.cos(pitch)],
        ]
    )
    by_pitch = np.array(
        [
            [0, 0, -math.cos(pitch)],
            [0, 0, -math.sin(roll) * math.sin(pitch)],
            [0, 0, -math.cos(roll) * math.sin(pitch)],
        ]
    )
    return by_roll * roll_rate + by_pitch * pitch_rate


def _crossed(vector):
    """The matrix that takes b to vector x b; `np.cross` takes ten times as long."""
    x, y, z = vector
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


class Robot:
    def __init__(self, rig: Rig) -> None:
        cables = rig.cable
        self.mass = rig.platform.mass_kg.value
        self.inertia = np.diag(rig.platform.inertia_kg_m2.value)
        self.base = np.array([cable.base_m.value for cable in cables])
        centre = np.array(rig.platform.centre_of_mass_m.value)
        self.anchor = np.array([cable.anchor_m.value for cable in cables]) - centre
        self.stiffness = np.array([cable.stiffness_n_per_m.value for cable in cables])
        self.pretension = np.array([cable.pretension_n.value for cable in cables])
        self.line_density = np.array([cable.line_density_kg_per_m.value for cable in cables])
        self.damping = np.array([cable.damping_1_per_s.value for cable in cables])
        self.rest_length = np.linalg.norm(self.base - self.anchor, axis=1)

    def cables(self, pose, rate, mid_span):
        """Tension, dL/dt, length and the wrench of the cables about the centre of mass."""
        turn = _turn(*pose[3:])
        arms = self.anchor @ turn.T
        lines = self.base - pose[:3] - arms
        length = np.sqrt(np.sum(lines**2, axis=1))
        unit = lines / length[:, None]
        omega = turn @ _body_rates(*pose[3:5]) @ rate[3:]
        anchor_velocity = rate[:3] + arms @ _crossed(omega).T
        length_rate = -np.sum(unit * anchor_velocity, axis=1)
        extension = np.pi**2 * mid_span**2 / (4 * length)
        tension = self.pretension + self.stiffness * (length - self.rest_length + extension)
        tension = np.where(tension > 0, tension, 0)
        pulls = tension[:, None] * unit
        twice = arms.T @ pulls
        twice = twice - twice.T
        wrench = np.array([*pulls.sum(axis=0), twice[1, 2], twice[2, 0], twice[0, 1]])
        return tension, length_rate, length, wrench

    def drive(self, pose, rate, acceleration):
        """The wrench that gives the platform on its elastic cables this acceleration."""
        roll, pitch = pose[3:5]
        turn = _turn(*pose[3:])
        spin = _body_rates(roll, pitch) @ rate[3:]
        spin_change = _body_rates(roll, pitch) @ acceleration[3:]
        spin_change = spin_change + _body_rates_change(roll, pitch, *rate[3:5]) @ rate[3:]
        moment = self.inertia @ spin_change + _crossed(spin) @ self.inertia @ spin
        needed = np.concatenate([self.mass * acceleration[:3], turn @ moment])
        needed[2] += self.mass * GRAVITY
        return needed - self.cables(pose, rate, np.zeros(8))[3]

    def right_hand_side(self, commanded: Callable) -> Callable:
        """State (28,): pose, its rate, X_w, X_w'; `commanded(t)` gives X*, X*', X*''."""

        def derivative(time_s, state):
            pose, rate, mid_span, mid_span_rate = np.split(state, [6, 12, 20])
            tension, length_rate, length, wrench = self.cables(pose, rate, mid_span)
            wrench = wrench + self.drive(*commanded(time_s))
            wrench[2] -= self.mass * GRAVITY
            roll, pitch = pose[3:5]
            to_spin = _body_rates(roll, pitch)
            spin = to_spin @ rate[3:]
            moment = _turn(*pose[3:]).T @ wrench[3:] - _crossed(spin) @ self.inertia @ spin
            spin_change = moment / np.diag(self.inertia)
            turning = np.linalg.solve(
                to_spin,
                spin_change - _body_rates_change(roll, pitch, *rate[3:5]) @ rate[3:],
            )
            square = (np.pi / length) ** 2 * (tension / self.line_density - length_rate**2)
            vibration = -self.damping * mid_span_rate - square * mid_span
            return np.concatenate([rate, wrench[:3] / self.mass, turning, mid_span_rate, vibration])

        return derivative


@pytest.mark.parametrize("seconds", [3.0, pytest.param(10.0, marks=pytest.mark.slow)])
def test_the_paper_case_agrees_with_scipy(
    rig: Rig, paper: Excitation, paper_run: Simulation, seconds: float
) -> None:
    amplitude = np.deg2rad(paper.amplitude_deg)
    circular = 2 * np.pi * paper.frequency_hz

    def commanded(time_s):
        pose, rate, acceleration = np.zeros((3, 6))
        pose[4] = amplitude * np.sin(circular * time_s)
        rate[4] = amplitude * circular * np.cos(circular * time_s)
        acceleration[4] = -amplitude * circular**2 * np.sin(circular * time_s)
        return pose, rate, acceleration

    robot = Robot(rig)
    start = np.zeros(28)
    start[0], start[10], start[12:20] = 1e-4, amplitude * circular, 1e-4
    rows = np.flatnonzero(paper_run.t_s <= seconds)[::20]
    solution = solve_ivp(
        robot.right_hand_side(commanded),
        (0.0, seconds),
        start,
        method="DOP853",
        rtol=1e-10,
        atol=1e-11,
        t_eval=paper_run.t_s[rows],
    )
    assert solution.success
    states = solution.y.T
    tension = np.array([robot.cables(s[:6], s[6:12], s[12:20])[0] for s in states])
    for ours, theirs in (
        (paper_run.pose[rows, :3], states[:, 0:3]),
        (paper_run.pose[rows, 3:], states[:, 3:6]),
        (paper_run.cable_offset_m[rows], states[:, 12:20]),
        (paper_run.tension_variation_n[rows], tension - robot.pretension),
    ):
        assert np.abs(ours - theirs).max() < 1e-6 * np.abs(theirs).max()


def test_a_tumbling_platform_agrees_with_scipy(rig: Rig) -> None:
    # Every axis at once and large, so that each term of W_C and of H' counts.
    robot = Robot(rig)
    still = (np.zeros(6), np.zeros(6), np.zeros(6))
    theirs = robot.right_hand_side(lambda _: still)
    drive = robot.drive(*still)
    random = np.random.default_rng(20230728)
    for _ in range(20):
        state = random.normal(size=28) * np.repeat([0.05, 0.4, 0.5, 2.0, 0.02], [3, 3, 3, 3, 16])
        ours = np.empty(28)
        derivative(state, drive, Machine.from_rig(rig).plant(), None, ours)
        assert ours == pytest.approx(theirs(0.0, state), rel=1e-9, abs=1e-9)
