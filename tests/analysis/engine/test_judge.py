"""The verdict: what is named, how sure, and when the best is not good enough."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.candidate import Candidate, Term
from analysis.engine.doubt import DOUBT_A_CAUSE
from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.judge import (
    CERTAIN,
    NEGLIGIBLE,
    NOISE,
    SECOND,
    STANDS_OUT,
    UNKNOWN,
    judge,
)
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.state import State
from analysis.engine.weights import weights_of
from tests.analysis.engine.test_ring_fit import DAMPING, STEP, LetGo, ring, state_of

CANDIDATES = {one.name: one for one in (DAMPING, STEP)}


@pytest.fixture(scope="module")
def refiner() -> Refiner:
    system = LetGo(ring(0.0, 0.2, 0.0, 0.0))
    found = look(system)
    return Refiner(system, found.lens, found.data, found.calibrated)


def fitted(refiner: Refiner, state: State | None, score: float, left: float) -> Fitted:
    there = state or State(Hypothesis(), CANDIDATES, (), np.zeros(0))
    return replace(refiner.at(there, np.zeros(1)), log_score=score, left=left)


def of(refiner: Refiner, left: float) -> list[Fitted]:
    """Damping, far before a step and nothing, that leaves so much of each sample."""
    return [
        fitted(refiner, state_of(DAMPING, 0.2), -10.0, left),
        fitted(refiner, state_of(STEP, 1.0, moment=4.0), -90.0, left),
        fitted(refiner, None, -100.0, 50.0),
    ]


def test_what_comes_to_the_noise_is_named(refiner: Refiner) -> None:
    said = judge(of(refiner, 1.02), CANDIDATES)
    assert said.verdict == "explained"
    assert [one.name for one in said.causes] == ["damping"]
    assert said.causes[0].probability > CERTAIN


def test_a_cause_in_one_place_or_another_is_likelier_than_what_is_in_one(
    refiner: Refiner,
) -> None:
    # A step may be the likeliest fit, and damping, of one rate or another, still the likelier.
    fits = [
        fitted(refiner, state_of(STEP, 1.0, moment=4.0), -10.0, 1.02),
        fitted(refiner, state_of(DAMPING, 0.21), -10.4, 1.02),
        fitted(refiner, state_of(DAMPING, 0.2), -10.3, 1.02),
        fitted(refiner, None, -100.0, 50.0),
    ]
    said = judge(fits, CANDIDATES)
    assert said.verdict == "ambiguous"
    assert [one.names for one in said.causes] == [("damping", "step")]
    assert said.chosen is fits[2]


@pytest.mark.parametrize(("moment", "verdict"), [(0.1, "explained"), (4.0, "ambiguous")])
def test_a_law_that_came_to_where_it_is_another_is_no_rival_of_that(
    refiner: Refiner, moment: float, verdict: str
) -> None:
    begins = replace(STEP.shapes[0], low_is="damping")
    known = CANDIDATES | {"step": replace(STEP, shapes=(begins,))}
    fits = [
        fitted(refiner, state_of(DAMPING, 0.2), -10.0, 1.02),
        fitted(refiner, state_of(STEP, 1.0, moment=moment), -10.5, 1.02),
        fitted(refiner, None, -100.0, 50.0),
    ]
    said = judge(fits, known)
    assert said.verdict == verdict
    assert said.causes[0].name == "damping"


@pytest.mark.parametrize(("numbers", "verdict"), [(2, "parameter"), (6, "ambiguous")])
def test_a_dozen_coordinates_would_explain_anything(
    refiner: Refiner, numbers: int, verdict: str
) -> None:
    terms = tuple(Term(f"x@{i}", "x", "m", str(i), -1.0, 1.0, 0.01) for i in range(12))
    points = Candidate("points", "points", "parameter", terms, chosen_terms=8)
    known = CANDIDATES | {"points": points}
    on = Hypothesis({"points": Part(tuple(one.name for one in terms[:numbers]))})
    sizes = {("points", one.name): 0.05 for one in terms}
    nothing = fitted(refiner, None, -90.0, 1.2)
    moved = replace(
        nothing, hypothesis=on, state=State.at(on, sizes, known), values=sizes,
        sigmas=dict.fromkeys(sizes, 1e-3), log_score=-10.0, left=1.0,
    )  # fmt: skip
    said = judge([moved, nothing], known)
    assert said.verdict == verdict
    (cause,) = said.causes
    assert (cause.probability > CERTAIN) == (verdict == "parameter")
    assert cause.probability > 0.4


def test_a_cause_at_the_edge_of_what_is_plausible_is_as_likely_something_else(
    refiner: Refiner,
) -> None:
    first, *others = of(refiner, 1.02)
    on_edge = replace(first, at_limit=(("damping", "rate"),))
    said = judge([on_edge, *others], CANDIDATES)
    assert said.verdict == "ambiguous"
    (cause,) = said.causes
    assert cause.at_limit == ("rate",)
    assert cause.probability <= 0.5 < judge([first, *others], CANDIDATES).causes[0].probability


def test_recordings_in_which_it_does_not_hold_leave_doubt(refiner: Refiner) -> None:
    aside = [judge(of(refiner, 1.02), CANDIDATES, aside=one) for one in (0.0, 0.125, 0.25)]
    sure = [one.causes[0].probability for one in aside]
    assert sure == pytest.approx([1.0 - UNKNOWN, 1.0 - 0.0625, 1.0 - 0.125], abs=0.01)


def test_the_more_the_best_leaves_the_less_it_is_believed(refiner: Refiner) -> None:
    sure = [judge(of(refiner, left), CANDIDATES).causes[0].probability for left in (1.0, 1.2, 1.5)]
    assert sure[0] > sure[1] > sure[2]
    assert judge(of(refiner, 1.3), CANDIDATES).verdict == "ambiguous"
    assert judge(of(refiner, 3.0), CANDIDATES).verdict == "unexplained"


def test_where_no_ring_can_be_followed_each_cause_that_is_needed_is_a_doubt(
    refiner: Refiner,
) -> None:
    said = judge(of(refiner, np.nan), CANDIDATES, lost=True)
    assert said.verdict == "ambiguous"
    assert said.causes[0].name == "damping"
    assert said.causes[0].probability == pytest.approx(1.0 - DOUBT_A_CAUSE, abs=0.01)


def test_where_no_ring_can_be_followed_what_leaves_much_of_the_lines_is_not_believed(
    refiner: Refiner,
) -> None:
    fitted = of(refiner, np.nan)
    best = max(fitted, key=lambda one: one.log_score)
    poor = replace(best.problem, residual=best.problem.residual + 30.0)
    others = [one for one in fitted if one is not best]
    said = judge([replace(best, problem=poor), *others], CANDIDATES, lost=True)
    assert said.verdict == "unexplained"
    assert said.causes[0].probability < 0.3


def test_nothing_is_said_to_be_left_out_only_where_parameters_follow_the_ring(
    refiner: Refiner,
) -> None:
    nothing = [
        fitted(refiner, None, -10.0, 1.0),
        fitted(refiner, state_of(DAMPING, 0.01), -40.0, 1.0),
    ]
    assert judge(nothing, CANDIDATES).verdict == "none"
    said = judge(nothing, CANDIDATES, lost=True)
    assert said.verdict == "unexplained"
    assert said.causes == ()


def test_what_is_small_but_explains_much_is_named(refiner: Refiner) -> None:
    little = 0.2 * NEGLIGIBLE * DAMPING.terms[0].step
    tiny = fitted(refiner, state_of(DAMPING, little), -10.0, 1.0)
    faint = [tiny, fitted(refiner, None, -10.0 - 3.0 * STANDS_OUT, 1.2)]
    assert [one.name for one in judge(faint, CANDIDATES).causes] == ["damping"]
    fainter = [tiny, fitted(refiner, None, -10.0 - 0.5 * STANDS_OUT, 1.2)]
    assert judge(fainter, CANDIDATES).verdict == "none"


def test_a_law_without_an_error_of_form_must_explain_to_the_noise(refiner: Refiner) -> None:
    exact = {name: replace(one, form_share=0.01) for name, one in CANDIDATES.items()}
    assert judge(of(refiner, 1.15), exact).doubt > judge(of(refiner, 1.15), CANDIDATES).doubt
    assert judge(of(refiner, 1.02), exact).doubt == 0.0


@pytest.mark.parametrize(("ahead", "named"), [(-6.0, False), (1.0, False), (3.0, True)])
def test_an_exact_number_that_is_a_little_ahead_of_nothing_is_named_sooner_than_a_law(
    refiner: Refiner, ahead: float, named: bool
) -> None:
    exact = {name: replace(one, form_share=0.01) for name, one in CANDIDATES.items()}
    found = [
        fitted(refiner, state_of(DAMPING, 0.2), -100.0 + ahead, 1.0),
        fitted(refiner, None, -100.0, 1.0),
    ]
    assert bool(judge(found, exact).causes) == named
    assert judge(found, CANDIDATES).verdict == "none"


def test_of_kin_the_one_that_comes_to_the_noise_is_named_however_much_there_is_to_explain(
    refiner: Refiner,
) -> None:
    kin = {
        name: replace(one, family="one thing", form_share=0.12) for name, one in CANDIDATES.items()
    }
    for left, alone in ((1.0, True), (1.2, False)):
        found = [
            fitted(refiner, state_of(DAMPING, 0.2), -100.0, left),
            fitted(refiner, state_of(STEP, 1.0, moment=4.0), -500.0, 2.4),
            fitted(refiner, None, -1e5, 50.0),
        ]
        (cause,) = judge(found, kin).causes
        assert cause.name == "damping"
        assert (cause.rivals == ()) == alone


@pytest.mark.parametrize(("left", "second"), [(1.0, True), (3.5, False)])
def test_what_a_law_leaves_for_its_form_is_no_second_cause(
    refiner: Refiner, left: float, second: bool
) -> None:
    first = state_of(DAMPING, 0.2)
    on = first.hypothesis.plus("step", Part(("high",), shapes={"moment": 4.0}))
    both = State.at(on, {("damping", "rate"): 0.2, ("step", "high"): 1.0}, CANDIDATES)
    scores = np.array([-100.0, -1000.0, -4e6])
    of_form = [
        fitted(refiner, both, scores[0], left),
        fitted(refiner, first, scores[1], 1.4 * left),
        fitted(refiner, None, scores[2], 2400.0),
    ]
    weights = weights_of(scores, of_form, CANDIDATES, scores[2], NOISE, settled=True)
    assert (weights[0] > SECOND) == second


def test_a_number_that_moved_far_raises_what_keeps_it_where_it_is_known_to_be(
    refiner: Refiner,
) -> None:
    weighed = [
        fitted(refiner, state_of(DAMPING, 0.2), -101.0, 1.0),
        fitted(refiner, state_of(STEP, 1.0, moment=4.0), -101.2, 1.0),
        fitted(refiner, None, -100.0, 1.0),
    ]
    assert judge(weighed, CANDIDATES).verdict == "none"
    damping, step, nothing = judge(weighed, CANDIDATES, moved={"damping": 4.0}).probability
    assert damping > nothing, "it moved by four sigmas"
    assert damping > step > nothing
    assert np.log(damping / step) < 0.2 + 1e-6, "no farther apart than evidence has them"


def test_a_number_that_moved_far_and_is_told_as_next_to_nothing_raises_nothing_beyond_bounds(
    refiner: Refiner,
) -> None:
    weighed = [
        fitted(refiner, state_of(DAMPING, 0.01 * NEGLIGIBLE), -101.0, 1.0),
        fitted(refiner, state_of(STEP, 1.0, moment=4.0), -108.0, 1.0),
        fitted(refiner, None, -100.0, 1.0),
    ]
    said = judge(weighed, CANDIDATES, moved={"damping": 4.0})
    assert np.isfinite(said.probability).all()
    assert [one.name for one in said.causes] == ["damping"]
