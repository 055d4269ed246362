import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from model import kinematics, platform

MASS = 0.5
INERTIA = np.array([[0.020, 0.002, -0.001], [0.002, 0.013, 0.003], [-0.001, 0.003, 0.030]])
INVERSE = np.linalg.inv(INERTIA)

three = st.tuples(*[st.floats(-1.2, 1.2)] * 3)
repeatable = settings(derandomize=True, deadline=None, max_examples=60)


@repeatable
@given(three, three, three, three)
def test_the_required_wrench_gives_the_acceleration_it_was_asked_for(
    attitude, rates, linear, angular
) -> None:
    angles = kinematics.trigonometry(attitude)
    force, moment = platform.required_wrench(MASS, INERTIA, angles, rates, linear, angular)
    found = platform.acceleration(MASS, INERTIA, INVERSE, angles, rates, force, moment)
    assert found[0] == pytest.approx(linear, abs=1e-10)
    assert found[1] == pytest.approx(angular, abs=1e-10)


@repeatable
@given(three, three)
def test_a_body_left_alone_keeps_its_angular_momentum(attitude, rates) -> None:
    # W_C is right if R I R^T omega stands still in O-XYZ: against finite differences.
    nothing = (0.0, 0.0, 0.0)
    angles = kinematics.trigonometry(attitude)
    _, angular = platform.acceleration(MASS, INERTIA, INVERSE, angles, rates, nothing, nothing)
    dt = 1e-5

    def momentum(sign):
        h = sign * dt
        turned = np.asarray(attitude) + h * np.asarray(rates) + h**2 / 2 * np.asarray(angular)
        spinning = np.asarray(rates) + h * np.asarray(angular)
        there = kinematics.trigonometry(tuple(turned))
        omega = kinematics.angular_velocity(there, tuple(spinning))
        return np.array(platform.in_fixed_frame(kinematics.rotation(there), INERTIA, omega))

    assert (momentum(1) - momentum(-1)) / (2 * dt) == pytest.approx(np.zeros(3), abs=1e-7)
