"""Hypotheses led to the ring's phase, each for itself, and what all samples then say of them."""

from collections.abc import Callable, Sequence

from analysis.engine.all_samples import (
    WORTH_IT,
    cost_of,
    elsewhere_than,
    farthest_first,
    noise_of,
    rise_beside_form,
    tells_more,
)
from analysis.engine.cycles import valley
from analysis.engine.faint import Faint
from analysis.engine.faint_search import nuisances_of, one_more, promised_by
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.hypothesis import Hypothesis
from analysis.engine.kin import (
    kin_of,
    lead_from,
    lead_instead,
    part_of_the_way,
)
from analysis.engine.part import SEVERAL, records_of
from analysis.engine.refine import Refiner
from analysis.engine.ring_fit import follow_ring
from analysis.engine.rival_leader import RivalLeader
from analysis.engine.screen import Scored
from analysis.engine.sensitivity import Progress
from analysis.engine.state import State

MORE = 2
"""Beside the best that was led to the phase, one cause more is tried, of so many kinds."""

EARLY = 0.03
"""Where none of the first that were tried can be led so much farther than parameters alone, as a
share of the time, the ring tells nothing of what is left out."""

EXPLAINS = 0.05
"""Beside a law that was led to the end, one cause more is tried where it promises to explain this
share of what that leaves beyond noise."""

GENEROUS = 2.0
"""And where so many times what it promises would count beside the error of form of what is on."""

CLOSE = 60.0
"""Without a cause that does nothing, the squared misfit rises by no more than this."""

STRAINED = 500.0
"""What came to the end with parameters bent by more than this, in squared sigmas, has most likely
made them stand for what it is not: the next guesses are led, too."""

GUESSES = 2
"""So many of them, of other kinds, until one comes there with less; and until one comes farther,
where the first came no farther than parameters alone."""

FAR_BEHIND = 15.0
"""What promises to stay this far behind is not led to the phase."""


class FollowedSearch(RivalLeader):
    """Hypotheses led to the ring's phase, each for itself, and with one cause more where it asks.

    Parameters are those of `RivalLeader`, and

    Parameters
    ----------
    enough
        Asked of each hypothesis that explains to the noise and is the best: nothing more is led
        where it is.
    """

    def __init__(
        self,
        refiner: Refiner,
        nothing: Followed,
        most_causes: int,
        progress: Progress | None = None,
        *,
        near: bool = False,
        enough: Callable[[Followed], bool] | None = None,
    ) -> None:
        super().__init__(refiner, nothing, most_causes, progress, near=near)
        self._enough = enough
        self._asked_of: set[tuple[str, ...]] = set()
        self.ended = False
        """Whether something was enough."""

    def follow(
        self,
        hypotheses: Sequence[Fitted],
        others: Sequence[Fitted],
        *,
        guessed: bool = False,
        seen: bool = False,
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
        seen
            They are likely by lines as well: what explains but a stretch is looked beside.
        """
        self.lead_first(hypotheses)
        if not self._led or self.ended:
            return
        if not self._near:
            tells = seen and tells_more(self._best, self._nothing, self._samples.shares)
            if not tells:
                self._lead_next(others, self._is_farther)
            if not (tells or self._is_farther(self._best)):
                return
        least = max((one.log_score for one in hypotheses), default=0.0) - FAR_BEHIND
        for one in self._fresh(kin_of(self._best, self._led, others, self._refiner.candidates)):
            if self._best.to_end and not self._near:
                break
            if (not self._near or one.log_score > least) and self._effort < self._most:
                self._lead_guess(one)
        if guessed and not self._near:
            self._lead_next(others, lambda led: not self._is_strained(led))
            self._lead_alike(others)
        self._lead_beside()

    def _lead_next(self, others: Sequence[Fitted], until: Callable[[Followed], bool]) -> None:
        """The next guesses, of other kinds than what was led, until the best is of use.

        Parameters
        ----------
        others
            Single causes, the most promising first.
        until
            Whether the best is of use.
        """
        kinds = set().union(*(self._kinds(one.names) for one in self._led))
        for one in self._fresh(others):
            if len(kinds) > GUESSES or until(self._best):
                return
            kind = self._kinds(one.hypothesis.names)
            if not kind & kinds:
                kinds |= kind
                self._lead(one.point.nuisance, one.state, near=False)

    def _kinds(self, names: Sequence[str]) -> set[str]:
        return {self._refiner.candidates[name].family or name for name in names}

    def _is_farther(self, led: Followed) -> bool:
        return led.to_end or led.share >= self._nothing.share + EARLY

    @staticmethod
    def _is_strained(led: Followed) -> bool:
        return led.to_end and led.strain > STRAINED

    def follow_from(self, begun: Sequence[Followed]) -> None:
        """Lead hypotheses of some of the recordings in all of them.

        Parameters
        ----------
        begun
            Where they came to, the best first.
        """
        for number, one in enumerate(begun):
            if one.state is not None and not (number > 0 and self._effort > self._most):
                self._lead(one.nuisance, one.state, near=self._near)
        self._lead_beside()

    def _lead_beside(self) -> None:
        """From the best on: rivals, one cause more, one less."""
        for _ in range(self._most_causes):
            self._one_less(self._best)
            waiting = not self._lead_rivals()
            self._lead_freed()
            best = self._best
            more = self._one_more()
            if self._is_enough():
                break
            if more:
                continue
            if waiting:
                self._lead_rivals(last=True)
            if self._best is best and not self._lead_elsewhere():
                break

    def _is_enough(self) -> bool:
        """Whether the best explains to the noise, and that is all that was to be found here."""
        best = self._best
        if self._enough is None or not self._explains(best):
            return False
        if best.names not in self._asked_of:
            self._asked_of.add(best.names)
            self.ended = self._enough(best)
        return self.ended

    def _explains(self, led: Followed) -> bool:
        """Whether what is on explains to the noise."""
        return led.state is not None and led.to_end and led.left < noise_of(self._system)

    def lead_first(self, hypotheses: Sequence[Fitted]) -> None:
        """Lead hypotheses, and look no farther.

        Parameters
        ----------
        hypotheses
            Those to try.
        """
        for number, one in enumerate(self._fresh(hypotheses)):
            if number > 0 and (self._effort > self._most or self._is_kin(one)):
                continue
            self._lead_guess(one)
        self._is_enough()

    def _lead_guess(self, guess: Fitted) -> None:
        """Lead what straight lines promise, or, near the phase, so much of it as leaves least."""
        start = Followed(guess.point.nuisance, guess.state)
        if self._near:
            start = part_of_the_way(self._samples, self._nothing, start)
        self._lead(start.nuisance, start.state or guess.state, near=self._near)

    def _lead_elsewhere(self) -> bool:
        """Lead the best over a ridge; or from elsewhere, where it leaves what nothing explains."""
        best = self._best
        if best.state is None or not best.to_end or best.names in self._anew:
            return False
        # Of several recordings each was led over its own ridges.
        if len(records_of(self._system)) >= SEVERAL:
            return False
        self._anew.add(best.names)
        beyond = valley(self._system, best).led
        if beyond is not best:
            self._keep(beyond)
        elif best.left > noise_of(self._system):
            start = elsewhere_than(best)
            self._keep(follow_ring(self._system, start, best.state, everything=True))
        return cost_of(self._best) < cost_of(best) - WORTH_IT

    def _one_more(self) -> bool:
        """Try one cause more beside the best; whether that leads farther."""
        best, refiner = self._best, self._refiner
        # However much was tried: beside what explains to the noise little is to be led.
        spent = self._effort > self._most and not self._explains(best)
        if len(best.names) >= self._most_causes or spent:
            return False
        found = self._faint(best)
        family = {name: one.family or name for name, one in refiner.candidates.items()}
        promised: dict[str, list[Scored]] = {}
        for scored in one_more(found, refiner, EXPLAINS if best.to_end else 0.0):
            if best.to_end and not self._would_tell(found, scored):
                continue
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
        self._lead_abreast(best, tried[kind])
        return True

    def _lead_abreast(self, before: Followed, after: Followed) -> None:
        """What had come as close as what one cause more was led beside is led with that as well."""
        if after.state is None or not (before.to_end and after.to_end):
            return
        (new,) = set(after.names) - set(before.names)
        candidates, close = self._refiner.candidates, cost_of(before) + CLOSE
        known = {one.names for one in self._led if new in one.names}
        part = after.state.hypothesis.parts[new]
        values = {key: one for key, one in after.state.term_values().items() if key[0] == new}
        for one in sorted((one for one in self._led if one.to_end), key=cost_of):
            names = tuple(sorted({*one.names, new}))
            if one.state is None or names in known or cost_of(one) > close:
                continue
            if len(names) != len(after.names) or self._kinds(one.names) & self._kinds([new]):
                continue
            known.add(names)
            hypothesis = one.state.hypothesis.plus(new, part)
            state = State.at(hypothesis, one.state.term_values() | values, candidates)
            start = one.nuisance + after.nuisance - before.nuisance
            self._keep(lead_from(self._system, after, state, start))

    def _would_tell(self, found: Faint, scored: Scored) -> bool:
        """Whether one cause more, as promised, would count beside the error of form that is left.

        What explains little of what a law of friction leaves is lost in how wrong that law may be,
        and to lead it is in vain; what explains all of it shows that the law was right.
        """
        best, known = self._best, self._refiner.candidates
        explains = promised_by(found, self._refiner, scored)
        count = len(self._samples.shares)
        rise = rise_beside_form(self._refiner, best, self._nothing, count, explains)
        on = Hypothesis() if best.state is None else best.state.hypothesis
        costs = on.log_prior(known) - scored.hypothesis.log_prior(known)
        return GENEROUS * rise > costs

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
