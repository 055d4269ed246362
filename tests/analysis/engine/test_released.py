"""Parameters of several kinds that are off, where all of them were bent for it."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Term
from analysis.engine.released import released
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.system import Nuisance, Point, Prediction

TIMES_S = np.arange(0.0, 2.0, 0.005)
NOISE, SIGMA = 0.05, 0.01
PLACES = "abcd"
DOES = {
    ("length", "length@a"): (3.0, 1.0, 0.2),
    ("length", "length@b"): (0.5, 3.0, 1.0),
    ("length", "length@c"): (1.0, 0.4, 3.0),
    ("length", "length@d"): (2.0, 2.0, 0.5),
    ("weight", "weight"): (1.0, -2.0, 2.0),
}
"""What one sigma of each does along three tones, in tenths of the noise: five share three."""


def term(name: str) -> Term:
    return Term(name, name.split("@", maxsplit=1)[0], "m", name.partition("@")[2], -1.0, 1.0, 0.1)


LENGTH = Candidate("length", "length", "parameter", tuple(term(f"length@{p}") for p in PLACES))
WEIGHT = Candidate("weight", "weight", "parameter", (term("weight"),))


LAW = Candidate("law", "law", "plant", (Term("size", "size", "V", "", 0.0, 1.0, 0.1),))
KNOWN = {one.name: one for one in (LENGTH, WEIGHT, LAW)}


class _Machine:
    """Its parameters are all that there is."""

    name = "machine"
    nuisances = tuple(Nuisance(name, SIGMA, "m", cause, name) for cause, name in DOES)
    candidates = (LENGTH, WEIGHT, LAW)

    def __init__(self, off: dict[tuple[str, str], float]) -> None:
        sigmas = np.array([off.get(one, 0.0) for one in DOES])
        noise = NOISE * np.random.default_rng(3).normal(size=len(TIMES_S))
        seen = self._seen(Point(sigmas, {})) + noise
        whole = (Segment(0.0, 2.0, None, 20.0),)
        self.bundles = (
            Bundle(("y",), ("V",), TIMES_S, seen[:, None], np.eye(1) * NOISE**2, whole),
        )

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._seen(one)[:, None]]) for one in points]

    def _seen(self, point: Point) -> Array:
        sigmas = point.nuisance.copy()
        for i, (cause, name) in enumerate(DOES):
            if cause in point.effects:
                sigmas[i] += point.effects[cause].values.get(name, 0.0) / SIGMA
        # A second-order part: straight lines are off by a tenth at thirty sigmas.
        sizes = np.array(list(DOES.values())).T @ (sigmas + 0.003 * sigmas**2)
        tones = [np.sin(2.0 * np.pi * k * TIMES_S) for k in (1, 3, 8)]
        return np.asarray(0.1 * NOISE * sizes @ tones)


@pytest.mark.parametrize(
    "off",
    [
        {("length", "length@b"): 20.0, ("weight", "weight"): -25.0},
        {("length", "length@c"): -15.0},
        {("length", "length@a"): 12.0, ("length", "length@c"): 30.0},
    ],
    ids=["of two kinds", "one", "two of a kind"],
)
def test_the_few_that_are_off_are_told_from_all_that_were_bent(
    off: dict[tuple[str, str], float],
) -> None:
    system = _Machine(off)
    nothing = follow_ring(system, np.zeros(len(DOES)), everything=True, near=True)
    assert nothing.strain > len(DOES)
    found = list(released(system, Samples(system, everything=True), nothing, KNOWN, 3))
    assert found
    assert found[-1].state is not None
    values = found[-1].state.term_values()
    assert set(values) == set(off)
    for one, sigmas in off.items():
        assert values[one] == pytest.approx(sigmas * SIGMA, rel=0.1)
    assert found[-1].strain < len(DOES)
    # Laws may take their place.
    assert "law" in found[-1].state.candidates


def test_nothing_is_released_where_parameters_are_near_what_is_known_of_them() -> None:
    system = _Machine({("length", "length@b"): 0.8})
    nothing = follow_ring(system, np.zeros(len(DOES)), everything=True, near=True)
    samples = Samples(system, everything=True)
    assert not list(released(system, samples, nothing, KNOWN, 3))
