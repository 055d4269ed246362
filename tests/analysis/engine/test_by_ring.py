"""What is led to the ring's phase first."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.by_ring import _abreast, _leads_bent, _out_of_rest
from analysis.engine.candidate import Candidate, Term
from analysis.engine.faint import faint
from analysis.engine.faint_search import faint_search
from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.guess import Guess
from analysis.engine.look import look
from analysis.engine.near_noise import _is_hollow, _led_a_little
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.system import Nuisance
from tests.analysis.engine.test_ring_fit import DAMPING, SIGMA, STEP, LetGo, ring, state_of

TONE = Candidate("tone", "tone", "parameter", (Term("share", "share", "1", "", -1.0, 1.0, SIGMA),))


class Tuned(LetGo):
    """An oscillator of which the tone may be off by more than is known of it."""

    nuisances = (Nuisance("tone", SIGMA, "1", cause="tone", term="share"),)
    candidates = (DAMPING, STEP, TONE)


@pytest.mark.parametrize(
    ("sigmas", "share", "bent"), [(7.0, 0.9, True), (0.9, 0.9, False), (7.0, 0.2, False)]
)
def test_parameters_are_bent_where_they_lead_a_long_way_more_than_a_sigma_off(
    sigmas: float, share: float, bent: bool
) -> None:
    assert _leads_bent(replace(Followed(np.array([sigmas]), None), share=share)) == bent


@pytest.mark.parametrize(
    ("left", "rate", "hollow"), [(1.16, 0.0, True), (1.16, 0.2, False), (1.02, 0.0, False)],
    ids=["nothing explains it", "a cause explains it", "it is noise"],
)  # fmt: skip
def test_parameters_are_in_a_hollow_where_nothing_promises_to_explain_what_they_leave(
    left: float, rate: float, hollow: bool
) -> None:
    system = Tuned(ring(0.0, rate, 0.0, 0.0))
    refiner = Refiner(system, *look(system))
    nothing = Followed(np.zeros(1), None, misfit=left * 1000, left=left)
    about = faint(system, nothing, system.candidates)
    _, faintly = faint_search(about, refiner, refiner.candidates)
    assert _is_hollow(system, nothing, faintly) == hollow


def test_where_parameters_are_bent_and_the_ring_promises_nothing_lines_are_asked() -> None:
    assert _abreast([]) == []


def test_what_moves_where_a_rest_ends_is_led_from_there_and_lines_are_asked_of_the_rest(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And where nothing could be led, nothing is said, either."""
    system = Tuned(ring(0.0, 0.2, 0.0, 0.0))
    refiner = Refiner(system, *look(system))
    lost = follow_ring(system, np.zeros(1), everything=True, most=0.0)
    still = replace(lost, telling=0.3)
    found = _out_of_rest(refiner, still, 2, lambda done, total: None)
    assert found.faint
    assert found.fitted[0].hypothesis.names == ("damping",)
    assert found.fitted[0].values["damping", "rate"] == pytest.approx(0.2, abs=0.01)
    monkeypatch.setattr(FollowedSearch, "follow", lambda *_, **__: None)
    found = _out_of_rest(refiner, still, 2, lambda done, total: None)
    assert not found.faint
    assert found.led is not None
    assert found.led.search.fitted() is None
    assert found.led.single[0].hypothesis.names == ("damping",)


def test_beside_what_lines_are_sure_of_the_ring_is_asked_where_that_was_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Unless parameters were bent for it, and not where something came to the end."""
    system = Tuned(ring(0.0, 0.2, 0.0, 0.0))
    refiner = Refiner(system, *look(system))
    still = follow_ring(system, np.zeros(1), everything=True, most=0.0)
    search = FollowedSearch(refiner, still, 2)
    asked: list[Followed | None] = []
    monkeypatch.setattr(search, "_one_more", lambda beside=None: asked.append(beside))
    near = Followed(np.zeros(1), state_of(DAMPING, 0.1), share=0.4, costs={0.4: 500.0})
    bent = replace(near, nuisance=np.array([7.0]), costs={0.5: 500.0})
    for one in (near, bent):
        search._keep(one)
    search.follow_beside(("step",))
    assert asked == []
    search.follow_beside(("damping",))
    assert asked == [near]
    search._keep(replace(near, share=1.0, misfit=1000.0, left=1.0, costs={1.0: 1000.0}))
    search.follow_beside(("damping",))
    assert asked == [near]


@pytest.mark.parametrize(
    ("rate", "behind", "led"), [(0.2, 6.0, True), (0.0, 6.0, False), (0.2, 20.0, False)],
    ids=["it is there", "it is not", "it is too far behind"],
)  # fmt: skip
def test_what_is_a_little_behind_nothing_is_led_a_little(
    rate: float, behind: float, led: bool
) -> None:
    system = Tuned(ring(0.0, rate, 0.0, 0.0))
    refiner = Refiner(system, *look(system))
    nothing = follow_ring(system, np.zeros(1), everything=True)
    _, faintly = faint_search(
        faint(system, nothing, system.candidates), refiner, refiner.candidates
    )
    alone = next(one for one in faintly if not one.hypothesis.parts).log_score
    usual = Guess(state_of(DAMPING, 0.1), np.zeros(1), alone - behind)
    found = _led_a_little(refiner, nothing, faintly, [usual])
    assert bool(found) == led
    for one in found:
        assert one.log_score > alone
        assert one.state.term_values()["damping", "rate"] == pytest.approx(rate, abs=0.01)
