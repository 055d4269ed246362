"""A motion that grows of itself late in a recording names nothing: what came before counts."""

from typing import Any

import numpy as np
import pytest

from analysis.engine import Bundle, Segment, diagnose
from analysis.engine.finder import Tell
from analysis.engine.search import Search, search
from analysis.engine.system import System
from analysis.engine.until import Until
from tests.analysis.engine.test_ring_fit import SIGMA, T_S, LetGo, ring

GROWS_S = 12.0


def grown(value: np.ndarray, amplitude: float) -> np.ndarray:
    """With another tone that grows from a time on, as in a parametric resonance."""
    since = np.maximum(T_S - GROWS_S, 0.0)
    more = amplitude * np.expm1(since) * np.sin(2.0 * np.pi * 7.7 * T_S)
    return np.asarray(value + more[:, None])


def test_what_grows_late_and_nothing_foretells_does_not_count() -> None:
    system = LetGo(grown(ring(2.0 * SIGMA, 0.0, 0.0, 0.0), 0.05))
    found = diagnose(system)
    assert found.verdict == "none"
    assert isinstance(found.system, Until)
    assert found.system.end_s < GROWS_S + 1.0
    assert any("does not count" in note for note in found.notes)


@pytest.mark.parametrize(("by_cause", "verdict"), [(False, "none"), (True, "unexplained")])
def test_where_a_cause_was_needed_to_foretell_so_much_something_was_left_out(
    by_cause: bool, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def cut(system: System, tell: Tell | None, **how: Any) -> Search:
        return search(Until(system, 0.5, by_cause=by_cause), tell, **how)

    monkeypatch.setattr("analysis.engine.diagnosis.search", cut)
    assert diagnose(LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0))).verdict == verdict


def test_what_can_be_foretold_counts_to_its_end() -> None:
    found = diagnose(LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0)))
    assert found.verdict == "none"
    assert not isinstance(found.system, Until)
    assert not found.notes


@pytest.mark.parametrize(
    ("share", "spans"),
    [
        (1.0, [(0.0, 1.0), (2.0, 9.0), (9.0, 12.0), (12.0, 20.0)]),
        (0.35, [(0.0, 1.0), (2.0, 5.5), (5.5, 7.0)]),
        (0.1, [(0.0, 1.0)]),
        (0.03, [(0.0, 0.6)]),
    ],
)
def test_the_steady_motion_is_parted_as_it_was(
    share: float, spans: list[tuple[float, float]]
) -> None:
    t_s = np.linspace(0.0, 20.0, 2001)
    whole = LetGo(ring(0.0, 0.0, 0.0, 0.0))
    segments = (
        Segment(0.0, 1.0, None, 20.0),
        Segment(2.0, 9.0, 2.0),
        Segment(9.0, 12.0, 2.0, held_out=True),
        Segment(12.0, 20.0, None, 20.0),
    )
    value = np.zeros((2001, 1))
    whole.bundles = (Bundle(("y",), ("V",), t_s, value, np.eye(1), segments),)
    (cut,) = Until(whole, share).bundles
    assert [(one.start_s, one.end_s) for one in cut.segments] == [
        pytest.approx(span) for span in spans
    ]
