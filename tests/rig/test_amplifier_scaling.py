"""From digits to newtons (protocol note, section 6)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cdpr8.rigfile.schema import Amplifier
from rig.amplifier.frame import Check, FrameFormat
from rig.amplifier.scaling import Scaling

TWO_BYTES = FrameFormat(2, True, Check.NONE, crlf=True)


def test_one_millivolt_per_volt_is_the_nominal_force_of_a_u9c() -> None:
    amplifier = Amplifier(address=1, nominal_force_n=500.0)
    assert Scaling.of(amplifier, FrameFormat()).tension_n(2_560_000) == pytest.approx(500.0)
    assert Scaling.of(amplifier, TWO_BYTES).tension_n(10_000) == pytest.approx(500.0)
    # 0.195 mN and 50 mN a digit
    assert Scaling.of(amplifier, FrameFormat()).tension_n(1) == pytest.approx(0.195e-3, rel=2e-3)
    assert Scaling.of(amplifier, TWO_BYTES).tension_n(1) == pytest.approx(0.05)


def test_sign_certificate_and_zero() -> None:
    amplifier = Amplifier(address=1, nominal_force_n=50.0, sensitivity_mv_per_v=0.98, sign=-1)
    scaling = Scaling.of(amplifier, FrameFormat(), zero_mv_per_v=0.02)
    digits = round((-0.98 * 0.4 + 0.02) * 2_560_000)
    assert scaling.tension_n(digits) == pytest.approx(20.0, abs=1e-4)


@given(st.floats(-60, 60), st.sampled_from([1, -1]), st.floats(0.5, 2.0), st.floats(-0.1, 0.1))
def test_digits_is_the_inverse(force: float, sign: int, sensitivity: float, zero: float) -> None:
    scaling = Scaling(50.0, sensitivity, sign, 2_560_000, zero)
    assert scaling.tension_n(round(scaling.digits(force))) == pytest.approx(force, abs=5e-5)


def test_the_host_trips_where_the_electronics_do_not() -> None:
    scaling = Scaling.of(Amplifier(address=1, nominal_force_n=50.0), FrameFormat())
    assert not scaling.overloaded(59.9)
    assert scaling.overloaded(60.1)
    assert scaling.overloaded(-60.1)
    assert scaling.digits(60.1) < 6_400_000  # the electronics' own limit is far above
