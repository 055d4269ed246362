"""Sets of places: the one with one value in all of them is found among all sets."""

from itertools import combinations

import numpy as np
import pytest

from analysis.engine.candidate import Candidate, Term
from analysis.engine.choices import Choice, choices

NAMES = tuple(f"offset@{i}" for i in range(1, 9))


def cables(low: float = -10.0, high: float = 10.0, **more: bool) -> Candidate:
    terms = tuple(Term(name, "offset", "N", name.split("@")[1], low, high, 0.1) for name in NAMES)
    return Candidate("pretension", "pretension", "parameter", terms, **more)


def balance(seed: int) -> np.ndarray:
    """What eight tensions do where six of their combinations only move the platform."""
    return np.random.default_rng(seed).normal(size=(2, 8))


def alike(found: list[Choice]) -> Choice:
    return max((one for one in found if one.shared), key=lambda one: one.gain)


@pytest.mark.parametrize("seed", range(6))
def test_no_set_with_one_value_wins_more(seed: int) -> None:
    does = balance(seed)
    on = np.isin(np.arange(8), [0, 4, 5, 7])
    matrix, right = does.T @ does + 0.01 * np.eye(8), does.T @ (does @ (-0.9 * on))
    best = 0.0
    for size in range(2, 9):
        for chosen in combinations(range(8), size):
            one = np.isin(np.arange(8), chosen).astype(float)
            best = max(best, float((one @ right) ** 2 / (one @ matrix @ one)))
    found = alike(list(choices(cables(), matrix, right)))
    assert found.gain == pytest.approx(best)


def test_one_by_one_would_miss_it() -> None:
    does = balance(3)
    on = np.isin(np.arange(8), [0, 4, 5, 7])
    matrix, right = does.T @ does + 0.01 * np.eye(8), does.T @ (does @ (-0.9 * on))
    every = list(choices(cables(), matrix, right))
    grown = [one for one in every if not one.shared]
    of_these = {one.terms for one in grown}
    assert alike(every).terms not in of_these


def test_values_keep_within_their_bounds() -> None:
    matrix, right = np.eye(8), np.full(8, -1.0)
    assert all(one.gain == 0.0 for one in choices(cables(low=0.0), matrix, right) if one.shared)


def test_what_has_no_common_value_is_not_tried_with_one() -> None:
    found = list(choices(cables(shareable=False), np.eye(8), np.ones(8)))
    assert not any(one.shared for one in found)
