"""What cables lose along themselves: viscous, relaxing, structural, and by strands that slip."""

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import Task
from model.effects import ActiveEffect, library
from model.method import find_method
from model.simulator import run
from tests.model.harness import cable_response

SHORT = Excitation(rest_s=0.1, motion_s=0.8, ramp_s=0.1)


def test_kelvin_voigt_is_quadrature_in_proportion_to_frequency() -> None:
    effect = library()["cable_viscous"]
    slow, fast = cable_response(effect), cable_response(effect, frequency_hz=6.0)
    assert fast.quadrature[1] == pytest.approx(3 * slow.quadrature[1])
    assert slow.share(3) < 1e-9


@pytest.mark.parametrize("series_s", [5e-3, 2e-4])
def test_a_spring_in_series_with_the_dashpot_answers_for_it(series_s: float) -> None:
    """Maxwell's c w / (1 + i w tau); of springs that are quicker than a step, to first order."""
    effect, at = library()["cable_viscous"], 2.0 * np.pi * 2.0
    rigid, spring = (cable_response(effect, {"series_s": one}, cycles=4) for one in (0.0, series_s))
    wanted = 1.0 / (1.0 + (at * series_s) ** 2)
    assert spring.quadrature[1] == pytest.approx(wanted * rigid.quadrature[1], rel=3e-4)
    stiffer = wanted * at * series_s * rigid.quadrature[1]
    # Heun's steps of the harness are off by 1e-4 of the whole.
    off = 2e-4 * rigid.quadrature[1]
    assert spring.in_phase[1] - rigid.in_phase[1] == pytest.approx(stiffer, rel=0.02, abs=off)


def test_a_platform_that_is_displaced_at_once_deals_a_dashpot_no_blow(rig: Rig) -> None:
    pushed = SHORT.model_copy(update={"platform_offset_m": (1e-3, 0.0, 0.0)})
    rigid, spring = (
        run(Task(rig, pushed, effects=(ActiveEffect("cable_viscous", {"series_s": one}),)))
        for one in (0.0, 1e-4)
    )
    off = np.abs(spring.tension_n - rigid.tension_n).max()
    # A ten-thousandth of a second of the ring, not the spring's own c / tau of the millimetre.
    assert off < 0.02 * np.abs(rigid.tension_variation_n).max()


def test_steps_can_follow_a_spring_in_series(rig: Rig) -> None:
    method = find_method("dop853")
    rigid, quick, slow = (
        Task(rig, SHORT, effects=(ActiveEffect("cable_viscous", {"series_s": one}),)).step_s(method)
        for one in (0.0, 1e-4, 1e-3)
    )
    assert quick < slow < rigid


def test_relaxation_loses_most_at_one_over_tau() -> None:
    effect = library()["cable_relaxation"]
    peak_hz = 1 / (2 * np.pi * 0.05)
    losses = [
        cable_response(effect, frequency_hz=ratio * peak_hz, cycles=6).quadrature[1]
        for ratio in (0.3, 1.0, 3.0)
    ]
    assert losses[1] > 1.5 * max(losses[0], losses[2])
    assert losses[1] == pytest.approx(0.5 * 0.1 * 1410 * 5e-3, rel=0.01)


def test_two_branches_of_relaxation_lose_less_over_more_frequencies() -> None:
    """Each has half of the share: w t / (1 + (w t)^2) at both times."""
    effect, tau_s, ratio = library()["cable_relaxation"], 0.05, 9.0
    for turns_tau in (0.2, 1.0, 3.0):
        answer = cable_response(
            effect, {"branch_ratio": ratio}, cycles=6, frequency_hz=turns_tau / (2 * np.pi * tau_s)
        )
        times = turns_tau * np.array([ratio**-0.5, ratio**0.5])
        wanted = 0.1 * 1410 * 5e-3 * np.mean(times / (1.0 + times**2))
        assert answer.quadrature[1] == pytest.approx(wanted, rel=0.01)


def test_structural_damping_does_not_know_frequency() -> None:
    effect = library()["cable_structural"]
    wanted = 0.03 * 1410 * 5e-3
    for frequency_hz in (0.3, 1.0, 2.06, 6.0, 20.0):
        answer = cable_response(effect, frequency_hz=frequency_hz, cycles=4)
        assert answer.quadrature[1] == pytest.approx(wanted, rel=0.15)


@pytest.mark.parametrize("decades", [1.0, -3.0])
def test_loss_at_frequencies_below_the_branches_adds_stiffness_only(decades: float) -> None:
    effect = library()["cable_structural"]
    loss = 0.05
    none, below = (
        cable_response(effect, {"loss_factor": loss, "decades_below": some}, cycles=4)
        for some in (0.0, decades)
    )
    # Less than none: branches that were not thought of made up a part of the spring.
    wanted = decades * loss * 2.0 / np.pi * np.log(10.0) * 1410 * 5e-3
    assert below.in_phase[1] - none.in_phase[1] == pytest.approx(wanted, rel=1e-3)
    assert below.quadrature[1] == pytest.approx(none.quadrature[1], rel=1e-6)


def test_bouc_wen_is_rate_independent_with_a_loop() -> None:
    effect = library()["cable_hysteresis"]
    slow, fast = cable_response(effect), cable_response(effect, frequency_hz=8.0)
    assert fast.quadrature[1] == pytest.approx(slow.quadrature[1], rel=0.02)
    assert slow.quadrature[1] > 0.5 * slow.in_phase[1] > 0
    assert slow.share(2) < 1e-3 < slow.share(3) < 0.4


@pytest.mark.parametrize("share", [0.25, 0.5, 1.0, 1.5])
def test_strands_that_yield_evenly_lose_what_many_of_them_would(share: float) -> None:
    # Iwan's distribution: a slider that yields at s loses 4 k s (A - s) a cycle, s even to 2 x_y.
    alpha, stiffness, yield_m = 0.1, 1410.0, 5e-3
    amplitude = share * yield_m
    wanted = alpha * stiffness * amplitude**2 / (3.0 * np.pi * yield_m)
    effect = library()["cable_hysteresis"]
    answer = cable_response(
        effect, {"loop_share": alpha, "yield_m": yield_m}, amplitude_m=amplitude
    )
    assert wanted / 2.0 < answer.quadrature[1] < 2.0 * wanted


@pytest.mark.parametrize(("bend", "power"), [(0.0, 1.0), (1.0, 2.0)])
@pytest.mark.parametrize("back", [0.5, 0.7])
def test_a_loop_that_softens_from_the_first_is_bouc_and_wens(
    bend: float, power: float, back: float
) -> None:
    alpha, stiffness, yield_m, amplitude = 0.2, 1410.0, 5e-3, 4e-3
    values = {"loop_share": alpha, "yield_m": yield_m, "bouc_wen_share": 1.0, "bend": bend}
    values["back_share"] = back
    answer = cable_response(library()["cable_hysteresis"], values, amplitude_m=amplitude)
    # z' = x' (1 - r^n) where |z| grows and x' (1 - (2 c - 1) r^n) where it falls, until it repeats.
    phase = np.linspace(0.0, 12.0 * np.pi, 120_001)
    x, z = amplitude * np.sin(phase), np.zeros(phase.size)
    for i, step in enumerate(np.diff(x)):
        grows = step * z[i] > 0.0
        slips = 1.0 if grows else 2.0 * back - 1.0
        z[i + 1] = z[i] + step * (1.0 - (abs(z[i]) / yield_m) ** power * slips)
    last = phase >= 10.0 * np.pi
    quadrature = alpha * stiffness * 2.0 * np.mean(z[last] * np.cos(phase[last]))
    in_phase = alpha * stiffness * 2.0 * np.mean(z[last] * np.sin(phase[last]))
    assert answer.quadrature[1] == pytest.approx(quadrature, rel=0.03)
    assert answer.in_phase[1] == pytest.approx(in_phase, rel=0.03)


def test_what_the_stiffness_counts_of_a_loop_already_is_taken_off() -> None:
    effect = library()["cable_hysteresis"]
    alpha, amplitude = 0.1, 1e-4
    values = {"loop_share": alpha, "yield_m": 5e-3}
    none, all_ = (
        cable_response(effect, values | {"counted_share": share}, amplitude_m=amplitude)
        for share in (0.0, 1.0)
    )
    assert none.in_phase[1] == pytest.approx(alpha * 1410.0 * amplitude, rel=0.05)
    assert abs(all_.in_phase[1]) < 0.05 * none.in_phase[1]
    assert all_.quadrature[1] == pytest.approx(none.quadrature[1])
