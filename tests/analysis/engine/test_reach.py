"""What a simulator comes to nothing for is said, and not ruled out."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine import Point, diagnose
from analysis.engine.reach import unreached
from tests.analysis.engine.test_check import Line


class Bounded(Line):
    """A line whose solver fails beyond some bend, or some offset."""

    def __init__(self, bend: float, sigmas: float = np.inf, *, hidden: float = 0.0) -> None:
        super().__init__()
        self._bend, self._sigmas = bend, sigmas
        (bundle,) = self.bundles
        bundle.value[:] += hidden * bundle.t_s[:, None] ** 2

    def simulate(self, points: Sequence[Point], reduce: Any) -> list[Any]:
        for point in points:
            on = point.effects.get("bend")
            if on is not None and on.values["bend"] > self._bend:
                raise ValueError("no root")
            if point.nuisance[0] > self._sigmas:
                raise ArithmeticError("diverged")
        return super().simulate(points, reduce)


def test_nothing_is_said_of_what_can_be_simulated() -> None:
    assert unreached(Bounded(np.inf)) == ()


@pytest.mark.parametrize(("most", "usual"), [(0.02, True), (0.05, False)])
def test_a_size_within_the_range_that_fails_is_said(most: float, usual: bool) -> None:
    (one,) = unreached(Bounded(most))
    assert (one.candidate, one.usual) == ("bend", usual)
    assert f"'bend' at {0.03 if usual else 0.1:g} V/s^2" in one.note
    assert "ValueError: no root" in one.note


def test_a_parameter_that_fails_on_one_side_is_said() -> None:
    (one,) = unreached(Bounded(np.inf, 1.5))
    assert (one.candidate, one.usual) == ("", True)
    assert "'offset' at +2 sigmas" in one.note


def test_what_fails_where_it_is_usual_may_be_there_instead_of_what_is_named() -> None:
    # A bend that fails; what it does is named as something else, which can be simulated.
    system = Bounded(0.02)
    system.bundles[0].value[:] += np.sin(2.0 * np.pi * system.bundles[0].t_s / 5.0)[:, None]
    found = diagnose(system)
    assert found.verdict == "ambiguous"
    assert found.judgement is not None
    assert [one.name for one in found.judgement.causes] == ["ripple"]
    assert any("no root" in one for one in found.notes)
