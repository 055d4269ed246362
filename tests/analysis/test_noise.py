"""How unsure the instants of samples are, told by the floor between the lines of their spectra."""

import numpy as np
import pytest

from analysis.diagnosis.noise import instants_s, with_instants
from analysis.engine.system import Array, Bundle, Segment
from cdpr8.rigfile import Excitation

NOISE_N = 0.005
EXCITATION = Excitation(rest_s=1.0, motion_s=9.0)
WHOLE_S = EXCITATION.duration_s


def _tension(t_s: Array) -> Array:
    """The drive, two of its harmonics, and two rings that no harmonic falls on."""
    tau = t_s - EXCITATION.start_s
    moving = (tau >= 0.0) & (t_s < EXCITATION.end_s)
    turn = 2.0 * np.pi * tau
    drive = 7.0 * np.sin(2.06 * turn) + 0.3 * np.sin(4.12 * turn + 1.0)
    rings = np.exp(-tau / 4.0) * (0.4 * np.sin(10.96 * turn) + 0.2 * np.sin(27.16 * turn))
    return np.where(moving, drive + 0.1 * np.sin(6.18 * turn) + rings, 0.0)


def _bundles(
    instant_s: float, rate_hz: float, generator: np.random.Generator, lost_s: float = 0.0
) -> list[Bundle]:
    """Eight cells whose samples are of other instants than they say, from mid-motion on later."""
    found = []
    for cell in range(8):
        t_s = np.arange(0.0, WHOLE_S, 1.0 / rate_hz) + cell * 1e-4
        late_s = np.where(t_s > 0.45 * WHOLE_S, lost_s, 0.0)
        at_s = t_s + late_s + instant_s * generator.standard_normal(len(t_s))
        value = _tension(at_s) + NOISE_N * generator.standard_normal(len(t_s))
        found.append(
            Bundle(
                names=(f"tension {cell + 1}",),
                units=("N",),
                t_s=t_s,
                value=value[:, None],
                covariance=np.array([[NOISE_N**2]]),
                segments=(Segment(0.0, WHOLE_S, None),),
                kind="tension",
            )
        )
    return found


@pytest.mark.parametrize("rate_hz", [28.0, 128.0, 300.0])
def test_the_floor_tells_how_unsure_instants_are(rate_hz: float) -> None:
    generator = np.random.default_rng(1)
    found = instants_s(_bundles(3e-4, rate_hz, generator), EXCITATION, 0.0)
    assert found == pytest.approx(3e-4, rel=0.25)


@pytest.mark.parametrize("rate_hz", [28.0, 128.0, 300.0])
def test_instants_that_are_known_are_left_alone(rate_hz: float) -> None:
    """Up to what would not count: a hundredth of the noise is 0.5 us at 100 N/s."""
    generator = np.random.default_rng(2)
    assert instants_s(_bundles(0.0, rate_hz, generator), EXCITATION, 0.0) < 3e-5


def test_a_lost_frame_is_not_taken_for_unsure_instants() -> None:
    generator = np.random.default_rng(3)
    found = instants_s(_bundles(0.0, 32.0, generator, lost_s=0.06), EXCITATION, 0.0)
    assert found < 0.06 / 300.0


def test_rest_alone_tells_nothing_of_instants() -> None:
    generator = np.random.default_rng(4)
    still = Excitation(amplitude_deg=0.0, rest_s=1.0, motion_s=1.0)
    assert instants_s(_bundles(3e-4, 28.0, generator), still, 0.0) == 0.0


def test_unsure_instants_count_in_proportion_to_the_rate() -> None:
    (first, *_) = _bundles(0.0, 300.0, np.random.default_rng(5))
    jitter = with_instants(first, 2e-4).jitter
    assert jitter is not None
    assert jitter.shape == first.value.shape
    moving = (first.t_s > EXCITATION.start_s) & (first.t_s < EXCITATION.end_s)
    driven = 2e-4 * 2.0 * np.pi * 2.06 * 7.0 / np.sqrt(2.0)
    assert np.sqrt(np.mean(jitter[moving] ** 2)) == pytest.approx(driven, rel=0.2)
    assert with_instants(first, 0.0).jitter is None
