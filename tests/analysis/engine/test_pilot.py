"""Several recordings of one oscillator: one leads the way, and all are led from there."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from analysis.engine import kin, lifting, pilot
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.by_ring import by_ring
from analysis.engine.candidate import Candidate, Term
from analysis.engine.chain import Chained, chained
from analysis.engine.cycles import Valley, information_of
from analysis.engine.diagnosis import diagnose
from analysis.engine.finder import Tell
from analysis.engine.followed import Followed
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.found import Found, Led, Start
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.hypothesis import Part as OfHypothesis
from analysis.engine.kin import lead_from
from analysis.engine.lifting import lifted
from analysis.engine.look import look
from analysis.engine.part import Part, records_of
from analysis.engine.pilot import _next, by_pilot
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.search import search
from analysis.engine.state import State
from analysis.engine.system import Nuisance, Point, Prediction, System

TONE_HZ, SIGMA, NOISE, OFFSET = 5.0, 0.01, 0.02, 0.05
T_S = np.arange(0.0, 20.0, 0.02)
HEIGHTS = {"low": 0.3, "middle": 1.0, "high": 2.0, "higher": 4.0}
"""How far each recording's oscillator was pulled before it was let go."""

DAMPING_1_PER_S, TONE = 0.2, 2.0

WANDERS = 0.5
"""Of the height."""


def cause(name: str, step: float) -> Candidate:
    return Candidate(name, name, "plant", (Term(name, name, "", "", 0.0, 2.0, step),))


class LetGoOften:
    """An oscillator of which the tone is known to a share; each recording has its own offset.

    What was recorded as `odd` wanders in a way that nothing simulates.
    """

    name = "let go often"
    nuisances: Sequence[Nuisance] = (
        Nuisance("tone", SIGMA, "1"),
        *(Nuisance(f"offset of {one}", OFFSET, "V", record=one) for one in HEIGHTS),
    )
    candidates: Sequence[Candidate] = (cause("damping", 0.1), cause("hardening", 0.01))

    def __init__(
        self,
        damping_1_per_s: float = DAMPING_1_PER_S,
        odd: Sequence[str] = (),
        hardening: float = 0.0,
    ) -> None:
        self.simulated: list[str] = []
        draw = np.random.default_rng(1)
        truth = [
            self._one(name, TONE, 0.5, damping_1_per_s, hardening)
            + WANDERS * HEIGHTS[name] * (name in odd) * np.sin(T_S**1.5)[:, None]
            for name in HEIGHTS
        ]
        rest, ringing = Segment(0.0, 1.0, None, 20.0, name="rest"), Segment(1.0, 20.0, None, 20.0)
        self.bundles = tuple(
            Bundle(
                ("y",), ("V",), T_S, value + NOISE * draw.standard_normal(value.shape),
                np.eye(1) * NOISE**2, (rest, ringing), record=name, tones_hz=(TONE_HZ,),
            )
            for name, value in zip(HEIGHTS, truth, strict=True)
        )  # fmt: skip
        self.simulated.clear()

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """See `System`."""
        return [reduce([self._of(point, k, one) for k, one in enumerate(HEIGHTS)])
                for point in points]  # fmt: skip

    def _of(self, point: Point, place: int, name: str) -> Array:
        if point.records and name not in point.records:
            return np.full((len(T_S), 1), np.nan)
        values = {one: point.effects[one].values[one] for one in point.effects}
        return self._one(
            name, float(point.nuisance[0]), float(point.nuisance[1 + place]),
            values.get("damping", 0.0), values.get("hardening", 0.0),
        )  # fmt: skip

    def _one(self, name: str, tone: float, offset: float, damping: float, harder: float) -> Array:
        self.simulated.append(name)
        since, height = np.maximum(T_S - 1.0, 0.0), HEIGHTS[name]
        turn = 2.0 * np.pi * TONE_HZ * (1.0 + SIGMA * tone + harder * height**2)
        ring = height * np.exp(-damping * since) * np.cos(turn * since)
        return np.asarray(ring * (T_S >= 1.0) + OFFSET * offset)[:, None]


def refiner(system: System) -> Refiner:
    return Refiner(system, *look(system))


def test_a_part_is_asked_for_its_own_recordings_alone() -> None:
    system = LetGoOften()
    part = Part(system, ("high",))
    assert [one.record for one in part.bundles] == ["high"]
    assert [one.name for one in part.nuisances] == ["tone", "offset of high"]
    (found,) = part.simulate([Point(np.array([1.0, 2.0]))], lambda prediction: prediction)
    assert system.simulated == ["high"]
    assert found[0] == pytest.approx(system._one("high", 1.0, 2.0, 0.0, 0.0))


def test_a_parts_nuisances_and_the_wholes_are_told_from_each_other() -> None:
    part = Part(LetGoOften(), ("high",))
    whole = part.whole(np.array([1.0, 2.0]), beside=np.full(5, 7.0))
    assert whole == pytest.approx([1.0, 7.0, 7.0, 2.0, 7.0])
    assert part.own(whole) == pytest.approx([1.0, 2.0])


def test_the_pilot_is_the_recording_that_is_least_off_and_was_not_tried() -> None:
    system = LetGoOften()
    assert _next(system, np.zeros(5), []) == "low"
    assert _next(system, np.zeros(5), ["low"]) == "middle"
    assert _next(system, np.zeros(5), records_of(system)) is None


def test_where_no_ring_leads_what_a_pilots_lines_tell_is_led_through_all(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Sequence[str]] = []

    def lost(
        refiner: Refiner,
        most_causes: int,
        tell: Tell | None,
        start: Start | None = None,
        enough: Callable[[Followed], bool] | None = None,
    ) -> Found:
        asked.append(records_of(refiner.system))
        nothing = follow_ring(refiner.system, refiner.calibrated.at, everything=True)
        search = FollowedSearch(refiner, nothing, most_causes, enough=enough)
        return Found((), (), faint=False, led=Led(search, []))

    monkeypatch.setattr(pilot, "by_ring", lost)
    found = by_pilot(refiner(LetGoOften()), 2, None)
    assert len(asked) == 1
    assert found.fitted[0].hypothesis.names == ("damping",)
    damping = found.fitted[0].values["damping", "damping"]
    assert damping == pytest.approx(DAMPING_1_PER_S, abs=2e-3)


def test_what_is_left_out_is_found_in_all_with_fewer_simulations_of_all() -> None:
    alone, piloted = LetGoOften(), LetGoOften()
    by_windows = by_ring(refiner(alone), 2, None)
    by_one = by_pilot(refiner(piloted), 2, None)
    for found in (by_windows, by_one):
        assert found.fitted[0].hypothesis.names == ("damping",)
        damping = found.fitted[0].values["damping", "damping"]
        assert damping == pytest.approx(DAMPING_1_PER_S, abs=2e-3)
    assert by_one.screened[0].hypothesis.names == ("damping",)
    assert by_one.fitted[0].left == pytest.approx(by_windows.fitted[0].left, abs=0.01)
    # Three of the four wait until one has told what is left out.
    assert piloted.simulated.count("higher") < alone.simulated.count("higher")


@pytest.mark.parametrize(
    ("comes_through", "led"),
    [(True, ["damping", "other"]), (False, ["damping", "damping+hardening", "other"])],
)
def test_what_has_a_kind_more_or_less_than_what_came_through_is_left_to_the_search_from_there(
    monkeypatch: pytest.MonkeyPatch, comes_through: bool, led: list[str]
) -> None:
    system, tried = LetGoOften(), []
    system.candidates = (*system.candidates, cause("other", 0.1))
    known = {one.name: one for one in system.candidates}

    def state(names: tuple[str, ...]) -> State:
        hypothesis = Hypothesis({one: OfHypothesis((one,)) for one in names})
        return State.at(hypothesis, {(one, one): 0.1 for one in names}, known)

    def spied(whole: System, first: Valley, *_: object) -> Chained:
        tried.append("+".join(first.led.names))
        return Chained(np.zeros(5), first.led.state, (), "" if comes_through else "high")

    monkeypatch.setattr(lifting, "chained", spied)
    sets = (("damping",), ("damping", "hardening"), ("other",))
    part = Part(system, ("low",))
    found = [Followed(np.zeros(2), state(names)) for names in sets]
    came = lifted(system, part, found, np.zeros(5)).free
    assert tried == led
    assert len(came) == (2 if comes_through else 0)


@pytest.mark.parametrize(
    ("odd", "aside", "stuck"),
    [((), (), ""), (("high",), ("high",), ""), (("middle", "high"), (), "high")],
)
def test_a_law_may_fail_in_one_recording_of_four_and_no_more(
    odd: tuple[str, ...], aside: tuple[str, ...], stuck: str
) -> None:
    system = LetGoOften(odd=odd)
    part, known = Part(system, ("low",)), {one.name: one for one in system.candidates}
    law = Hypothesis({"damping": OfHypothesis(("damping",))})
    state = State.at(law, {("damping", "damping"): DAMPING_1_PER_S}, known)
    at = follow_ring(part, np.zeros(2), state, everything=True)
    led = chained(system, Valley(at, information_of(part, at)), ("low",), np.zeros(5))
    assert led.stuck == stuck
    assert led.aside == aside


def test_what_holds_in_more_recordings_is_weighed_by_them(monkeypatch: pytest.MonkeyPatch) -> None:
    system = LetGoOften()
    known = {one.name: one for one in system.candidates}
    fails = {"damping": ("high",), "hardening": ()}

    def spied(whole: System, first: Valley, *_: object) -> Chained:
        (name,) = first.led.names
        return Chained(np.zeros(5), first.led.state, (), aside=fails[name])

    monkeypatch.setattr(lifting, "chained", spied)
    laws = {name: Hypothesis({name: OfHypothesis((name,))}) for name in fails}
    states = [State.at(law, {(name, name): 0.1}, known) for name, law in laws.items()]
    found = [Followed(np.zeros(2), state) for state in states]
    came = lifted(system, Part(system, ("low",)), found, np.zeros(5))
    assert came.aside == ()
    assert [one.names for one in came.free] == [("hardening",)]


def law_of(system: LetGoOften, *names: str) -> State:
    known = {one.name: one for one in system.candidates}
    hypothesis = Hypothesis({one: OfHypothesis((one,)) for one in names})
    return State.at(hypothesis, {(one, one): DAMPING_1_PER_S for one in names}, known)


def test_where_a_law_cannot_be_led_on_that_recording_says_what_there_is_beside_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    system = LetGoOften()
    asked: list[tuple[tuple[str, ...], Start]] = []

    def stuck_alone(whole: System, first: Valley, *_: object) -> Chained:
        stuck = "high" if first.led.names == ("damping",) else ""
        return Chained(np.zeros(5), first.led.state, ("low",), stuck)

    def both(
        of: Refiner,
        most_causes: int,
        tell: Tell | None,
        start: Start,
        enough: Callable[[Followed], bool],
    ) -> Found:
        assert isinstance(of.system, Part)
        asked.append((of.system.records, start))
        told = enough(Followed(start.nuisance, law_of(system, "damping", "hardening")))
        return Found((), (), faint=told)

    def weighed(of: Refiner, begun: Sequence[Followed], *_: object) -> Found:
        return Found((), [of.standing(one.state, one.nuisance) for one in begun if one.state], True)

    monkeypatch.setattr(lifting, "chained", stuck_alone)
    monkeypatch.setattr(lifting, "by_ring", both)
    monkeypatch.setattr(lifting, "but_for", weighed)
    whole = lifting.Lifting(refiner(system), Part(system, ("low",)), np.zeros(5), 2, None)
    assert whole.enough(Followed(np.zeros(2), law_of(system, "damping")))
    ((records, start),) = asked
    assert records == ("low", "high")
    assert start.stuck
    assert [one.names for one in start.hypotheses] == [("damping",)]
    assert whole.said.fitted[0].hypothesis.names == ("damping", "hardening")


def test_beside_a_law_that_could_not_be_led_on_one_cause_more_is_asked_for_first() -> None:
    system = LetGoOften(hardening=5e-4)
    own = refiner(Part(system, ("low", "high")))
    nothing = Followed(np.zeros(3), None, misfit=1e9)
    search = FollowedSearch(own, nothing, 2, near=True)
    search.follow_from(
        [Followed(np.array([TONE, 0.5, 0.5]), law_of(system, "damping"))], stuck=True
    )
    assert [one.names for one in search._led[:2]] == [("damping",), ("damping", "hardening")]
    found = search.fitted()
    assert found is not None
    assert found[0].hypothesis.names == ("damping", "hardening")
    assert found[0].values["hardening", "hardening"] == pytest.approx(5e-4, rel=0.1)


@pytest.mark.parametrize(("records", "begins"), [(("low",), 2), (tuple(HEIGHTS), 1)])
def test_beside_parameters_that_are_bent_several_recordings_are_led_from_there_alone(
    monkeypatch: pytest.MonkeyPatch, records: tuple[str, ...], begins: int
) -> None:
    system = LetGoOften()
    part, starts = Part(system, records), []

    def spied(of: System, nuisance: Array, state: State, **how: object) -> Followed:
        starts.append(float(nuisance[0]))
        return Followed(nuisance, state, share=0.5)

    monkeypatch.setattr(kin, "follow_ring", spied)
    bent = np.full(len(part.nuisances), 5.0)
    lead_from(part, Followed(bent, law_of(system, "damping")), law_of(system, "hardening"))
    assert starts == [0.0, 5.0][-begins:]


def test_a_recording_in_which_the_law_does_not_hold_stands_aside_and_leaves_doubt() -> None:
    found = diagnose(LetGoOften(odd=("high",)))
    assert found.search is not None
    assert found.search.aside == ("high",)
    best = found.search.fitted[0]
    assert best.hypothesis.names == ("damping",)
    assert best.values["damping", "damping"] == pytest.approx(DAMPING_1_PER_S, abs=2e-3)
    assert best.left == pytest.approx(1.0, abs=0.05)
    # Nuisances are those of all recordings.
    assert len(best.point.nuisance) == 1 + len(HEIGHTS)
    assert best.point.nuisance[0] == pytest.approx(TONE, abs=0.02)
    assert found.confirmation is not None
    assert found.confirmation.held_record not in ("", "high")
    assert found.confirmation.after["held_out"][""] == pytest.approx(1.0, abs=0.1)
    assert found.judgement is not None
    assert found.judgement.doubt == pytest.approx(0.5 / len(HEIGHTS), abs=0.02)


def test_where_nothing_is_left_out_all_come_to_the_noise() -> None:
    found = search(LetGoOften(damping_1_per_s=0.0))
    assert found.faint
    assert found.fitted[0].hypothesis.names == ()
    assert found.fitted[0].left == pytest.approx(1.0, abs=0.05)
