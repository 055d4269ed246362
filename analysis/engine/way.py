"""Where parameters are on their way to the ring's phase, and the next step of it.

A step is Gauss and Newton's, by differences that serve until it leaves where they hold.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analysis.engine.array import Array
from analysis.engine.differences import differences
from analysis.engine.followed import Followed, Lent
from analysis.engine.known import Known
from analysis.engine.part import has_several
from analysis.engine.relieved import relieved
from analysis.engine.ring_samples import Samples
from analysis.engine.step import Step, Stepper

WINDOWS = (0.08, 0.12, 0.18, 0.27, 0.45, 0.7, 1.0)
"""Shares of the time over which the ring is followed, one after the other."""

REACH, NARROWEST = 4.0, 0.001
"""Where more than this is left of a sample in the next window, as where a motion begins, a nearer
one is led through first, down to this share of the time."""

AT_ONCE, IN_PHASE = 1.15, 1.5
"""A longer stretch is gone over at once only where no more than the first is left of a sample: a
faint ring half a turn out of phase leaves little more than noise, and so does a wrong turn after
it. Where more than the second is left, what was led is not nearly there."""

GROWS = 2.0
"""What a law that is not exact leaves, it leaves of a longer stretch as well: no more than so many
times as much, where it rings in phase there."""

LOST = 300.0
"""Where a sample is off by more than this, squared and on average, there is no phase to follow."""

STRAIN, LEAVES = 80.0, 4.0
"""Parameters make up for something left out where they cost more than this, squared and in sigmas,
or where more is left than noise, by so many of its standard deviations."""

THERE = 1.02
"""On the way, a squared misfit of a sample below this, on average, needs no further step."""

WORTH_A_STEP = 2.0
"""Nor one that promises less than this of the squared misfit;"""

WORTH_ANEW = 5.0
"""nor what everything does simulated anew, where the last step that began so brought less than this
of it;"""

WORTH_ON_THE_WAY = 0.003
"""or, in a window that is not the last, than this share of it."""

HOPELESS, HOPELESS_OF_SEVERAL = 20.0, 6.0
"""What costs so many times more than another hypothesis, after all that differences promised, is
not led on with fresh ones: of one recording, and of several, where they take as many times as long
and one hypothesis was led through all of them already."""

CATCHES_UP = 0.1
"""Nor one of what lies behind another hypothesis that promises less than this share of the gap."""

WORTH_ALL_ANEW = 30.0
"""What steps have brought since what nuisances do was simulated: along a valley that turns, that
may be another thing by now, however little of what is left has changed."""

STRAIGHT = 0.5
"""A step that brings less than this of what it promises, or as much more, has left where
differences hold: what everything does is simulated anew."""

RENEWED = 4
"""Then it is what is on that is simulated anew, so many times, before everything is: a law curves,
and what parameters do about it stays nearly what it was. Where that was lent by another hypothesis,
what is on is told anew as often."""

SAME = 0.01
"""Where two simulations differ by no more than this, squared, of a sample's noise, on average, what
nuisances do about the one is what they do about the other."""


class Way:
    """Where one is, and what every free number does about there, up to some share of the time.

    Parameters
    ----------
    samples
        By which it is led.
    start
        From where.
    lent
        What nuisances do to all samples about another hypothesis that is near: that serves until a
        step tells that it does not hold here.
    known
        What is known of free numbers; None: priors of nuisances.
    """

    def __init__(
        self,
        samples: Samples,
        start: Followed,
        lent: Lent | None = None,
        known: Known | None = None,
    ) -> None:
        self._samples = samples
        self._known = Known.priors(start) if known is None else known
        self.at = self._relieved(start)
        self.here = np.zeros(0)
        self._seen = 0.0
        self._columns: Array | None = None
        self._last: Array | None = None
        self._fresh = False
        self._steps = np.zeros(0)
        self._settled = False
        self._lent, self._serves = lent, False
        self._kept: Array | None = None
        self._told: Array | None = None
        self._renewed, self._won = 0, 0.0

    def hold(self, known: Known) -> None:
        """From here on something else is known of free numbers."""
        self._known, self._settled = known, False

    def window(self, passed: float) -> float:
        """Up to which share of the time to go next, as far as the ring is not lost.

        Parameters
        ----------
        passed
            Share up to which parameters were led.
        """
        self._settled = False
        at_once, share = (
            self.in_phase(passed, AT_ONCE),
            next(one for one in WINDOWS if one > passed),
        )
        if self.left(share) < REACH:
            whole = self.here
            if self._seen < 1.0:
                (whole,) = self._samples.residuals([self.at.point])
            farthest = (one for one in reversed(WINDOWS) if self._mean(whole, one) < at_once)
            share = max(share, next(farthest, share))
            whole[self._samples.shares > share] = 0.0
            self.here = whole
            self._see(share)
        while share - passed > NARROWEST and self.left(share) > REACH:
            share = 0.5 * (passed + share)
        return share

    def look(self, share: float) -> None:
        """Simulate up to a share of the time, if that was not done."""
        if share > self._seen:
            (self.here,) = self._samples.residuals([self.at.point], share)
            self._see(share)
            self._settled = False

    def _see(self, share: float) -> None:
        """What numbers do is not known over so much of the time."""
        self._seen, self._columns, self._last = share, None, None
        self._kept, self._told = None, None

    def left(self, share: float) -> float:
        """Squared misfit of a sample up to a share of the time, on average."""
        self.look(share)
        return self._mean(self.here, share)

    def _mean(self, residual: Array, share: float) -> float:
        inside = self._samples.shares <= share
        return float(np.mean(residual[inside] ** 2)) if inside.any() else 0.0

    def cost(self, share: float) -> float:
        """Squared misfit up to a share of the time, and to what is known of numbers."""
        self.look(share)
        inside = self.here[self._samples.shares <= share]
        return float(inside @ inside) + self._known.cost(self.at.numbers)

    def strained(self, share: float) -> bool:
        """Whether parameters make up for something that is left out."""
        to_the_noise = self.left(share) <= self.allowed(share)
        return not to_the_noise or self._known.cost(self.at.numbers) > STRAIN

    def allowed(self, share: float) -> float:
        """What noise may leave of a sample up to a share of the time."""
        count = int((self._samples.shares <= share).sum())
        return self._samples.noise + LEAVES * float(np.sqrt(2.0 / max(count, 1)))

    def in_phase(self, passed: float, exact: float = IN_PHASE) -> float:
        """What may be left of a sample of a longer stretch where the ring is in phase there.

        Parameters
        ----------
        passed
            Share of the time up to which numbers were led.
        exact
            Where no law that is on leaves more than noise up to there.
        """
        nothing = self.at.state is None or passed == 0.0
        if nothing or self.left(passed) <= self.allowed(passed):
            return exact
        return max(exact, GROWS * self.left(passed))

    def step(self, share: float, lost: float = LOST, best: float = np.inf) -> bool:
        """One Gauss-Newton step over the samples up to a share of the time, if there is one.

        Parameters
        ----------
        share
            Of the time.
        lost
            Where more than this is left of a sample, squared and on average, there is none.
        best
            Cost of another hypothesis there: a step must catch up with it.
        """
        self.look(share)
        inside = self._samples.shares <= share
        here = self.here[inside]
        if not len(here):
            return False
        near = share < 1.0 and float(here @ here) < THERE * len(here)
        if near or not float(here @ here) < lost * len(here):
            return False
        if self._columns is None:
            most = HOPELESS_OF_SEVERAL if has_several(self._samples.system) else HOPELESS
            hopeless = self._last is not None and self.cost(share) > most * best
            if self._settled or hopeless:
                return False
            self._differences()
        fresh = self._fresh
        fell = self._step(inside, best)
        self._settled |= fresh and fell < WORTH_ANEW
        if fell > 0.0:
            return True
        told = self._holds and self.at.state is None
        if fresh or self._settled or self._serves or told:
            return False
        assert self._columns is not None
        self._kept = self._columns[: len(self.at.nuisance)] if self._holds else None
        self._columns = None
        return self.step(share, lost, best)

    @property
    def _is_same(self) -> bool:
        """Whether what nuisances do was told of what comes to the same as what is here."""
        if self._told is None:
            return False
        off = self._told - self.here
        return float(off @ off) < SAME * len(off)

    @property
    def _holds(self) -> bool:
        """Whether that is still what nuisances do here: no valley has turned since."""
        return self._is_same and self._won <= WORTH_ALL_ANEW

    def _differences(self) -> None:
        """What every number does here; where nuisances' was lent or kept, only what is on does."""
        self._serves = self._lent is not None and self._seen == 1.0
        if self._serves:
            assert self._lent is not None
            (self._kept, self._told), self._lent = self._lent, None
        columns = np.zeros((0, len(self.here))) if self._kept is None else self._kept
        if len(columns) == 0:
            self._told, self._renewed, self._won = self.here, 0, 0.0
        self._kept, self._fresh = None, self._holds
        own, self._steps = differences(
            self._samples, self.at, self.here, self._seen, known=len(columns)
        )
        self._columns = self._last = np.concatenate([columns, own])

    def _step(self, inside: NDArray[np.bool_], best: float) -> float:
        """By how much the cost fell; nothing: there is no step."""
        assert self._columns is not None
        stepper = Stepper(self._samples, self._known, self.at, self.here, inside, self._seen)
        before, least = stepper.before, WORTH_A_STEP
        if not inside.all():
            least = max(WORTH_A_STEP, WORTH_ON_THE_WAY * before)
        step = stepper.step(self._columns, self._steps, max(least, CATCHES_UP * (before - best)))
        if step is None:
            return 0.0
        promised, found = step
        if found.fell <= 0.0:
            self._serves = False
            return 0.0
        self._learn(found)
        self._won += found.fell
        if not STRAIGHT * promised < found.fell < promised / STRAIGHT:
            self._keep(found.fell)
        return found.fell

    def _keep(self, fell: float) -> None:
        """Differences do not hold here: let go of them, but for nuisances' where those may stay."""
        assert self._columns is not None
        nuisances, self._columns = self._columns[: len(self.at.nuisance)], None
        if self._renewed >= RENEWED or self.at.state is None:
            self._serves = False
        elif self._serves:
            assert self._told is not None
            self._lent = Lent(nuisances, self._told)
        elif fell >= WORTH_ANEW:
            self._kept = nuisances
        self._renewed += 1

    def _learn(self, found: Step) -> None:
        """Go there, and let what was found correct the differences (Broyden 1965)."""
        assert self._columns is not None
        # By straight lines: what brings it onto them moves nothing more.
        moved, count = found.there.numbers - self.at.numbers, len(self.at.nuisance)
        moved[:count] = found.change[:count]
        missed = self.here - found.residual - moved @ self._columns
        scaled = moved / self._steps
        self._columns += np.outer(scaled / self._steps, missed) / float(scaled @ scaled)
        self.at, self.here, self._fresh = self._relieved(found.there), found.residual, False

    def _relieved(self, at: Followed) -> Followed:
        """The same simulation, where what is known of numbers says that it costs less."""
        found = relieved(self._samples.system, at)
        less = self._known.cost(found.numbers) < self._known.cost(at.numbers)
        return found if less else at

    def arrived(self) -> Followed:
        """Where one is, with what numbers do to all samples about there, as far as is known."""
        columns = self._last if self._columns is None else self._columns
        if columns is None or self._seen < 1.0:
            return self.at
        assert self._told is not None
        lends, fresh = Lent(columns[: len(self.at.nuisance)], self._told), self._is_same
        return replace(
            self.at, lends=lends, fresh=fresh, borrowed=self._serves and not fresh,
            information=columns @ columns.T,
        )  # fmt: skip
