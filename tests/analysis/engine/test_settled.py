"""Hypotheses that do not ring stay at the noise, whatever is forgiven to the form of a law."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from analysis.engine import Bundle, Candidate, Nuisance, Point, Segment, Term, diagnose
from analysis.engine.system import Prediction

T_S = np.arange(0.0, 20.0, 0.1)
NOISE = 0.01


class Bent:
    """A line that is bent by forty volts, whose slope is off by one volt, one of its sigmas."""

    name = "line"
    nuisances = (Nuisance("offset", 0.3, "V"), Nuisance("slope", 0.05, "V/s"))
    candidates = (
        Candidate("bend", "bend", "plant", (Term("bend", "bend", "V/s^2", "", -0.2, 0.2, 0.01),),
                  form_share=0.2),
        Candidate("ripple", "ripple", "cell", (Term("ripple", "ripple", "V", "", 0.0, 1.0, 0.1),)),
    )  # fmt: skip

    def __init__(self) -> None:
        noise = np.random.default_rng(0).normal(0.0, NOISE, len(T_S))
        value = T_S * 1.05 - 0.3 + 0.1 * T_S**2 + noise
        parts = (Segment(0.0, 14.0, name="first"), Segment(14.0, 20.0, held_out=True, name="last"))
        self.bundles = (Bundle(("x",), ("V",), T_S, value[:, None], np.array([[NOISE**2]]), parts),)

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        return [reduce([self._at(point)[:, None]]) for point in points]

    def _at(self, point: Point) -> Any:
        offset, slope = (
            one.sigma * x for one, x in zip(self.nuisances, point.nuisance, strict=True)
        )
        on = {name: one.values[name] for name, one in point.effects.items()}
        y = T_S * (1.0 + slope) + offset + on.get("bend", 0.0) * T_S**2
        return y + on.get("ripple", 0.0) * np.sin(T_S)


def test_parameters_come_to_the_noise_beside_a_law_of_uncertain_form() -> None:
    found = diagnose(Bent())
    assert found.verdict == "explained"
    assert [one.name for one in found.judgement.causes] == ["bend"]
    assert found.remains.misfit < 1.06
    assert np.abs(found.judgement.chosen.point.nuisance - [-1.0, 1.0]).max() < 0.1


def test_a_parameter_that_is_far_off_and_nobodys_is_told_of() -> None:
    system = Bent()
    (bundle,) = system.bundles
    system.bundles = (replace(bundle, value=bundle.value + 0.25 * T_S[:, None]),)
    (note,) = diagnose(system).notes
    assert note.startswith("nuisance 'slope' fits +6.0 sigmas")


def test_a_law_that_leaves_much_stays_where_its_form_is_forgiven() -> None:
    system = Bent()
    (bundle,) = system.bundles
    kinked = bundle.value + np.abs(T_S - 9.0)[:, None]
    system.bundles = (replace(bundle, value=kinked),)
    found = diagnose(system)
    assert found.remains.misfit > 100.0
