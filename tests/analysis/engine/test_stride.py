"""Causes of which a little is the wrong way, and all of it explains what parameters leave."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine import diagnose
from analysis.engine.array import Array
from analysis.engine.candidate import Candidate, Term
from analysis.engine.faint import faint
from analysis.engine.faint_search import faint_search
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.stride import strides_of
from analysis.engine.stride_search import stride_guesses
from analysis.engine.system import Nuisance, Point, Prediction
from tests.analysis.engine.test_ring_fit import DAMPING, SIGMA, STEP, T_S, LetGo, ring

TURNS = Candidate(
    "turns", "turns", "plant", (Term("size", "size", "V", "", 0.0, 5.0, 1.0),), form_share=0.05
)
SLOW = np.asarray(0.015 * np.sin(2.0 * np.pi * 0.3 * T_S))[:, None]
"""What it does, less than the noise."""

ROOT = 0.6
"""Where it does nothing again."""


class WrongWay(LetGo):
    """A little of the cause does the opposite of what much of it does."""

    candidates = (DAMPING, STEP, TURNS)

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(one) + _turned(one)]) for one in points]


def _turned(point: Point) -> Array:
    there = point.effects.get("turns")
    size = there.values["size"] if there else 0.0
    return np.asarray(size * (size - ROOT) * SLOW)


def _asked(size: float) -> tuple[list[Guess], list[Fitted]]:
    system = WrongWay(ring(0.0, 0.0, 0.0, 0.0) + size * (size - ROOT) * SLOW)
    refiner = Refiner(system, *look(system))
    strides = strides_of(system.candidates, system.nuisances)
    nothing = Followed(np.zeros(1), None, misfit=1000.0, left=1.0)
    about = faint(system, nothing, system.candidates, strides=strides)
    _, faintly = faint_search(about, refiner, refiner.candidates)
    return stride_guesses(about, refiner.candidates, faintly), faintly


def test_of_what_a_little_is_the_wrong_way_the_whole_is_looked_at() -> None:
    guesses, faintly = _asked(1.2)
    scores = {one.hypothesis.names: one.log_score for one in faintly}
    assert scores.get(("turns",), -np.inf) < scores[()], "straight lines say it is not there"
    assert [one.hypothesis.names for one in guesses] == [("turns",)]
    assert guesses[0].log_score > scores[()] + 8.0
    # What it does is taken for a line through nothing and its usual size.
    line = 1.2 * (1.2 - ROOT) / (1.0 - ROOT)
    assert guesses[0].state.values[0] == pytest.approx(line, rel=0.1)


def test_what_is_not_there_is_no_likelier_for_being_looked_at_as_a_whole() -> None:
    guesses, _ = _asked(0.0)
    assert guesses == []


def test_it_is_led_from_there_and_named() -> None:
    found = diagnose(WrongWay(ring(0.5 * SIGMA, 0.0, 0.0, 0.0) + 1.2 * (1.2 - ROOT) * SLOW))
    assert [one.name for one in found.judgement.causes] == ["turns"]
    assert found.judgement.causes[0].values["size"] == pytest.approx(1.2, rel=0.1)


def test_no_stride_is_taken_of_what_is_led_as_a_parameter_nor_of_what_has_many_numbers() -> None:
    several = replace(
        TURNS, name="several", shareable=False,
        terms=tuple(Term(k, k, "V", k, 0.0, 5.0, 1.0) for k in "abc"),
    )  # fmt: skip
    tone = Candidate(
        "tone", "tone", "parameter", (Term("share", "share", "1", "", -1.0, 1.0, 0.1),)
    )
    free = (Nuisance("tone", SIGMA, "1", cause="tone", term="share"),)
    asked = strides_of((TURNS, several, tone, replace(TURNS, name="swap", fixed=True)), free)
    assert {one.candidate.name for one in asked} == {"turns"}
