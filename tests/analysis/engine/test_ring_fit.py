"""The ring on an oscillator that is let go: its phase, what leads there, and what cannot."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine import ring_fit
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.faint import faint
from analysis.engine.faint_search import one_more
from analysis.engine.followed import Followed, Lent
from analysis.engine.hypothesis import Hypothesis, Part
from analysis.engine.lens import Lens
from analysis.engine.look import look
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import FAINT, follow_ring, is_far
from analysis.engine.ring_samples import Samples
from analysis.engine.sharpen import sharpened
from analysis.engine.state import Number, State
from analysis.engine.system import Nuisance, Point, Prediction
from analysis.engine.way import Way

TONE_HZ, SIGMA = 5.0, 0.01
"""The tone, and how well it is known: over 20 s its phase is not known at all."""

T_S = np.arange(0.0, 20.0, 0.02)


def ring(
    tone_share: float, damping_1_per_s: float, step: float, moment_s: float, t_s: Array = T_S
) -> Array:
    """Let go at 1 s, shape (n, 1); from a moment on the channel is off by a step."""
    since = np.maximum(t_s - 1.0, 0.0)
    phase = 2.0 * np.pi * TONE_HZ * (1.0 + tone_share) * since
    value = np.exp(-damping_1_per_s * since) * np.sin(phase)
    return np.asarray(value + step * (moment_s <= t_s))[:, None]


DAMPING = Candidate(
    "damping", "damping", "plant", (Term("rate", "rate", "1/s", "", 0.0, 2.0, 0.1),)
)
STEP = Candidate(
    "step", "a step of the channel", "cell", (Term("high", "high", "V", "", -5.0, 5.0, 0.5),),
    (Shape("moment", "s", 2.0, 0.0, 20.0, tuple(np.arange(2.0, 19.0, 2.0)), logarithmic=False,
           whole=True, finest=0.05),),
)  # fmt: skip


class LetGo:
    """An oscillator of which the tone is known to a share."""

    name = "let go"
    nuisances: Sequence[Nuisance] = (Nuisance("tone", SIGMA, "1"),)
    candidates: Sequence[Candidate] = (DAMPING, STEP)

    def __init__(self, value: Array, noise: float = 0.02, t_s: Array = T_S) -> None:
        self.t_s, end_s = t_s, float(t_s[-1] + t_s[1])
        noisy = value + noise * np.random.default_rng(1).standard_normal(value.shape)
        self.bundles = (
            Bundle(
                ("y",), ("V",), t_s, noisy, np.eye(1) * noise**2,
                (Segment(0.0, 1.0, None, 20.0, name="rest"), Segment(1.0, end_s, None, 20.0)),
                tones_hz=(TONE_HZ,),
            ),
        )  # fmt: skip

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._one(point)]) for point in points]

    def _one(self, point: Point) -> Array:
        damping, step = point.effects.get("damping"), point.effects.get("step")
        return ring(
            SIGMA * float(point.nuisance[0]),
            damping.values["rate"] if damping else 0.0,
            step.values["high"] if step else 0.0,
            step.shapes["moment"] if step else 0.0,
            self.t_s,
        )


def state_of(candidate: Candidate, value: float, **shapes: float) -> State:
    (term,) = candidate.terms
    hypothesis = Hypothesis({candidate.name: Part((term.name,), shapes=shapes)})
    number = Number(candidate.name, (term.name,), None, term.low, term.high, 0.02 * term.step)
    return State(hypothesis, {candidate.name: candidate}, (number,), np.array([value]))


def test_a_tone_two_sigmas_off_is_led_to_the_recordings_phase() -> None:
    system = LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0))
    found = follow_ring(system, np.zeros(1))
    assert found.share == 1.0
    assert found.left == pytest.approx(1.0, abs=0.1)
    assert found.nuisance[0] == pytest.approx(2.0, abs=0.01)


def test_a_ring_a_thousand_times_the_noise_is_followed_from_its_first_cycle_on() -> None:
    system = LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0), noise=2e-4)
    found = follow_ring(system, np.zeros(1))
    assert found.share == 1.0
    assert found.left == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("noise", [0.6, 0.8])
def test_a_faint_ring_two_turns_out_of_phase_is_followed_too(noise: float) -> None:
    found = follow_ring(LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0), noise), np.zeros(1))
    assert found.left == pytest.approx(1.0, abs=0.1)
    assert found.nuisance[0] == pytest.approx(2.0, abs=0.05)


def test_what_was_led_over_a_first_part_has_come_as_far_as_that() -> None:
    """Though it is lost before the next stretch: else what begins nowhere would count for more."""
    late = 5.0 * np.sin(2.0 * np.pi * 1.1 * TONE_HZ * T_S)[:, None] * (T_S[:, None] > 3.0)
    system = LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0) + late)
    found = follow_ring(system, np.array([2.0]), passed=0.14)
    assert not found.to_end
    share, cost = found.reached
    assert share == 0.12, "the last of the stretches that lie in it"
    inside = int((T_S <= 0.12 * 20.0).sum())
    assert cost == pytest.approx(inside, rel=0.3)


def test_out_of_patience_what_is_stuck_above_the_noise_is_not_led_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    late = 0.6 * np.sin(2.0 * np.pi * 1.1 * TONE_HZ * T_S)[:, None] * (T_S[:, None] > 8.0)
    stuck = LetGo(ring(2.0 * SIGMA, 0.0, 0.15, 1.1) + late, noise=0.2)
    damping = state_of(DAMPING, 0.02)
    patient = follow_ring(stuck, np.zeros(1), damping)
    assert patient.to_end
    monkeypatch.setattr(ring_fit, "PATIENCE", -1e6)
    given_up = follow_ring(stuck, np.zeros(1), damping)
    assert not given_up.to_end
    assert given_up.effort < 0.5 * patient.effort
    at_the_noise = LetGo(ring(2.0 * SIGMA, 0.0, 0.0, 0.0), noise=0.2)
    assert follow_ring(at_the_noise, np.zeros(1), damping).to_end


@pytest.mark.parametrize(("off", "share"), [(0.0, 1.0), (0.4, 0.45)], ids=["in phase", "not"])
def test_what_a_law_leaves_throughout_is_gone_over_at_once_where_it_rings_in_phase(
    off: float, share: float
) -> None:
    # Twice the noise that is stated, as a law leaves that is not exact; a late tone out of phase.
    system = LetGo(ring(0.0, 0.0, 0.0, 0.0), noise=0.02)
    (bundle,) = system.bundles
    late = off * np.sin(2.0 * np.pi * TONE_HZ * T_S)[:, None] * (T_S[:, None] > 9.0)
    system.bundles = (
        replace(bundle, value=bundle.value + late, covariance=0.5 * bundle.covariance),
    )
    samples = Samples(system, everything=True)
    law = Way(samples, Followed(np.zeros(1), state_of(DAMPING, 0.0)))
    assert law.left(0.27) == pytest.approx(2.0, rel=0.2)
    assert law.window(0.27) == share
    # Parameters leave noise alone.
    assert Way(samples, Followed(np.zeros(1), None)).window(0.27) == 0.45


def test_no_more_is_simulated_than_is_looked_at() -> None:
    asked: list[float] = []

    class Asked(LetGo):
        def simulate(
            self, points: Sequence[Point], reduce: Callable[[Prediction], Any]
        ) -> list[Any]:
            asked.extend(one.upto for one in points)
            return super().simulate(points, reduce)

    follow_ring(Asked(ring(2.0 * SIGMA, 0.0, 0.0, 0.0)), np.zeros(1))
    assert min(asked) < 0.1
    assert max(asked) == 1.0
    assert sum(asked) < 0.6 * len(asked)


def test_a_ring_that_dies_away_is_followed_no_further_than_parameters_lead() -> None:
    system = LetGo(ring(2.0 * SIGMA, 0.2, 0.0, 0.0))
    alone = follow_ring(system, np.zeros(1))
    assert alone.share < 0.5
    assert alone.left > FAINT
    led = follow_ring(system, np.zeros(1), state_of(DAMPING, 0.02))
    assert led.share == 1.0
    assert led.left == pytest.approx(1.0, abs=0.1)
    assert led.state is not None
    assert led.state.values[0] == pytest.approx(0.2, abs=0.005)


def test_what_cannot_be_followed_further_names_its_cause() -> None:
    system = LetGo(ring(2.0 * SIGMA, 0.2, 0.0, 0.0))
    found = look(system)
    refiner = Refiner(system, found.lens, found.data, found.calibrated)
    alone = follow_ring(system, np.zeros(1), everything=True)
    promises = one_more(faint(system, alone, system.candidates), refiner)
    assert promises[0].hypothesis.names == ("damping",)


def test_what_falls_behind_another_is_not_followed_to_the_end() -> None:
    system = LetGo(ring(2.0 * SIGMA, 0.2, 0.0, 0.0))
    best = follow_ring(system, np.zeros(1), state_of(DAMPING, 0.02))
    wrong = follow_ring(system, np.zeros(1), state_of(STEP, 0.1, moment=4.0), ahead=best.costs)
    assert len(wrong.costs) < len(best.costs)


def test_the_moment_of_an_event_is_found_between_those_that_are_tried() -> None:
    system = LetGo(ring(0.0, 0.0, 1.0, 7.3))
    lens = Lens(list(system.bundles))

    def score(state: State) -> float:
        (seen,) = system.simulate([state.point(np.zeros(1))], lens)
        return -float(np.sum((lens.of_data() - seen) ** 2))

    found = sharpened(state_of(STEP, 1.0, moment=2.0), score)
    assert found.hypothesis.parts["step"].shapes["moment"] == pytest.approx(7.3, abs=0.05)


class _Many(LetGo):
    """With seven parameters more that do nothing, so that differences cost something."""

    nuisances = (*LetGo.nuisances, *(Nuisance(f"idle {k}", 1.0, "1") for k in range(7)))


def test_what_parameters_do_about_one_hypothesis_serves_the_next() -> None:
    """The same end, and of differences only those of what is on are simulated."""
    system = _Many(ring(2.0 * SIGMA, 0.2, 0.0, 0.0))
    law = follow_ring(system, np.zeros(8), state_of(DAMPING, 0.02), everything=True)
    assert law.lends is not None
    elsewhere = law.lends._replace(left=law.lends.left + 1.0)
    near = state_of(DAMPING, 0.19)
    own = follow_ring(system, law.nuisance, near, everything=True, near=True)
    lent = follow_ring(system, law.nuisance, near, everything=True, near=True, lent=elsewhere)
    assert lent.borrowed
    assert not own.borrowed
    assert lent.misfit == pytest.approx(own.misfit, abs=0.5)
    assert lent.effort < own.effort - 7.0


def test_what_was_lent_and_does_not_hold_is_simulated_anew() -> None:
    system = _Many(ring(2.0 * SIGMA, 0.2, 0.0, 0.0))
    law = follow_ring(system, np.zeros(8), state_of(DAMPING, 0.02), everything=True)
    assert law.lends is not None
    wrong = Lent(-law.lends.columns, law.lends.left + 1.0)
    found = follow_ring(
        system,
        law.nuisance + np.eye(8)[0] * 0.3,
        law.state,
        everything=True,
        near=True,
        lent=wrong,
    )
    assert not found.borrowed
    assert found.misfit < law.misfit + 0.5


def test_what_parameters_do_about_what_comes_to_the_same_is_not_simulated_again() -> None:
    """Neither to go on from there, nor to tell what nuisances do at the end."""
    system = _Many(ring(2.0 * SIGMA, 0.2, 0.0, 0.0))
    law = follow_ring(system, np.zeros(8), state_of(DAMPING, 0.02), everything=True)
    assert law.fresh
    assert law.state is not None
    again = follow_ring(system, law.nuisance, law.state, everything=True, near=True, lent=law.lends)
    assert again.fresh
    assert not again.borrowed
    assert again.effort < 7.0


def test_what_stays_far_behind_is_not_led_on_with_fresh_differences() -> None:
    system = _Many(ring(2.0 * SIGMA, 0.2, 0.0, 0.0), noise=0.07)
    law = follow_ring(system, np.zeros(8), state_of(DAMPING, 0.02), everything=True)
    step = state_of(STEP, 0.1, moment=9.0)

    def effort(ahead: dict[float, float]) -> float:
        found = follow_ring(system, law.nuisance, step, everything=True, near=True, ahead=ahead)
        assert found.misfit > 20.0 * law.misfit
        return found.effort

    assert effort({1.0: law.misfit}) < effort({})


def test_starts_are_told_from_each_other() -> None:
    assert state_of(DAMPING, 0.2).is_about(state_of(DAMPING, 0.21))
    assert not state_of(DAMPING, 0.2).is_about(state_of(DAMPING, 0.4))
    assert not state_of(DAMPING, 0.2).is_about(state_of(STEP, 0.2, moment=9.0))
    assert not state_of(STEP, 0.2, moment=9.0).is_about(state_of(STEP, 0.2, moment=9.5))


@pytest.mark.parametrize(
    ("numbers", "sigmas", "far"), [(100, 1.05, True), (100, 0.95, False), (20, 1.9, False)]
)
def test_parameters_are_bent_by_more_than_a_sigma_each_and_by_more_than_a_few_together(
    numbers: int, sigmas: float, far: bool
) -> None:
    assert is_far(Followed(np.full(numbers, sigmas), None)) is far
