"""Differences of a number of which one standard deviation turns a loud tone many times."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate
from analysis.engine.differences import differences
from analysis.engine.followed import STEP, Followed
from analysis.engine.ring_samples import Samples
from analysis.engine.system import Nuisance, Point, Prediction

T_S = np.arange(0.0, 20.0, 0.02)
TONE_HZ, SHARE = 5.0, 0.15
LOUD = 30.0
"""Height of the tone, in units of noise."""


class Loud:
    """A loud tone whose frequency is hardly known, and an offset."""

    name = "loud"
    nuisances: Sequence[Nuisance] = (Nuisance("tone", SHARE, "1"), Nuisance("offset", 1.0, "V"))
    candidates: Sequence[Candidate] = ()

    def __init__(self) -> None:
        self.bundles = (
            Bundle(
                ("y",), ("V",), T_S, self._one(np.zeros(2)), np.eye(1),
                (Segment(0.0, float(T_S[-1]) + 0.01, None, 20.0),), record="only",
                tones_hz=(TONE_HZ,),
            ),
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point.nuisance)]) for point in points]

    @staticmethod
    def _one(nuisance: Array) -> Array:
        tone, offset = nuisance
        return np.asarray(LOUD * np.sin(_turns(tone)) + offset)[:, None]


def _turns(tone: float) -> Array:
    return np.asarray(2.0 * np.pi * TONE_HZ * (1.0 + SHARE * tone) * T_S)


def test_what_turns_a_loud_tone_is_told_by_finer_differences() -> None:
    samples, at = Samples(Loud(), everything=True), Followed(np.array([0.3, 0.0]), None)
    (here,) = samples.residuals([at.point])
    found, steps = differences(samples, at, here)
    does = LOUD * np.cos(_turns(0.3)) * 2.0 * np.pi * TONE_HZ * SHARE * T_S
    ends = samples.residuals([Followed(np.array([0.3 + STEP, 0.0]), None).point])
    coarse = (here - ends[0]) / STEP
    size = np.linalg.norm(does)
    assert steps == pytest.approx([STEP, STEP])
    # One number's error must stay below what another, that is known by the noise alone, does.
    assert np.linalg.norm(coarse - does) > 10.0 * np.linalg.norm(found[1])
    assert np.linalg.norm(found[0] - does) < 1e-5 * size
    assert np.linalg.norm(found[0] - does) < 0.05 * np.linalg.norm(found[1])
    assert found[1] == pytest.approx(np.ones(len(T_S)), rel=1e-9)


def test_numbers_that_are_known_are_not_asked_again() -> None:
    samples, at = Samples(Loud(), everything=True), Followed(np.array([0.3, 0.0]), None)
    (here,) = samples.residuals([at.point])
    found, steps = differences(samples, at, here, known=1)
    assert found.shape == (1, len(T_S))
    assert len(steps) == 2
    nothing, _ = differences(samples, at, here, known=2)
    assert nothing.shape == (0, len(T_S))
