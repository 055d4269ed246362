"""Hypotheses led to the ring's phase, each for itself, and what all samples then say of them."""

from collections.abc import Sequence
from dataclasses import replace

from analysis.engine.all_samples import (
    all_samples_say,
    cost_of,
    farthest_first,
    led_through,
    misfit_at,
    nothing_again,
    through,
)
from analysis.engine.exchange import plainest, rivals
from analysis.engine.faint import Faint, faint
from analysis.engine.faint_search import nuisances_of, one_more, others_beside
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.judge import NOISE
from analysis.engine.kin import (
    kin_alike,
    kin_left,
    kin_of,
    lead_from,
    lead_instead,
    part_of_the_way,
)
from analysis.engine.part import records_of
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.ring_samples import Samples
from analysis.engine.screen import Scored
from analysis.engine.sensitivity import Progress
from analysis.engine.sharpen import sharpened
from analysis.engine.state import State
from analysis.engine.system import Array
from analysis.engine.way import HOPELESS

RESTARTS = 1
"""Nothing is led to the phase once more from where so many hypotheses have come: one may have found
a way that nothing missed."""

MORE = 2
"""Beside the best that was led to the phase, one cause more is tried, of so many kinds."""

EFFORT, RECORDS = 3000.0, 4
"""Whole simulations, after which nothing new is tried; fewer, of more recordings than that."""

ARRIVED = 2.5
"""What was led to the end speaks for every sample, where no more than this is left of the squared
misfit of one, on average: laws are not exact."""

EARLY = 0.03
"""Where none of the first that were tried can be led so much farther than parameters alone, as a
share of the time, the ring tells nothing of what is left out."""

EXPLAINS = 0.05
"""Beside a law that was led to the end, one cause more is tried where it promises to explain this
share of what that leaves."""

WORTH_IT = 30.0
"""Where it then does no better than this, in squared misfit, what it is, or may be without, is not
asked."""

CLOSE = 60.0
"""Without a cause that does nothing, the squared misfit rises by no more than this."""

EXCHANGES = 2
"""From what rivals have led to, rivals are looked for once more: so often at a time."""

FAR_BEHIND = 15.0
"""What promises to stay this far behind is not led to the phase."""


class FollowedSearch:
    """Hypotheses led to the ring's phase, each for itself, and with one cause more where it asks.

    Parameters
    ----------
    refiner
        Made the hypotheses.
    nothing
        How far parameters alone lead.
    most_causes
        Of a hypothesis.
    progress
        Told of it.
    near
        All hypotheses are near the ring's phase, and their scores tell what each can come to.
    """

    def __init__(
        self,
        refiner: Refiner,
        nothing: Followed,
        most_causes: int,
        progress: Progress | None = None,
        *,
        near: bool = False,
    ) -> None:
        self._refiner = refiner
        self._system = refiner.system
        self._nothing = nothing
        self._most_causes = most_causes
        self._progress = progress
        self._near = near
        self._samples = Samples(self._system, everything=True)
        self._led: list[Followed] = []
        self._tried: set[tuple[str, ...]] = set()
        self._begun: list[State] = []
        self._effort = 0.0
        self._asked: Faint | None = None
        self._exchanged: set[tuple[str, ...]] = set()
        self._most = EFFORT * min(1.0, RECORDS / len(records_of(self._system)))

    def follow(
        self, hypotheses: Sequence[Fitted], others: Sequence[Fitted], *, guessed: bool = False
    ) -> None:
        """Lead hypotheses to the ring's phase.

        Parameters
        ----------
        hypotheses
            Those to try, the null not among them; what was led to the end is not led again.
        others
            Single causes, the best first: laws of the same things as what comes far are tried too.
        guessed
            In which places they are was told over a short stretch.
        """
        for number, one in enumerate(self._fresh(hypotheses)):
            if number > 0 and (self._effort > self._most or self._is_kin(one)):
                continue
            self._lead(one.point.nuisance, one.state, near=self._near)
        if not self._led:
            return
        nowhere = self._best.share < self._nothing.share + EARLY and not self._best.to_end
        if nowhere and not self._near:
            return
        least = max((one.log_score for one in hypotheses), default=0.0) - FAR_BEHIND
        for one in self._fresh(kin_of(self._best, self._led, others, self._refiner.candidates)):
            if self._best.to_end and not self._near:
                break
            if (not self._near or one.log_score > least) and self._effort < self._most:
                self._lead(one.point.nuisance, one.state, near=self._near)
        if guessed and not self._near:
            self._lead_alike(others)
        self._one_less(self._best)
        self._lead_rivals()
        for _ in range(self._most_causes - 1):
            if not self._one_more():
                break
            self._one_less(self._best)
            self._lead_rivals()

    @property
    def arrived(self) -> bool:
        """Whether something was led to the end, near the noise."""
        return bool(self._led) and self._best.misfit < ARRIVED * len(self._samples.shares)

    def fitted(self) -> list[Fitted] | None:
        """Hypotheses with the scores of all samples, the best first; None: none comes near."""
        count = len(self._samples.shares)
        self._led = led_through(self._system, self._led)
        first = sorted(self._led, key=farthest_first)
        nothing = nothing_again(self._system, self._nothing, first[:RESTARTS])
        if min(one.misfit for one in (*self._led, nothing)) > ARRIVED * count:
            return None
        return all_samples_say(self._refiner, self._led, nothing, count)

    @property
    def _best(self) -> Followed:
        return min(self._led, key=farthest_first, default=self._nothing)

    def _lead(self, nuisance: Array, state: State, *, near: bool) -> None:
        self._begun.append(state)
        system, ahead = self._system, self._best.costs if self._led else None
        # What nuisances do, about what a new hypothesis is near to.
        close = self._nothing if self._best.columns is None else self._best
        lent = close.columns if near else None
        found = follow_ring(
            system, nuisance, state, everything=True, ahead=ahead, near=near, lent=lent
        )
        lost = self._best.to_end and found.misfit > HOPELESS * self._best.misfit
        if near and found.share < 1.0 and not lost:
            self._effort += found.effort
            found = follow_ring(system, nuisance, state, everything=True, ahead=ahead)
        if found.share < 1.0:
            left = self._samples, found.nuisance
            sharper = sharpened(state, lambda there: -misfit_at(*left, there))
            if sharper is not state:
                self._effort += found.effort
                found = follow_ring(system, found.nuisance, sharper, everything=True, ahead=ahead)
        self._keep(found)

    def _keep(self, found: Followed) -> None:
        self._effort += found.effort
        if farthest_first(found) > farthest_first(self._best):
            found = replace(found, columns=None)
        self._led.append(found)
        if self._progress is not None:
            self._progress(len(self._led), len(self._led))

    def _fresh(self, hypotheses: Sequence[Fitted]) -> list[Fitted]:
        """Those that were not led to the end before, nor lost from about the same start."""
        known = {one.names for one in self._led if one.to_end}
        fresh = [one for one in hypotheses if one.hypothesis.names not in known]
        return [one for one in fresh if not any(one.state.is_about(at) for at in self._begun)]

    def _is_kin(self, fitted: Fitted) -> bool:
        """Whether it will be led from where another law of its kind came to the end."""
        names = (self._best.names, fitted.hypothesis.names)
        if self._near or not self._best.to_end or any(len(one) != 1 for one in names):
            return False
        one, other = (self._refiner.candidates[name].family for (name,) in names)
        return bool(one) and one == other

    def _lead_kin(self, best: Followed) -> None:
        """From where a hypothesis was led to the end, other laws of each of its kinds are led."""
        if best.borrowed and best is self._best:
            self._led = [through(self._system, one) if one is best else one for one in self._led]
            best = self._best
        if best.state is None or not best.to_end:
            return
        for known, name, names in kin_left(best, self._led, self._refiner.candidates):
            if names in self._tried or self._effort > self._most:
                continue
            self._tried.add(names)
            found = lead_instead(self._samples, best, known, name)
            if found is not None:
                self._keep(found)

    def _lead_alike(self, others: Sequence[Fitted]) -> None:
        """Laws of the best's kind in all places alike, where it leaves more than noise."""
        best = self._best
        if best.left < NOISE:
            return
        for one in kin_alike(best, others, self._refiner.candidates):
            found = follow_ring(
                self._system, one.point.nuisance, one.state.alike(), everything=True,
                ahead=best.costs,
            )  # fmt: skip
            # What falls behind says nothing of its kind: that is led from the best's own places.
            if farthest_first(found) < farthest_first(self._best):
                self._keep(found)

    def _lead_rivals(self) -> None:
        """Kin of what is on are led, and what promises as much as it does."""
        candidates = self._refiner.candidates
        for _ in range(EXCHANGES):
            self._lead_kin(self._best)
            plain = plainest(self._led, cost_of(self._best) + WORTH_IT, candidates)
            if plain is None or plain.names in self._exchanged or self._effort > self._most:
                return
            self._exchanged.add(plain.names)
            # At the end strained parameters tell what they make up for.
            end = plain if plain.about is None else replace(plain, about=None)
            for one in rivals(self._system, self._faint(end), candidates, self._led):
                self._keep(one)

    def _faint(self, about: Followed) -> Faint:
        """What could be there beside what is on; that of where it was asked last is kept."""
        if self._asked is None or self._asked.followed is not (about.about or about):
            self._asked = faint(self._system, about, others_beside(self._refiner, about))
        return self._asked

    def _one_more(self) -> bool:
        """Try one cause more beside the best; whether that leads farther."""
        best, refiner = self._best, self._refiner
        if len(best.names) >= self._most_causes or self._effort > self._most:
            return False
        found = self._faint(best)
        family = {name: one.family or name for name, one in refiner.candidates.items()}
        promised: dict[str, list[Scored]] = {}
        for scored in one_more(found, refiner, EXPLAINS if best.to_end else 0.0):
            (added,) = set(scored.hypothesis.names) - set(best.names)
            promised.setdefault(family[added], []).append(scored)

        def lead(scored: Scored) -> Followed:
            start = Followed(nuisances_of(found, scored), State.of(scored, refiner.candidates))
            if best.to_end:
                start = part_of_the_way(self._samples, best, start)
            assert start.state is not None
            self._lead(start.nuisance, start.state, near=best.to_end)
            return self._led[-1]

        known = {one.names for one in self._led}
        tried: dict[str, Followed] = {}
        for kind, laws in list(promised.items())[:MORE]:
            promising = laws[0].log_score > next(iter(promised.values()))[0].log_score - FAR_BEHIND
            if promising and laws[0].hypothesis.names not in known:
                tried[kind] = lead(laws[0])
        if self._best is best or (best.to_end and cost_of(self._best) > cost_of(best) - WORTH_IT):
            return False
        # One law was led that far; which of its kind it is, is another question.
        kind = min(tried, key=lambda one: farthest_first(tried[one]))
        for scored in promised[kind][1:]:
            if scored.hypothesis.names not in known and self._effort < self._most:
                self._lead_like(tried[kind], scored, best.names)
        return True

    def _one_less(self, whole: Followed) -> None:
        """Try without one cause, from where one more led to: each may only have shown the way."""
        if whole.state is None or not whole.to_end or len(whole.names) < 2:
            return
        close = cost_of(whole) + CLOSE
        known = {one.names for one in self._led if one.to_end and cost_of(one) < close}
        for name in whole.names:
            state = whole.state.without(name)
            # However much was tried: a second cause may stand for what the first had not been.
            if state.hypothesis.names in known:
                continue
            fewer = lead_from(self._system, whole, state)
            self._keep(fewer)
            if cost_of(fewer) < close:
                self._lead_kin(fewer)
                self._one_less(fewer)

    def _lead_like(self, law: Followed, scored: Scored, known: Sequence[str]) -> None:
        """Lead another law in the same places, from where one of its kind has come to."""
        (name,) = set(scored.hypothesis.names) - set(known)
        (like,) = set(law.names) - set(known)
        found = lead_instead(self._samples, law, like, name) if law.to_end else None
        if found is not None:
            self._keep(found)
        else:
            self._lead(law.nuisance, State.of(scored, self._refiner.candidates), near=False)
