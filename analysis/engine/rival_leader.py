"""Rivals of what was led to the ring's phase: other laws, other places, other causes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.all_samples import (
    AS_LIKELY,
    WORTH_IT,
    cost_of,
    farthest_first,
    forms_of,
    noise_of,
    through,
)
from analysis.engine.exchange import exchanged, fresh, plainest, rivals
from analysis.engine.faint_search import most_promised, nuisances_of
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.judge import NOISE
from analysis.engine.kin import kin_alike, kin_left, lead_from, lead_instead
from analysis.engine.leader import ARRIVED, Leader
from analysis.engine.moved import freed
from analysis.engine.part import has_several
from analysis.engine.places import as_likely_in, is_placed, placed_again
from analysis.engine.ring_fit import BEHIND, FAINT, follow_ring
from analysis.engine.state import State

EXCHANGES = 2
"""From what rivals have led to, rivals are looked for once more: so often at a time."""

PLACINGS = 2
"""From other places, places are asked once more: so often at a time."""

BENT, FAR_BENT = 100.0, 1000.0
"""Parameters of one kind whose squares come to more than this, in sigmas, stand for a cause: beside
what explains to the noise, and beside what does not."""

NEARLY = 3.0
"""What leaves no more than so many times what the best does, squared, may be in a hollow."""

CLOSE = 60.0
"""What came as close as this, in squared misfit, may have been in places that are as wrong."""


class RivalLeader(Leader):
    """Leads rivals of the best: kin, the same elsewhere, and what promises as much.

    Parameters are those of `Leader`.
    """

    def _is_kin(self, guess: Guess) -> bool:
        """Whether it will be led from where another law of its kind came to the end."""
        names = (self._best.names, guess.hypothesis.names)
        if self._near or not self._best.to_end or any(len(one) != 1 for one in names):
            return False
        one, other = (self._refiner.candidates[name].family for (name,) in names)
        return bool(one) and one == other

    def _lead_through(self) -> None:
        """The best, led with what others do about itself where that was lent by another."""
        best = self._best
        if best.borrowed:
            self._led = [through(self._system, one) if one is best else one for one in self._led]

    def _explains(self, led: Followed) -> bool:
        """Whether what is on explains to the noise."""
        return led.state is not None and led.to_end and led.left < noise_of(self._system)

    def _lead_kin(self, best: Followed) -> None:
        """From where a hypothesis was led to the end, other laws of each of its kinds are led."""
        if best.state is None or not best.to_end:
            return
        for known, name, names in kin_left(best, self._in_place, self._refiner.candidates):
            # However much was tried: beside what explains to the noise kin may explain as well.
            spent = self._effort > self._most and not self._explains(best)
            if names in self._tried or spent:
                continue
            self._tried.add(names)
            found = lead_instead(self._samples, best, known, name)
            if found is not None:
                self._keep(found)
                self._lead_kin_anew(found)
                if cost_of(self._best) < cost_of(best) - BEHIND:
                    # What is that much closer has kin of its own, and is the better place to begin.
                    self._lead_kin(self._best)
                    return

    def _lead_kin_anew(self, found: Followed) -> None:
        """Another law by growing windows, where neither that nor the best explains to the noise.

        A law that is not what is there bends parameters, and from there another may have come to a
        hollow. What came to be a law that was led is that, not another.
        """
        if self._near or has_several(self._system) or len(found.names) != 1 or not found.to_end:
            return
        assert found.state is not None
        led = {one.names for one in self._led if one.to_end}
        if any(one in led for one in found.state.hypothesis.also(self._refiner.candidates)):
            return
        best, least = self._best, noise_of(self._system)
        if min(found.left, best.left) < least or self._effort > self._most:
            return
        if not self._arrives(best.misfit) or found.misfit > NEARLY * best.misfit:
            return
        start, ahead = np.zeros_like(found.nuisance), best.costs
        self._keep(follow_ring(self._system, start, found.state, everything=True, ahead=ahead))

    def _lead_alike(self, others: Sequence[Guess]) -> None:
        """Laws of the best's kind in all places alike, where it leaves more than noise.

        And of what came as close in some places: of which kind it is, these may hide. Near the
        phase the best's own law is led so, over windows: what is faint everywhere was told of some
        places, and led into a valley of theirs. Its kin are led from there.
        """
        if self._best.left < (noise_of(self._system) if self._near else NOISE):
            return
        for came in (self._best,) if self._near else (self._best, *self._as_close_elsewhere()):
            for one in kin_alike(came, others, self._refiner.candidates):
                if self._near and one.hypothesis.names != came.names:
                    continue
                ahead = self._best.costs
                found = follow_ring(
                    self._system, one.nuisance, one.state.alike(), everything=True, ahead=ahead
                )
                # What falls behind says nothing of its kind: it is led from the best's own places.
                if farthest_first(found) < farthest_first(self._best):
                    self._keep(found)
            if self._near and cost_of(self._best) < cost_of(came) - WORTH_IT:
                self._call_misplaced(came)

    def _as_close_elsewhere(self) -> list[Followed]:
        """Single causes of other kinds than the best that came as close."""
        close = cost_of(self._best) + CLOSE
        kinds = self._kinds(self._best.names)
        singles = [one for one in self._led if one.to_end and len(one.names) == 1]
        return [
            one for one in singles if cost_of(one) < close and not kinds & self._kinds(one.names)
        ]

    def _kinds(self, names: Sequence[str]) -> set[str]:
        return {self._refiner.candidates[name].kind for name in names}

    def _lead_everywhere(self) -> None:
        """Each cause of what explains to the noise, and its kin, in all places alike.

        One number says less than some and where they are: what does as well with it is there. In
        the places that one law has chosen, another does not show how well it would do.
        """
        for known in self._best.names:
            best = self._best
            if best.state is None or not best.to_end or best.left > NOISE:
                return
            state = best.state.alike(known) if known in best.names else best.state
            if state is best.state or (known, best.names) in self._everywhere:
                continue
            self._everywhere.add((known, best.names))
            alike = lead_from(self._system, best, state)
            self._keep(alike)
            if not alike.to_end or alike.misfit > self._most_alike * best.misfit:
                continue
            candidates = self._refiner.candidates
            family = candidates[known].family
            for name, one in candidates.items():
                if family and one.family == family and name != known:
                    found = lead_instead(self._samples, alike, known, name)
                    if found is not None:
                        self._keep(found)

    @property
    def _most_alike(self) -> float:
        """Of what the best leaves, so much may be left in all places alike, for kin to be tried."""
        return FAINT if has_several(self._system) else ARRIVED

    @property
    def _in_place(self) -> list[Followed]:
        """What was led, but for what is to be led once more in other places."""
        return [one for one in self._led if one.names not in self._misplaced]

    def _lead_placed(self) -> None:
        """What is on, in the places that are told at the end, or where the ring was lost."""
        candidates = self._refiner.candidates
        for _ in range(PLACINGS):
            best = self._best
            if best.state is None or self._effort > self._most:
                return
            if not any(is_placed(candidates[name]) for name in best.names):
                return
            if best.state.hypothesis.key in self._placed:
                return
            self._placed.add(best.state.hypothesis.key)
            if not best.to_end:
                asked = self._faint(best, itself=True)
                for _, one in placed_again(asked, candidates)[:1]:
                    state = State.of(one, candidates)
                    self._lead(nuisances_of(asked, one), state, near=False)
                continue
            asked = self._faint(replace(best, about=None), itself=True)
            forms = forms_of(self._refiner, best, self._nothing, len(self._samples.shares))
            _, noise = max(forms)
            told = placed_again(asked, candidates, noise)
            if not told and self.is_poor:
                # What is left may come of the places, not of the form.
                told = placed_again(asked, candidates)
            if not told and not self.is_poor:
                self._elsewhere[best.state.hypothesis.key] = as_likely_in(
                    asked, candidates, noise, AS_LIKELY
                )
            for _, one in told[:1]:
                state = State.of(one, candidates)
                self._keep(lead_from(self._system, best, state, nuisances_of(asked, one)))
            if cost_of(self._best) < cost_of(best) - WORTH_IT:
                self._call_misplaced(best)

    def _call_misplaced(self, best: Followed) -> None:
        """What came as far as what was in wrong places may have been in places that are as wrong.

        It is led once more.
        """
        close = (one for one in self._led if cost_of(one) < cost_of(best) + CLOSE)
        self._misplaced |= {one.names for one in close if one.names != best.names}
        self._tried -= self._misplaced

    def _lead_freed(self) -> None:
        """Where parameters of one kind were bent far, they stand for a cause: it is led as one.

        Nothing is searched for it: the simulation is the same, and what it costs is not.
        """
        best, candidates = self._best, self._refiner.candidates
        if best.state is None or not best.to_end or len(best.names) >= self._most_causes:
            return
        families = {candidates[name].family for name in best.names} - {""}
        bent: dict[str, float] = {}
        for one, sigmas in zip(self._system.nuisances, best.nuisance, strict=True):
            if one.cause in candidates and one.term and one.cause not in best.names:
                bent[one.cause] = bent.get(one.cause, 0.0) + float(sigmas) ** 2
        name = max(bent, key=lambda one: bent[one], default="")
        # A wrong law may be what they were bent for, but not so far.
        least = BENT if best.left < noise_of(self._system) else FAR_BENT
        if bent.get(name, 0.0) < least or candidates[name].family in families:
            return
        start = freed(self._system, candidates, best, name)
        assert start.state is not None
        if start.names not in {one.names for one in self._led if one.to_end}:
            self._keep(lead_from(self._system, best, start.state, start.nuisance))

    def _lead_rivals(self, *, last: bool = False) -> bool:
        """Kin of what is on are led, and what promises as much as it does.

        Where what is on explains to the noise, and one cause more promises more than any rival,
        rivals wait for it, unless this is the last time; whether none does.
        """
        candidates = self._refiner.candidates
        for _ in range(EXCHANGES):
            self._lead_placed()
            self._lead_through()
            self._lead_kin(self._best)
            self._lead_everywhere()
            self._lead_through()
            plain = plainest(self._led, cost_of(self._best) + WORTH_IT, candidates)
            # However much was tried: beside what explains to the noise little is to be led.
            spent = self._effort > self._most and not (plain and plain.left < NOISE)
            if plain is None or plain.names in self._exchanged or spent:
                break
            # At the end strained parameters tell what they make up for.
            end = plain if plain.about is None else replace(plain, about=None)
            asked = self._faint(end)
            promised = fresh(exchanged(asked, candidates), self._in_place)
            waits = plain is self._best and plain.left < NOISE and not last
            if waits and promised and most_promised(asked, self._refiner) > promised[0].ahead:
                self._waiting[plain.names] = asked.to_lead_from(), promised
                return False
            self._exchanged.add(plain.names)
            self._waiting.pop(plain.names, None)
            for one in rivals(self._system, asked, candidates, promised):
                self._keep(one)
        return True

    def _lead_waiting(self) -> bool:
        """Rivals that waited, where they promise to come close to the best; whether one leads.

        One cause more may have come far beside a wrong law: what another law puts right is not to
        be made up for by a cause more.
        """
        before = self._best
        waiting, self._waiting = self._waiting, {}
        for names, (asked, promised) in waiting.items():
            self._exchanged.add(names)
            behind = (cost_of(asked.followed) - cost_of(before) - CLOSE) / 2.0
            least = behind / float(asked.problem.base.mean())
            ahead = fresh([one for one in promised if one.ahead > least], self._in_place)
            for one in rivals(self._system, asked, self._refiner.candidates, ahead):
                self._keep(one)
        return cost_of(self._best) < cost_of(before) - WORTH_IT
