"""Faint causes: what changes span, in few directions."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine.faint import faint
from analysis.engine.followed import Followed
from analysis.engine.span import compressed
from analysis.engine.system import Point, Prediction, System
from tests.analysis.engine.test_ring_fit import LetGo, ring


def test_the_span_keeps_every_product_and_noise_alone_has_its_own_variance() -> None:
    generator = np.random.default_rng(3)
    changes = generator.normal(size=(6, 400))
    changes[4] = changes[0] - 2.0 * changes[1]
    changes[5] = 0.0
    residual = 3.0 * changes[2] + generator.normal(size=400)
    inside, seen, noise = compressed(changes, residual)
    assert inside.shape == (4, 6), "one change is others together, and one is nothing"
    assert inside.T @ inside == pytest.approx(changes @ changes.T, abs=1e-6)
    assert inside.T @ seen == pytest.approx(changes @ residual, abs=1e-6)
    assert noise < 3.0


def test_what_nothing_spans_makes_everything_less_certain() -> None:
    generator = np.random.default_rng(4)
    changes = generator.normal(size=(5, 400))
    noise = generator.normal(size=400)
    _, _, quiet = compressed(changes, noise)
    _, _, loud = compressed(changes, 2.0 * noise)
    assert loud > 10.0 * quiet


def test_noise_that_is_known_from_few_samples_is_as_large_as_it_shows_to_be() -> None:
    generator = np.random.default_rng(5)
    changes = generator.normal(size=(5, 2000))
    residual = 1.1 * generator.normal(size=2000)
    _, _, unsure = compressed(changes, residual, allowed=1.3)
    assert unsure == pytest.approx(1.21, abs=0.1)
    _, _, beyond = compressed(changes, residual, allowed=1.05)
    assert beyond > 3.0 * unsure, "what noise does not allow may lie in any direction"


def test_however_many_samples_there_are_what_is_a_fiftieth_of_their_noise_tells_little() -> None:
    told = {}
    for count in (2_000, 200_000):
        generator = np.random.default_rng(6)
        changes = np.concatenate([generator.normal(size=(5, count)), np.ones((1, count))])
        missed = 0.02 * changes[-1]
        _, seen, noise = compressed(changes, generator.normal(size=count) + missed, 1.1)
        told[count] = count * 0.02**2 / noise
        assert float(seen @ seen) == pytest.approx(count * 0.02**2, abs=30.0)
    assert told[2_000] == pytest.approx(0.8, rel=0.2), "few samples say what they say"
    assert told[200_000] < 30.0, "many, no more than laws are exact"


def test_of_what_bends_the_whole_of_its_step_is_looked_at_as_well() -> None:
    class Bends(LetGo):
        """Its magnitude does nothing more beyond a tenth of its step."""

        candidates = tuple(replace(one, bends=True) for one in LetGo.candidates)

        def simulate(
            self, points: Sequence[Point], reduce: Callable[[Prediction], Any]
        ) -> list[Any]:
            return super().simulate([_capped(self, one) for one in points], reduce)

    system = Bends(ring(0.0, 0.0, 0.0, 0.0))
    found = faint(system, Followed(np.zeros(1), None), system.candidates)
    for one in system.candidates:
        looks = len([name for name, _ in found.terms if name == one.name])
        assert looks == 2 * len(one.variants())
        for k in range(len(one.terms)):
            little, whole = (
                float(np.linalg.norm(found.terms[one.name, look][:, k])) for look in (0, looks // 2)
            )
            assert whole == pytest.approx(0.1 * little, rel=0.1)


def _capped(system: System, point: Point) -> Point:
    steps = {(c.name, t.name): t.step for c in system.candidates for t in c.terms}
    effects = {
        name: replace(one, values={t: min(v, 0.1 * steps[name, t]) for t, v in one.values.items()})
        for name, one in point.effects.items()
    }
    return replace(point, effects=effects)


@pytest.mark.parametrize(("tone", "anew"), [(1e-4, False), (0.05, True)])
def test_what_candidates_do_is_not_simulated_again_beside_the_same_simulation(
    tone: float, anew: bool
) -> None:
    class Counted(LetGo):
        asked = 0

        def simulate(
            self, points: Sequence[Point], reduce: Callable[[Prediction], Any]
        ) -> list[Any]:
            self.asked += sum(bool(one.effects) for one in points)
            return super().simulate(points, reduce)

    system = Counted(ring(0.0, 0.0, 0.0, 0.0))
    first = faint(system, Followed(np.zeros(1), None), system.candidates)
    every, system.asked = system.asked, 0
    there = Followed(np.array([tone]), None)
    second = faint(system, there, system.candidates, near=first)
    assert system.asked == (every if anew else 0)
    alone = faint(system, there, system.candidates)
    for place, columns in alone.terms.items():
        # Directions are drawn anew each time: what they hold together is what counts.
        known, fresh = second.terms[place], columns
        assert known.T @ known == pytest.approx(fresh.T @ fresh, rel=1e-2)
        promised = second.problem.residual @ known
        assert promised == pytest.approx(alone.problem.residual @ fresh, rel=0.02)


def test_what_was_told_of_some_candidates_is_not_simulated_again_with_the_others() -> None:
    class Counted(LetGo):
        asked = 0

        def simulate(
            self, points: Sequence[Point], reduce: Callable[[Prediction], Any]
        ) -> list[Any]:
            self.asked += len(points)
            return super().simulate(points, reduce)

    system, there = Counted(ring(0.0, 0.0, 0.0, 0.0)), Followed(np.zeros(1), None)
    alone = faint(system, there, system.candidates)
    at_once, system.asked = system.asked, 0
    some = faint(system, there, system.candidates[:1])
    both = faint(system, there, system.candidates, near=some)
    assert system.asked == at_once
    assert both.terms.keys() == alone.terms.keys()
    for place, columns in alone.terms.items():
        assert both.terms[place].T @ both.terms[place] == pytest.approx(columns.T @ columns)
