"""What a simulated cell makes of a tension: repeatable noise, filter, averaging, its own clock."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rig.amplifier.profile import FIT
from rig.amplifier.scaling import Scaling
from rig.simulated.signal import Crystal, NodeSignal

SCALING = Scaling(50.0, 1.0, 1, 2_560_000)


def signal(
    noise_n: float = 0.005, *, step: bool = False, key: tuple[int, int] = (1, 1)
) -> NodeSignal:
    made = NodeSignal(
        (lambda t_s: 10.0 + 1.0 * (t_s > 0.0)) if step else (lambda t_s: 10.0 + 0.0 * t_s),
        SCALING,
        FIT,
        Crystal(ppm=30.0, phase=0.25),
        noise_n,
        key,
    )
    made.begin(1.0)
    return made


@settings(max_examples=25)
@given(st.lists(st.integers(0, 3000), min_size=1, max_size=30))
def test_a_value_depends_on_its_number_alone(numbers: list[int]) -> None:
    in_order, as_asked = signal(), signal()
    expected = [in_order.value(number, 0, 0) for number in range(3001)]
    assert [as_asked.value(number, 0, 0) for number in numbers] == [
        expected[number] for number in numbers
    ]


def test_the_noise_is_that_of_the_rig_file_and_differs_between_nodes() -> None:
    one, other = signal(), signal(key=(1, 2))
    a = np.array([SCALING.tension_n(one.value(n, 0, 0)[0]) for n in range(5000)])
    b = np.array([SCALING.tension_n(other.value(n, 0, 0)[0]) for n in range(5000)])
    assert a.std() == pytest.approx(0.005, rel=0.05)
    assert a.mean() == pytest.approx(10.0, abs=3e-4)
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.05


def test_the_filter_is_first_order() -> None:
    made = signal(0.0, step=True)
    asf = 5  # 8 Hz
    time_constant_s = 1 / (2 * np.pi * FIT.cut_offs_hz[asf])
    numbers = np.arange(1150, 1400)
    values = np.array([SCALING.tension_n(made.value(int(n), 0, asf)[0]) for n in numbers])
    after = np.array([made.sampled_s(int(n), 0) for n in numbers]) - 1.0
    expected = 10.0 + np.where(after > 0, 1 - np.exp(-after / time_constant_s), 0.0)
    assert np.abs(values - expected).max() < 0.05  # one sample of 0.8 ms is 4 % of 20 ms
    assert np.abs(values[after > 0.1] - expected[after > 0.1]).max() < 1e-3


def test_lower_rates_average_and_keep_the_nodes_own_clock() -> None:
    made = signal(0.0)
    assert made.period_s(3) == pytest.approx(8 / 1200 * (1 + 30e-6), rel=1e-9)
    number = made.number_at(100.0, 3)
    assert 0.0 <= 100.0 - made.sampled_s(number, 3) < made.period_s(3)


def test_the_input_is_clipped_and_flagged_beyond_the_converter() -> None:
    made = NodeSignal(lambda t_s: 200.0 + 0 * t_s, SCALING, FIT, Crystal(), 0.0, (0, 0))
    digits, status = made.value(10, 0, 0)
    assert digits == 6_400_000
    assert status & 4
