"""Where the system's own ring is seen."""

import numpy as np
import pytest

from analysis.engine import Bundle, Segment
from analysis.engine.tones import rings

DRIVE_HZ, TONE_HZ, RATE_HZ = 2.06, 13.4, 16.0
"""A camera sees the tone at 16 - 13.4 = 2.6 Hz, which may be half a hertz off."""

STEADY = Segment(2.0, 6.0, DRIVE_HZ)
T_S = np.arange(0.0, 8.0, 1.0 / RATE_HZ)


def bundle(*tones_hz: float) -> Bundle:
    """Poses of a machine with such tones."""
    value = np.zeros((len(T_S), 1))
    return Bundle(("x",), ("m",), T_S, value, np.eye(1), (STEADY,), tones_hz=tones_hz)


@pytest.mark.parametrize(
    ("line_hz", "order", "is_seen"),
    [
        (DRIVE_HZ, 0, False),  # driven, whatever leaks there
        (DRIVE_HZ, 1, True),  # its slow change may be the ring alone
        (2.3, 0, True),
        (3.5, 0, False),
        (0.0, 0, False),
    ],
)
def test_a_tone_faster_than_the_camera_is_seen_elsewhere_but_for_the_drive_s_line(
    line_hz: float, order: int, is_seen: bool
) -> None:
    assert rings(line_hz, order, STEADY, bundle(TONE_HZ)) is is_seen


@pytest.mark.parametrize("tone_hz", [2.2, 1.9])
def test_where_a_tone_is_driven_nothing_but_means_is_foretold(tone_hz: float) -> None:
    assert rings(DRIVE_HZ, 0, STEADY, bundle(tone_hz))
    assert not rings(0.0, 0, STEADY, bundle(tone_hz))
