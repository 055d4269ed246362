"""The verdict: what is named, how sure, and when the best is not good enough."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.engine.fitted import Fitted
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.judge import (
    CERTAIN,
    DOUBT_A_CAUSE,
    NEGLIGIBLE,
    STANDS_OUT,
    UNKNOWN,
    judge,
)
from analysis.engine.look import look
from analysis.engine.moved import EVEN, moved_far
from analysis.engine.refine import Refiner
from analysis.engine.state import State
from analysis.engine.system import Candidate, Nuisance, Term
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


@pytest.mark.parametrize(("left", "second"), [(1.05, False), (1.3, True)])
def test_a_second_cause_that_alone_leads_to_the_noise_is_there_however_much_the_first_explains(
    refiner: Refiner, left: float, second: bool
) -> None:
    # It is 110 ahead, and that counts a twentieth here: the form of the first could be so wrong.
    on = Hypothesis({"damping": Part(("rate",)), "step": Part(("high",), shapes={"moment": 4.0})})
    both = State.at(on, {("damping", "rate"): 0.2, ("step", "high"): 1.0}, CANDIDATES)
    found = [
        fitted(refiner, both, -100.0, 1.01),
        fitted(refiner, state_of(DAMPING, 0.2), -210.0, left),
        fitted(refiner, None, -1e5, 600.0),
    ]
    causes = judge(found, CANDIDATES).causes
    assert [one.name for one in causes] == ["damping", "step"][: 1 + second]
    assert not second or causes[1].present > CERTAIN


@pytest.mark.parametrize(("sigmas", "named"), [(2.5, False), (3.5, True), (6.0, True)])
def test_a_number_that_moved_by_more_than_three_sigmas_is_named_however_many_there_are(
    refiner: Refiner, sigmas: float, named: bool
) -> None:
    exact = {name: replace(one, form_share=0.01) for name, one in CANDIDATES.items()}
    found = [
        fitted(refiner, None, -10.0, 1.0),
        fitted(refiner, state_of(DAMPING, 0.01), -20.0, 1.0),
    ]
    assert judge(found, exact).verdict == "none"
    moved = {"damping": sigmas} if sigmas > EVEN else {}
    said = judge(found, exact, moved=moved)
    assert [one.name for one in said.causes] == ["damping"] * named
    assert not named or (said.causes[0].probability > 0.9) == (sigmas > 5.0)


def test_numbers_move_too_far_alone_or_together() -> None:
    springs = [Nuisance(f"spring {i}", 0.02, "1", "stiffness", f"share@{i}") for i in range(8)]
    known = [*springs, Nuisance("start", 1.0, "s"), Nuisance("mass", 0.01, "1", "mass", "share")]
    at = np.zeros(10)
    at[8] = 9.0
    assert moved_far(known, at) == {}
    at[9] = -4.0
    at[:8] = 1.0
    assert moved_far(known, at) == {"mass": pytest.approx(4.0)}
    at[:2] = 2.9, -2.9
    assert "stiffness" not in moved_far(known, at)
    at[:4] = 2.9
    assert moved_far(known, at)["stiffness"] == pytest.approx(4.34, abs=0.3)


@pytest.mark.parametrize(("sigmas", "causes"), [(14.0, ["damping", "step"]), (0.0, ["damping"])])
def test_an_error_of_form_hides_less_of_what_parameters_are_bent_for(
    refiner: Refiner, sigmas: float, causes: list[str]
) -> None:
    loose = {**CANDIDATES, "damping": replace(DAMPING, form_share=0.3)}
    alone = fitted(refiner, state_of(DAMPING, 0.2), -160.0, 1.02)
    alone = replace(alone, point=replace(alone.point, nuisance=np.array([sigmas])))
    one, other = state_of(DAMPING, 0.2), state_of(STEP, 1.0, moment=4.0)
    hypothesis = Hypothesis({**one.hypothesis.parts, **other.hypothesis.parts})
    both = State.at(hypothesis, one.term_values() | other.term_values(), loose)
    nothing = fitted(refiner, None, -20000.0, 50.0)
    said = judge([fitted(refiner, both, -80.0, 1.01), alone, nothing], loose)
    assert sorted(one.name for one in said.causes) == causes


@pytest.mark.parametrize("lost", [True, False])
def test_what_samples_show_is_there_where_nothing_can_be_followed(
    refiner: Refiner, lost: bool
) -> None:
    shown = {**CANDIDATES, "step": replace(STEP, shown=("step",))}
    said = judge(of(refiner, np.nan), shown, lost=lost)
    assert said.causes[0].name == ("step" if lost else "damping")
    assert said.shown is lost
    if lost:
        assert said.verdict != "unexplained"
        assert said.causes[0].probability > CERTAIN


def test_what_leaves_ten_times_as_much_is_not_likelier_for_having_a_cause_less(
    refiner: Refiner,
) -> None:
    # Laws of uncertain form: of a score of ten thousand, the temper leaves a few.
    known = {name: replace(one, form_share=0.3) for name, one in CANDIDATES.items()}
    one = state_of(DAMPING, 0.2)
    both = one.hypothesis.plus("step", state_of(STEP, 1.0, moment=4.0).hypothesis.parts["step"])
    values = {("damping", "rate"): 0.2, ("step", "high"): 1.0}
    hypotheses = [
        fitted(refiner, one, -9_000.0, 600.0),
        fitted(refiner, State.at(both, values, CANDIDATES), -4_000.0, 60.0),
        fitted(refiner, None, -100_000.0, 30_000.0),
    ]
    hypotheses = [replace(one, sigmas=dict.fromkeys(one.values, 1e-3)) for one in hypotheses]
    said = judge(hypotheses, known, settled=True)
    assert said.probability[1] > 0.9
    assert judge(hypotheses, known).probability[1] < said.probability[1]


@pytest.mark.parametrize(
    ("alone", "doubted"), [(50.0, True), (2e6, False)], ids=["of little", "of a great deal"]
)
def test_what_a_law_leaves_of_a_great_deal_is_its_error_of_form(
    refiner: Refiner, alone: float, doubted: bool
) -> None:
    led = [*of(refiner, 2.9)[:2], fitted(refiner, None, -1e6, alone)]
    assert (judge(led, CANDIDATES).doubt > 0.5) == doubted
    exact = {name: replace(one, form_share=0.0) for name, one in CANDIDATES.items()}
    assert judge(led, exact).doubt > 0.5


def test_what_leaves_hardly_more_than_noise_may_is_as_sure_as_what_leaves_that(
    refiner: Refiner,
) -> None:
    # Parameters alone went to a wrong valley: of so much, scores would count for nothing.
    for left, sure in ((1.05, True), (1.07, True), (1.5, False)):
        found = [
            fitted(refiner, state_of(DAMPING, 0.2), -50.0, left),
            fitted(refiner, state_of(STEP, 1.0, moment=4.0), -300.0, 3.5),
            fitted(refiner, None, -2.5e6, 3e4),
        ]
        uncertain = {name: replace(one, form_share=0.1) for name, one in CANDIDATES.items()}
        (cause,) = judge(found, uncertain).causes
        assert cause.name == "damping"
        assert (cause.rivals == ()) == sure


def test_what_leaves_more_than_nothing_does_is_out_whatever_evidence_forgives_it(
    refiner: Refiner,
) -> None:
    found = [
        fitted(refiner, state_of(DAMPING, 0.2), -10.0, 90.0),
        fitted(refiner, None, -1e5, 50.0),
    ]
    found[0] = replace(found[0], sigmas=dict.fromkeys(found[0].values, 1e-3))
    assert [one.name for one in judge(found, CANDIDATES).causes] == ["damping"]
    said = judge(found, CANDIDATES, settled=True)
    assert said.verdict == "none"
    assert said.chosen is found[1]


def test_nothing_is_told_as_surer_than_what_was_as_sure_has_been(refiner: Refiner) -> None:
    (cause,) = judge(of(refiner, 1.02), CANDIDATES).causes
    assert 0.99 * (1.0 - UNKNOWN) < cause.probability <= 1.0 - UNKNOWN
