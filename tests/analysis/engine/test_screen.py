"""Screening: which terms of a candidate are worth a look; numbers that parameters have moved."""

import numpy as np
import pytest

from analysis.engine import diagnose
from analysis.engine.array import Array
from analysis.engine.candidate import Candidate, Term
from analysis.engine.evidence import Problem, Weighed
from analysis.engine.finder import Promised, worth_fitting
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.screen import Scored, Screen
from analysis.engine.span import all_alike
from tests.analysis.engine.test_by_ring import Tuned
from tests.analysis.engine.test_ring_fit import SIGMA, ring

SHARES = tuple(Term(f"share@{i}", "share", "1", str(i), -0.5, 0.5, 0.1) for i in range(8))
HALF = tuple(one.name for one in SHARES[:4])
STIFFNESS = Candidate(
    "stiffness", "stiffness", "parameter", SHARES, form_share=0.01, combinations=(HALF,)
)


def test_the_one_number_that_moved_far_is_offered_alone_though_it_does_much() -> None:
    """What it does is 300 times the noise: an error of form of one per cent would hide it."""
    generator = np.random.default_rng(1)
    does = 300.0 * generator.normal(size=(60, 8))
    at = np.zeros(8)
    at[3] = -5.5
    problem = Problem(
        residual=generator.normal(size=60),
        nuisance=does,
        at=at,
        base=np.ones(60),
        labels=all_alike(60),
        used=np.ones(60, dtype=bool),
    )
    screen = Screen(problem, {"stiffness": STIFFNESS}, {("stiffness", 0): does / 0.02})
    best = screen.best_of("stiffness")
    assert best is not None
    assert best.hypothesis.parts["stiffness"].terms == ("share@3",)
    assert best.values["stiffness", "share@3"] == pytest.approx(-5.5 * 0.02, rel=0.02)


def test_what_grows_as_the_square_of_its_magnitude_begins_at_the_root() -> None:
    """Screened at 0.3, it does a quarter of that where its magnitude is half of it."""
    generator = np.random.default_rng(1)
    does, step = 300.0 * generator.normal(size=60), 0.3
    problem = _left(0.25 * does)
    term = Term("depth", "depth", "N", "", 0.0, 3.0, step)
    clipped = Candidate("clipped", "clipped", "cell", (term,), form_share=0.01, grows=True)
    columns = {("clipped", 0): does[:, None] / step}
    best = Screen(problem, {"clipped": clipped}, columns).best_of("clipped")
    assert best is not None
    assert best.values["clipped", "depth"] == pytest.approx(0.5 * step, rel=0.02)
    assert best.weighed.estimate == pytest.approx(0.25 * step, rel=0.02)


@pytest.mark.parametrize(("sigmas", "verdict"), [(1.5, "none"), (-6.0, "parameter")])
def test_a_number_that_is_off_by_more_than_is_known_of_it_is_named(
    sigmas: float, verdict: str
) -> None:
    found = diagnose(Tuned(ring(sigmas * SIGMA, 0.0, 0.0, 0.0)))
    assert found.verdict == verdict
    assert found.judgement is not None
    for cause in found.judgement.causes:
        assert cause.name == "tone"
        assert cause.values["share"] == pytest.approx(sigmas * SIGMA, rel=0.02)


def test_what_bends_with_its_size_is_told_by_the_look_that_fits() -> None:
    """A gap of 0.1 takes all of a motion within it: a little of it tells nothing of that."""
    generator = np.random.default_rng(2)
    little, whole = 300.0 * generator.normal(size=(2, 60))
    problem = _left(0.8 * whole)
    term = Term("gap", "gap", "m", "", 0.0, 3.0, 0.1)
    play = Candidate("play", "play", "plant", (term,), form_share=0.01, bends=True)
    looks = {("play", look): does[:, None] / 0.1 for look, does in enumerate((little, whole))}
    screen = Screen(problem, {"play": play}, looks)
    best = screen.best_of("play")
    assert best is not None
    assert best.looked == {"play": 1}
    assert best.values["play", "gap"] == pytest.approx(0.08, rel=0.02)
    same = screen.with_part("play", best.hypothesis.parts["play"], like=best)
    assert same.log_score == pytest.approx(best.log_score)


def test_what_may_be_far_off_is_fitted_though_it_leaves_little() -> None:
    """Its own error forgives it what others leave; screening is as wrong about it as about them."""
    promised = {"first": (0.0, 900.0), "second": (-60.0, 900.0), "third": (-80.0, 900.0)}
    promised |= {"loose": (-90.0, 5.0), "hopeless": (-400.0, 5.0)}
    candidates = {name: Candidate(name, name, "plant", (SHARES[0],)) for name in promised}
    found = [Promised(name, _scored(name, *one)) for name, one in promised.items()]
    chosen = worth_fitting(found, 7, candidates)
    assert [one.hypothesis.names for one in chosen] == [
        ("first",), ("second",), ("third",), ("loose",),
    ]  # fmt: skip
    assert len(worth_fitting(found, 2, candidates)) == 2


def _left(residual: Array) -> Problem:
    """What is left to explain beside white noise, where no parameter is free."""
    size = len(residual)
    return Problem(
        residual=residual,
        nuisance=np.zeros((size, 0)),
        at=np.zeros(0),
        base=np.ones(size),
        labels=all_alike(size),
        used=np.ones(size, dtype=bool),
    )


def _scored(name: str, log_score: float, chi2: float) -> Scored:
    hypothesis = Hypothesis({name: Part((SHARES[0].name,))})
    none = np.zeros(0)
    weighed = Weighed(log_score, none, np.zeros((0, 0)), none, chi2, none, none, 0.0)
    return Scored(hypothesis, log_score, weighed, {})


def test_points_that_all_moved_the_same_way_have_one_value_for_each_axis() -> None:
    """Eight points on three axes, moved along two of them: two numbers, and not sixteen."""
    generator = np.random.default_rng(3)
    terms = tuple(
        Term(f"{axis}@{i}", axis, "m", str(i), -1.0, 1.0, 0.1) for axis in "xyz" for i in range(8)
    )
    names = tuple(one.name for one in terms)
    moved = {"x": 0.3, "y": 0.0, "z": -0.2}
    does = 30.0 * generator.normal(size=(60, 24))
    whole = names[:8] + names[16:]
    points = Candidate(
        "points", "points", "parameter", terms, form_share=0.01, chosen_terms=6,
        combinations=(names, whole),
    )  # fmt: skip
    problem = _left(does @ np.array([moved[one.parameter] for one in terms]))
    best = Screen(problem, {"points": points}, {("points", 0): does}).best_of("points")
    assert best is not None
    part = best.hypothesis.parts["points"]
    assert (part.terms, part.shared) == (whole, True)
    assert part.groups(points) == (names[:8], names[16:])
    assert best.values["points", "x@3"] == pytest.approx(0.3, rel=0.02)
    assert best.values["points", "z@5"] == pytest.approx(-0.2, rel=0.02)
