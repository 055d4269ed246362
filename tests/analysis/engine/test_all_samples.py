"""What all samples say of hypotheses, and which are led to say it."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine import all_samples
from analysis.engine.all_samples import (
    WORTH_IT,
    all_samples_say,
    cost_of,
    rise_beside_form,
    shown_the_way,
    tells_more,
)
from analysis.engine.array import Array
from analysis.engine.followed import Followed, Lent
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.guess import Guess
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.system import System
from tests.analysis.engine.test_ring_fit import DAMPING, SIGMA, STEP, LetGo, ring, state_of

DAMPED = LetGo(ring(0.0, 0.2, 0.0, 0.0))
COUNT = 1000
BETTER = 200.0
"""By how much less damping leaves than parameters alone, in squared misfit."""


@pytest.fixture(scope="module")
def refiner() -> Refiner:
    found = look(DAMPED)
    return Refiner(DAMPED, found.lens, found.data, found.calibrated)


@pytest.mark.parametrize(("left", "sure"), [(1.0, True), (1.05, True), (2.0, False)])
def test_what_nothing_explains_makes_a_cause_that_explains_little_of_it_less_sure(
    refiner: Refiner, left: float, sure: bool
) -> None:
    law = Followed(np.zeros(1), state_of(DAMPING, 0.01), misfit=left * COUNT)
    nothing = Followed(np.zeros(1), None, misfit=law.misfit + BETTER)
    first, second = all_samples_say(refiner, [law], nothing, COUNT)
    ahead = first.log_score - second.log_score
    assert bool(first.hypothesis.parts)
    assert (ahead > 20.0) == sure


@pytest.mark.parametrize(
    ("left", "roughness", "names"), [(1.0, 1.0, True), (1.044, 1.0, False), (1.044, 1.044, True)],
    ids=["beside the noise", "in a hollow", "of a noise that is as rough"],
)  # fmt: skip
def test_what_explains_less_than_hollows_leave_names_nothing(
    monkeypatch: pytest.MonkeyPatch, refiner: Refiner, left: float, roughness: float, names: bool
) -> None:
    many = 16 * COUNT
    monkeypatch.setattr(all_samples, "noise_expected", lambda _: 1.06)
    law = Followed(
        np.zeros(1), state_of(DAMPING, 0.01), misfit=left * many, roughness=roughness
    )  # fmt: skip
    nothing = replace(law, state=None, misfit=law.misfit + 65.0)
    scores = {one.hypothesis.names: one.log_score
              for one in all_samples_say(refiner, [law], nothing, many)}  # fmt: skip
    assert (scores["damping",] > scores[()] + 10.0) == names


@pytest.mark.parametrize(
    ("share", "cost", "alone", "more"),
    [
        (0.1, 150.0, 900.0, True),
        (0.1, 400.0, 900.0, False),
        (0.1, 100.0, 150.0, False),
        (0.05, 50.0, 900.0, False),
    ],
    ids=["to the noise", "closer, far from the noise", "parameters do too", "not as far"],
)
def test_a_law_that_is_led_no_farther_tells_by_what_it_explains_to_there(
    share: float, cost: float, alone: float, more: bool
) -> None:
    shares = np.linspace(0.001, 1.0, COUNT)
    law = Followed(np.zeros(1), state_of(DAMPING, 0.01), costs={share: cost})
    nothing = Followed(np.zeros(1), None, costs={0.1: alone})
    assert tells_more(law, nothing, shares) == more


@pytest.mark.parametrize("kin", [False, True])
def test_what_came_from_parameters_of_another_kind_of_law_is_led_anew(
    monkeypatch: pytest.MonkeyPatch, kin: bool
) -> None:
    begun: list[tuple[float, bool]] = []

    def spied(system: System, nuisance: Array, state: State, **how: bool) -> Followed:
        begun.append((float(nuisance[0]), how["near"]))
        return follow_ring(system, nuisance, state, **how)

    monkeypatch.setattr(all_samples, "follow_ring", spied)
    law = Followed(np.array([0.1]), state_of(DAMPING, 0.1), misfit=2.0 * COUNT, borrowed=True)
    other = state_of(DAMPING, 0.1) if kin else state_of(STEP, 0.1, moment=9.0)
    best = Followed(np.zeros(1), other, misfit=law.misfit - 50.0)
    led, _ = all_samples.led_through(DAMPED, [law, best])
    assert begun == [(0.1, True) if kin else (0.0, False)]
    assert led.misfit < 1.1 * COUNT


@pytest.mark.parametrize(("explains", "counts"), [(0.02, False), (0.2, True)])
def test_what_explains_little_of_what_a_law_leaves_is_lost_in_how_wrong_the_law_may_be(
    refiner: Refiner, explains: float, counts: bool
) -> None:
    law = Followed(np.zeros(1), state_of(DAMPING, 0.2), misfit=1.2 * COUNT)
    nothing = Followed(np.zeros(1), None, misfit=1e4 * COUNT)
    rise = rise_beside_form(refiner, law, nothing, COUNT, explains * COUNT)
    assert (rise > 10.0) == counts
    # Beside a law that leaves no more than noise, as little counts in full.
    exact = replace(law, misfit=1.0 * COUNT)
    assert rise_beside_form(refiner, exact, exact, COUNT, 40.0) == pytest.approx(20.0, rel=0.05)


@pytest.mark.parametrize(("roughness", "counts"), [(1.0, False), (1.2, True)])
def test_what_is_rough_of_what_a_law_leaves_is_noise_and_no_error_of_form(
    monkeypatch: pytest.MonkeyPatch, refiner: Refiner, roughness: float, counts: bool
) -> None:
    for name in ("noise_expected", "noise_leaves"):
        monkeypatch.setattr(all_samples, name, lambda _: 1.2)
    law = Followed(np.zeros(1), state_of(DAMPING, 0.2), misfit=1.2 * COUNT, roughness=roughness)
    nothing = Followed(np.zeros(1), None, misfit=10.0 * COUNT)
    rise = rise_beside_form(refiner, law, nothing, COUNT, 0.04 * COUNT)
    assert (rise > 10.0) == counts


def test_roughness_is_that_of_noise_whatever_slow_is_beside_it() -> None:
    samples = Samples(DAMPED, everything=True)
    count = len(samples.shares)
    noise = 1.1 * np.random.default_rng(1).standard_normal(count)
    slow = 3.0 * np.sin(np.linspace(0.0, 20.0, count))
    assert samples.roughness(noise) == pytest.approx(1.21, rel=0.1)
    assert samples.roughness(noise + slow) == pytest.approx(samples.roughness(noise), rel=0.02)


def test_nothing_is_led_again_with_what_parameters_do_where_it_starts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lent: list[object] = []

    def spied(system: System, nuisance: Array, **how: object) -> Followed:
        lent.append(how["lent"])
        return Followed(nuisance, None, misfit=2.0 * COUNT)

    monkeypatch.setattr(all_samples, "follow_ring", spied)
    here, elsewhere = (Lent(np.ones((1, COUNT)), one * np.ones(COUNT)) for one in (0.0, 1.0))
    law = Followed(np.zeros(1), state_of(DAMPING, 0.1), misfit=COUNT, lends=here)
    law = replace(law, costs={1.0: COUNT})
    nothing = Followed(np.zeros(1), None, misfit=3.0 * COUNT, lends=elsewhere)
    assert all_samples.nothing_again(DAMPED, nothing, [law]).misfit == 2.0 * COUNT
    assert lent[0] is here


def test_of_two_causes_that_were_led_together_each_is_tried_alone(refiner: Refiner) -> None:
    both = Hypothesis({"damping": Part(("rate",)), "step": Part(("high",), False, {"moment": 9.0})})
    values = {("damping", "rate"): 0.19, ("step", "high"): 0.002}
    state = State.at(both, values, {one.name: one for one in (DAMPING, STEP)})
    nothing = replace(follow_ring(DAMPED, np.zeros(1), everything=True), lends=None)
    search = FollowedSearch(refiner, nothing, 2)
    search.follow([Guess(state, np.zeros(1))], [])
    found = search.fitted()
    assert found is not None
    assert found[0].hypothesis.names == ("damping",)


def test_a_rival_is_led_again_from_what_found_a_better_valley() -> None:
    system = LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0))
    hollow = follow_ring(system, np.zeros(1), state_of(DAMPING, 0.01), near=True, most=0.0)
    found = follow_ring(system, np.zeros(1), everything=True)
    assert cost_of(found) < cost_of(hollow) - WORTH_IT
    led = shown_the_way(system, [hollow, found], [hollow])
    again = min((one for one in led if one.names == ("damping",)), key=cost_of)
    assert again.left == pytest.approx(1.0, abs=0.1)
    assert again.nuisance[0] == pytest.approx(2.0, abs=0.01)
    assert shown_the_way(system, [hollow], [hollow]) == [hollow]


def test_numbers_of_what_was_led_are_as_sure_as_all_samples_make_them(refiner: Refiner) -> None:
    off = []
    for seed in range(12):
        system = LetGo(ring(0.0, 0.2, 0.0, 0.0))
        (bundle,) = system.bundles
        noise = 0.02 * np.random.default_rng(seed).standard_normal(bundle.value.shape)
        system.bundles = (replace(bundle, value=ring(0.0, 0.2, 0.0, 0.0) + noise),)
        led = follow_ring(system, np.zeros(1), state_of(DAMPING, 0.1), everything=True)
        nothing = follow_ring(system, np.zeros(1), everything=True)
        first = all_samples_say(refiner, [led], nothing, COUNT)[0]
        sigma = first.sigmas["damping", "rate"]
        # Noise over the root of 50/s times the integral of (t exp(-t/5) sin)^2: 0.0007.
        assert 0.0007 < sigma < 0.001
        off.append((first.values["damping", "rate"] - 0.2) / sigma)
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.5
