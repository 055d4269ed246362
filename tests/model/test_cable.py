import numpy as np
import pytest
from scipy.integrate import quad

from model import cable


def test_vibration_lengthens_the_cable_by_its_arc() -> None:
    length, mid_span = 3.0, 0.02
    arc, _ = quad(
        lambda y: np.hypot(1.0, mid_span * np.pi / length * np.cos(np.pi * y / length)), 0.0, length
    )
    assert cable.vibration_extension(mid_span, length) == pytest.approx(arc - length, rel=1e-3)


def test_tension_is_pretension_plus_elongation_plus_vibration() -> None:
    at_rest = cable.tension(10.0, 1500.0, 0.0, 0.0, 3.0)
    stretched = cable.tension(10.0, 1500.0, 0.002, 0.0, 3.0)
    shaken = cable.tension(10.0, 1500.0, 0.0, 0.05, 3.0)
    assert at_rest == 10.0
    assert stretched == pytest.approx(13.0)
    assert shaken == pytest.approx(10.0 + 1500.0 * np.pi**2 * 0.05**2 / 12.0)


def test_a_cable_cannot_push() -> None:
    assert cable.tension(10.0, 1500.0, -0.02, 0.0, 3.0) == 0.0


def test_a_still_cable_swings_at_its_own_tone() -> None:
    tension, line_density, length = 12.0, 0.009, 3.0
    pull = cable.transverse_acceleration(1e-3, 0.0, tension, 0.0, length, line_density, 0.0)
    assert np.sqrt(-pull / 1e-3) / (2 * np.pi) == pytest.approx(
        cable.tone_hz(tension, line_density, length)
    )


def test_a_slack_cable_has_no_tone() -> None:
    assert list(cable.tone_hz(np.array([-3.0, 0.0]), 0.009, 3.0)) == [0.0, 0.0]


def test_running_along_lowers_the_tone_and_damping_opposes_the_motion() -> None:
    still = cable.transverse_acceleration(1e-3, 0.0, 12.0, 0.0, 3.0, 0.009, 4.0)
    running = cable.transverse_acceleration(1e-3, 0.0, 12.0, -5.0, 3.0, 0.009, 4.0)
    damped = cable.transverse_acceleration(0.0, 0.1, 12.0, 0.0, 3.0, 0.009, 4.0)
    assert still < running < 0
    assert damped == pytest.approx(-0.4)
