"""Differences where everything is simulated anew: how fine, and of what does not move at first."""

from collections.abc import Sequence

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.fine import BOTH_WAYS, ONE_WAY, columns_of

T_S = np.arange(0.0, 40.0, 0.01)
NOISE = 1e-3
ROOT = np.full(len(T_S), NOISE)
STEPS = np.array([0.02, 0.02])


def swing(tone_share: float, inertia_share: float) -> Array:
    """A swing at 1 Hz whose tone both numbers move alike, and by nothing else."""
    return np.sin(2.0 * np.pi * T_S * (1.0 + 5e-3 * (tone_share - inertia_share)))


def simulated(which: Sequence[int], by: Array) -> Array:
    rows = by[:, None] * np.eye(2)[which]
    return np.array([swing(*row) for row in rows])


@pytest.mark.parametrize(
    ("both", "most", "least"), [(True, 0.1, 0.0), (False, 30.0, 0.1)], ids=["both ways", "one way"]
)
def test_what_changes_nothing_seems_to_change_little(both: bool, most: float, least: float) -> None:
    columns, whole = columns_of(
        simulated, swing(0.0, 0.0), ROOT, STEPS, np.array([0.5, 0.5]), both=both
    )
    assert whole
    # Both numbers together turn no phase: what is left is the bend of differences.
    together = np.linalg.norm(columns.sum(axis=1)) / NOISE
    alone = np.linalg.norm(columns[:, 0]) / NOISE
    assert alone > 1e4
    assert least <= together < most


def test_what_moves_much_is_moved_by_less_and_both_ways_by_more() -> None:
    moves: list[Array] = []

    def noted(which: Sequence[int], by: Array) -> Array:
        moves.append(simulated(which, by))
        return moves[-1]

    here = swing(0.0, 0.0)
    for both, most in ((True, BOTH_WAYS), (False, ONE_WAY)):
        moves.clear()
        columns_of(noted, here, ROOT, STEPS, STEPS, both=both)
        for rows in moves[1:]:
            far = np.linalg.norm((rows - here) / ROOT, axis=1)
            assert np.all(far < 1.01 * most)


def test_what_so_little_of_does_not_move_is_moved_as_it_is_stated() -> None:
    def in_samples(which: Sequence[int], by: Array) -> Array:
        return np.array([np.round(step / 0.1) * 0.1 * T_S * 1e-4 for step in by])

    found, whole = columns_of(
        in_samples, np.zeros(len(T_S)), ROOT, STEPS, np.array([0.5, 0.02]), both=True
    )
    assert whole
    assert found[:, 0] == pytest.approx(1e-4 * T_S)
    assert not found[:, 1].any()


def test_a_simulation_that_comes_to_nothing_tells_nothing() -> None:
    def lost(which: Sequence[int], by: Array) -> Array:
        return np.full((len(which), len(T_S)), np.nan)

    columns, whole = columns_of(lost, np.zeros(len(T_S)), ROOT, STEPS, STEPS, both=True)
    assert not whole
    assert not columns.any()
