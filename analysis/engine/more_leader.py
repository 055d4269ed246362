"""One cause more beside what was led to the ring's phase, and one less."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.all_samples import (
    WORTH_IT,
    cost_of,
    farthest_first,
    misfit_at,
    noise_of,
    parameters_of,
    rise_beside_form,
)
from analysis.engine.array import Array
from analysis.engine.faint import Faint
from analysis.engine.faint_search import eased_by, nuisances_of, one_more, promised_by
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.kin import lead_from, lead_instead, part_of_the_way
from analysis.engine.leader import ARRIVED
from analysis.engine.part import has_several
from analysis.engine.ring_fit import BEHIND, FAR, follow_ring
from analysis.engine.rival_leader import RivalLeader
from analysis.engine.screen import Scored
from analysis.engine.state import State
from analysis.engine.way import LEAVES, STRAIN
from analysis.engine.weights import log_chance, numbers_of
from analysis.engine.whole import whole_beside

MORE = 2
"""Beside the best that was led to the phase, one cause more is tried, of so many kinds."""

EXPLAINS = 0.05
"""Beside a law that was led to the end, one cause more is tried where it promises to explain this
share of what that leaves beyond noise."""

GENEROUS = 2.0
"""And where so many times what it promises would count beside the error of form of what is on."""

CLOSE = 60.0
"""Without a cause that does nothing, the squared misfit rises by no more than this."""

HOLLOW = 20.0
"""Where it rises by more than this times what differences tell, it was not led to where it fits."""

AS_CLOSE = 6
"""So many of several causes are led without each of these."""

LEAST_LEFT = 1e-3
"""A promise is never to explain all but less than this share."""

FAR_BEHIND = 15.0
"""What promises to stay this far behind is not led to the phase."""


class MoreLeader(RivalLeader):
    """Leads the best with one cause more where the ring asks for it, and without each that it has.

    Parameters are those of `Leader`.
    """

    def _one_more(self, beside: Followed | None = None) -> bool:
        """Try one cause more beside the best, or beside another; whether that leads farther."""
        before, refiner = self._best, self._refiner
        best = before if beside is None else beside
        # However much was tried: beside what explains to the noise little is to be led, and beside
        # what leads to the end one cause more is asked for once.
        first = best.to_end and not self._asked_more
        spent = self._effort > self._most and not (first or self._explains(best))
        if len(best.names) >= self._most_causes or spent:
            return False
        self._asked_more = True
        found = self._faint(best)
        least = EXPLAINS if best.to_end and found.followed.telling == 1.0 else 0.0
        promised: dict[str, list[Scored]] = {}
        for scored in one_more(found, refiner, least):
            if best.to_end and best.strain < FAR and not self._would_tell(found, scored):
                continue
            (added,) = set(scored.hypothesis.names) - set(best.names)
            promised.setdefault(refiner.candidates[added].kind, []).append(scored)

        def lead(scored: Scored) -> Followed:
            start = Followed(nuisances_of(found, scored), State.of(scored, refiner.candidates))
            passed = 0.0
            if best.to_end:
                start = part_of_the_way(self._samples, best, start)
            else:
                share = found.followed.telling
                start = part_of_the_way(self._samples, found.followed, start, share)
                # Over a shorter stretch it may come to nothing, and be lost there.
                passed = self._led_until(start, share)
            assert start.state is not None
            self._lead(start.nuisance, start.state, near=best.to_end, passed=passed)
            return self._led[-1]

        known = {one.names for one in self._led}
        tried: dict[str, Followed] = {}
        for kind, laws in list(promised.items())[:MORE]:
            promising = laws[0].log_score > next(iter(promised.values()))[0].log_score - FAR_BEHIND
            if promising and laws[0].hypothesis.names not in known:
                tried[kind] = lead(laws[0])
        gains = cost_of(before) - cost_of(self._best)
        if not tried or self._best is before or (before.to_end and gains < WORTH_IT):
            return False
        # One law was led that far; which of its kind it is, is another question.
        kind = min(tried, key=lambda one: farthest_first(tried[one]))
        for scored in promised[kind][1:]:
            if scored.hypothesis.names not in known and self._effort < self._most:
                self._lead_like(tried[kind], scored, best.names)
        self._lead_abreast(best, tried[kind])
        return True

    def _lead_whole(self) -> None:
        """What is there as a whole is led beside the best, where parameters may be hiding it.

        Once beside each, and of one recording: there every pilot does so.
        """
        best = self._best
        room = len(best.names) < self._most_causes and not has_several(self._system)
        if not (room and self._explains(best) and best.strain > STRAIN):
            return
        if best.names not in self._asked_whole:
            self._asked_whole.add(best.names)
            found = self._faint(replace(best, about=None))
            for one in whole_beside(self._system, self._refiner.candidates, found):
                self._keep(one)

    def _led_until(self, start: Followed, most: float) -> float:
        """Up to which share of the time, of so much, a beginning leaves little more than noise."""
        shares, left = self._samples.means(start.point, most)
        return float(max(shares[left < ARRIVED], default=0.0))

    def _lead_abreast(self, before: Followed, after: Followed) -> None:
        """What had come as close as what one cause more was led beside is led with that as well."""
        if after.state is None or not (before.to_end and after.to_end):
            return
        (new,) = set(after.names) - set(before.names)
        close = cost_of(before) + CLOSE
        known = {one.names for one in self._led if new in one.names}
        part = after.state.hypothesis.parts[new]
        found = after.state.term_values()
        values = {term: found[new, term] for term in part.terms}
        for one in sorted((one for one in self._led if one.to_end), key=cost_of):
            names = tuple(sorted({*one.names, new}))
            if one.state is None or names in known or cost_of(one) > close:
                continue
            if len(names) != len(after.names) or self._kinds(one.names) & self._kinds([new]):
                continue
            known.add(names)
            state = one.state.plus(new, part, values)
            start = one.nuisance + after.nuisance - before.nuisance
            self._keep(lead_from(self._system, after, state, start))

    def _would_tell(self, found: Faint, scored: Scored) -> bool:
        """Whether one cause more, as promised, would count beside the error of form that is left.

        What explains little of what a law of friction leaves is lost in how wrong that law may be,
        and to lead it is in vain; what explains all of it shows that the law was right, and what
        explains most of it has the shape of no error by chance. Where parameters are bent far, they
        make up for some of it, and this is not asked. All of it is what is left of the stretch that
        promises it.
        """
        known, left = self._refiner.candidates, found.seen.residual
        falls = promised_by(found, self._refiner, scored)
        best, count = replace(self._best, misfit=float(left @ left)), len(left)
        # What parameters no longer make up for is hidden in no error of form.
        eased = eased_by(found, self._refiner, scored)
        explains = max(falls - eased, 0.0)
        rise = rise_beside_form(self._refiner, best, self._nothing, count, explains)
        rise += 0.5 * min(eased, falls)
        on = Hypothesis() if best.state is None else best.state.hypothesis
        beyond = best.misfit - noise_of(self._system) * count
        if beyond > LEAVES * float(np.sqrt(2.0 * count)):
            numbers = numbers_of(scored.hypothesis, known) - numbers_of(on, known)
            rise = max(rise, by_chance(falls / beyond, numbers))
        costs = on.log_prior(known) - scored.hypothesis.log_prior(known)
        return GENEROUS * rise > costs

    def _one_less(self, whole: Followed) -> None:
        """Try without one cause, from where one more led to: each may only have shown the way."""
        if whole.state is None or not whole.to_end or len(whole.names) < 2:
            return
        if any(one is whole for one in self._fewer):
            return
        self._fewer.append(whole)
        close = cost_of(whole) + CLOSE
        known = {one.names for one in self._led if one.to_end and cost_of(one) < close}
        for name in whole.names:
            state = whole.state.without(name)
            # However much was tried: a second cause may stand for what the first had not been.
            tried = whole.names, state.hypothesis.names
            needed = cost_of(whole) > self._needed.get(tried, np.inf) - BEHIND
            start = parameters_of(self._system, whole, (name,))
            told = self._is_told(state, close, start)
            if state.hypothesis.names in known or needed or told:
                continue
            fewer = lead_from(self._system, whole, state, start)
            rises = cost_of(fewer) - cost_of(whole)
            arrives = fewer.to_end and fewer.left < ARRIVED
            if arrives and rises > max(CLOSE, HOLLOW * whole.rises_without(name)):
                # Nearly there, and in a hollow: a cause that is worth so little led into none.
                again = follow_ring(
                    self._system, np.zeros_like(whole.nuisance), state, everything=True
                )
                effort = fewer.effort + again.effort
                fewer = replace(min(fewer, again, key=farthest_first), effort=effort)
            self._keep(fewer)
            if cost_of(fewer) > cost_of(whole) + 2.0 * BEHIND:
                # From about as good a place it would be as far behind.
                self._needed[tried] = cost_of(whole)
            if cost_of(fewer) < close:
                self._lead_kin(fewer)
                self._one_less(fewer)

    def _is_told(self, state: State, most: float, nuisance: Array) -> bool:
        """Whether it came to the same, which costs more than so much, from two places.

        Unless it is closer where it stands: a cause that comes to nothing has led it there.
        """
        names = state.hypothesis.names
        costs = sorted(cost_of(one) for one in self._led if one.to_end and one.names == names)
        if not (len(costs) > 1 and costs[0] > most and costs[1] < costs[0] + 2.0 * BEHIND):
            return False
        return misfit_at(self._samples, nuisance, state) + float(nuisance @ nuisance) > costs[0]

    def _as_close(self) -> list[Followed]:
        """What came about as close as the best with two causes or more, the closest first.

        One of them may have been led with another that only showed the way, and alone to nowhere.
        """
        close = cost_of(self._best) + CLOSE
        both = [one for one in self._led if one.to_end and len(one.names) > 1]
        return sorted((one for one in both if cost_of(one) < close), key=cost_of)[:AS_CLOSE]

    def _lead_like(self, law: Followed, scored: Scored, known: Sequence[str]) -> None:
        """Lead another law in the same places, from where one of its kind has come to."""
        (name,) = set(scored.hypothesis.names) - set(known)
        (like,) = set(law.names) - set(known)
        found = lead_instead(self._samples, law, like, name) if law.to_end else None
        if found is not None:
            self._keep(found)
        else:
            self._lead(law.nuisance, State.of(scored, self._refiner.candidates), near=False)


def by_chance(share: float, numbers: int) -> float:
    """How unlikely it is that so much of an error of form lies where a cause does, as a logarithm.

    Parameters
    ----------
    share
        Of what is left beyond noise, what the cause explains.
    numbers
        Of the cause.
    """
    return -log_chance(max(1.0 - share, LEAST_LEFT), numbers)
