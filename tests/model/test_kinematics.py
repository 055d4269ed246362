import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from model import kinematics

angle = st.floats(-1.2, 1.2)
rate = st.floats(-5.0, 5.0)
metre = st.floats(-0.5, 0.5)
attitudes = st.tuples(angle, angle, angle)
rates = st.tuples(rate, rate, rate)
points = st.tuples(metre, metre, metre)
repeatable = settings(derandomize=True, deadline=None, max_examples=60)

BASE = (1.2, -1.4, 1.8)
DT = 1e-6


def turn(attitude):
    return np.array(kinematics.rotation(kinematics.trigonometry(attitude)))


def after(values, change, dt):
    return tuple(np.asarray(values) + dt * np.asarray(change))


@repeatable
@given(attitudes)
def test_rotation_is_yaw_after_pitch_after_roll(attitude) -> None:
    expected = Rotation.from_euler("ZYX", attitude[::-1]).as_matrix()
    assert turn(attitude) == pytest.approx(expected, abs=1e-12)


@repeatable
@given(attitudes, rates)
def test_h_turns_angle_rates_into_the_velocity_of_the_rotation(attitude, change) -> None:
    # Eq. 11: R' = omega x R, against finite differences of R.
    difference = turn(after(attitude, change, DT)) - turn(after(attitude, change, -DT))
    tilde = difference / (2 * DT) @ turn(attitude).T
    omega = kinematics.angular_velocity(kinematics.trigonometry(attitude), change)
    assert omega == pytest.approx((tilde[2, 1], tilde[0, 2], tilde[1, 0]), abs=1e-7)


@repeatable
@given(attitudes, rates)
def test_the_inverse_of_h_undoes_it(attitude, change) -> None:
    angles = kinematics.trigonometry(attitude)
    omega = kinematics.angular_velocity(angles, change)
    assert kinematics.rates_of(angles, omega) == pytest.approx(change, abs=1e-11)


@repeatable
@given(attitudes, rates)
def test_the_drift_is_the_derivative_of_h(attitude, change) -> None:
    def omega(dt):
        angles = kinematics.trigonometry(after(attitude, change, dt))
        return np.array(kinematics.angular_velocity(angles, change))

    drift = kinematics.angular_velocity_drift(kinematics.trigonometry(attitude), change)
    assert drift == pytest.approx((omega(DT) - omega(-DT)) / (2 * DT), abs=1e-6)


@repeatable
@given(points, attitudes, rates, rates, points)
def test_the_length_changes_as_finite_differences_say(
    position, attitude, velocity, change, anchor
) -> None:
    def line(dt):
        arm = tuple(turn(after(attitude, change, dt)) @ anchor)
        return kinematics.cable_line(BASE, after(position, velocity, dt), arm), arm

    (length, direction), arm = line(0.0)
    omega = kinematics.angular_velocity(kinematics.trigonometry(attitude), change)
    found = kinematics.length_rate(direction, arm, velocity, omega)
    expected = (line(DT)[0][0] - line(-DT)[0][0]) / (2 * DT)
    assert found == pytest.approx(expected, abs=1e-7)
    assert np.linalg.norm(direction) == pytest.approx(1.0)
    reached = np.asarray(position) + arm + length * np.asarray(direction)
    assert reached == pytest.approx(BASE), "u_i points from anchor to base"


def test_moving_towards_the_base_shortens_the_cable() -> None:
    _, direction = kinematics.cable_line(BASE, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    still = (0.0, 0.0, 0.0)
    assert kinematics.length_rate(direction, still, BASE, still) < 0


@repeatable
@given(attitudes, points)
def test_turning_back_undoes_turning(attitude, point) -> None:
    matrix = kinematics.rotation(kinematics.trigonometry(attitude))
    there = kinematics.transform(matrix, point)
    assert kinematics.transform_back(matrix, there) == pytest.approx(point, abs=1e-14)
