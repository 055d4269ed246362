"""How unsure the instants of samples are, told by the floor between the lines of their spectra."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.diagnosis.noise import about_line, instants_s, with_instants
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.whiten import noise_leaves
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


def test_a_channel_that_does_not_move_tells_nothing_of_instants() -> None:
    bundles = _bundles(3e-4, 128.0, np.random.default_rng(9))
    still = [replace(one, value=np.full_like(one.value, 10.0)) for one in bundles]
    assert instants_s(still, EXCITATION, 0.0) == 0.0
    assert instants_s([*bundles, *still], EXCITATION, 0.0) == pytest.approx(3e-4, rel=0.25)


def test_unsure_instants_count_in_proportion_to_the_rate() -> None:
    (first, *_) = _bundles(0.0, 300.0, np.random.default_rng(5))
    jitter = with_instants(first, 2e-4).jitter
    assert jitter is not None
    assert jitter.shape == first.value.shape
    moving = (first.t_s > EXCITATION.start_s) & (first.t_s < EXCITATION.end_s)
    driven = 2e-4 * 2.0 * np.pi * 2.06 * 7.0 / np.sqrt(2.0)
    assert np.sqrt(np.mean(jitter[moving] ** 2)) == pytest.approx(driven, rel=0.2)
    assert with_instants(first, 0.0).jitter is None


def test_the_spread_of_a_short_rest_is_never_taken_for_half_of_it() -> None:
    generator = np.random.default_rng(6)
    t_s = np.arange(46) / 43.0
    found = [about_line(t_s, generator.standard_normal(46)) for _ in range(2000)]
    assert np.mean(found) == pytest.approx(1.0, rel=0.02)
    assert min(found) > 0.6


def test_a_sample_far_off_does_not_widen_the_noise() -> None:
    generator = np.random.default_rng(7)
    t_s, value = np.arange(100) / 43.0, generator.standard_normal(100)
    value[40] += 50.0
    assert about_line(t_s, value) == pytest.approx(1.0, rel=0.2)


def test_what_noise_leaves_is_as_unsure_as_the_rest_it_was_taken_from() -> None:
    """One in six recordings leaves more than one standard deviation more than the mean."""
    generator = np.random.default_rng(8)
    rest, count = 40, 400
    bundles = [replace(one, noise_from=rest) for one in _bundles(0.0, count / WHOLE_S, generator)]
    taken = generator.chisquare(rest - 2, (4000, 8)) / (rest - 2)
    left = np.mean(generator.chisquare(count, (4000, 8)) / count / taken, axis=1)
    assert np.mean(left > noise_leaves(bundles)) == pytest.approx(0.16, abs=0.04)
    exact = [replace(one, noise_from=0) for one in bundles]
    assert noise_leaves(exact) == pytest.approx(1.0 + np.sqrt(2.0 / (8 * count)), rel=1e-3)
