"""What lines tell, led to the ring's phase: held about that, and let go of by and by.

As a motion begins, what sticks is stuck. How strong it is, how soon it slips and how far it was
bent can stand for each other there, and over a short stretch free numbers fit in many valleys, of
which one goes on. Over a longer stretch few valleys are deep, but from afar none is seen. Lines
have told the numbers to some accuracy: as if that were known far better, samples are fitted over a
longer stretch, and again with ever less of that (graduated optimization: Blake and Zisserman 1987).
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from analysis.engine.candidate import Candidate
from analysis.engine.followed import Followed
from analysis.engine.guess import Guess
from analysis.engine.instead import begun_instead
from analysis.engine.kin import kin_left
from analysis.engine.known import Known
from analysis.engine.ring_samples import Samples
from analysis.engine.state import Number
from analysis.engine.way import WINDOWS, Way

STRETCH = WINDOWS[2]
"""Share of the time over which samples are fitted."""

HELD = (1000.0, 100.0, 10.0, 1.0)
"""So many times as much as is known of numbers is held to be known, one after the other;"""

STEPS = 8
"""each for so many steps at most."""

FAR_OFF = 100.0, 5.0
"""From here on, what is left has not been seen to fall to less than a fifth."""

HOPS, CLOSER = 2, 0.98
"""Other laws are begun again, up to so many times, where one has left less than such a share."""

STRENGTH, BEGINS = 0.05, 0.06
"""How well lines tell a magnitude, as a share of it, and what a place of it began with, as a share
of half its range."""


def graduated(samples: Samples, guess: Guess, most: float = np.inf) -> Followed:
    """Where samples of the first stretch lead from what lines tell.

    Parameters
    ----------
    samples
        By which it is led.
    guess
        Fitted to lines.
    most
        What leaves more than this at the end is of no use: it is given up where it is seen to.

    Returns
    -------
    Followed
        From where the ring is to be followed, and what is left there up to `STRETCH`: of a sample,
        with its share of what parameters cost, for a wrong law may bend them a long way.
    """
    at, known = Followed(guess.nuisance, guess.state), as_told(guess)
    way, count = Way(samples, at), int((samples.shares <= STRETCH).sum())
    for times in HELD:
        way.hold(known._replace(information=times * known.information))
        for _ in range(STEPS):
            if not way.step(STRETCH, lost=np.inf):
                break
        left = way.left(STRETCH) + way.at.strain / max(count, 1)
        at = replace(way.at, share=STRETCH, left=left)
        if times <= FAR_OFF[0] and at.left > FAR_OFF[1] * most:
            break
    return at


def alike(
    samples: Samples, best: Followed, candidates: Mapping[str, Candidate]
) -> Iterator[Followed]:
    """Other laws of the same things, from where one has come to over the first stretch.

    Which law it is, and its numbers of shape, lines tell badly where a ring that sticks and slips
    does not repeat itself. Where another leaves less, the others are begun from there again.

    Parameters
    ----------
    samples
        By which it is led.
    best
        Led over the first stretch.
    candidates
        By name.

    Yields
    ------
    Followed
        Each from where the ring is to be followed.
    """
    for _ in range(HOPS):
        here = best
        for known, other, _ in kin_left(here, (), candidates):
            state = begun_instead(samples, here, known, other)
            if state is not None:
                found = graduated(samples, Guess(state, here.nuisance), most=best.left)
                yield found
                best = min(best, found, key=lambda one: one.left)
        if best.left > CLOSER * here.left:
            break


def as_told(guess: Guess) -> Known:
    """What lines tell of a hypothesis; of nuisances, what was known before.

    Parameters
    ----------
    guess
        Fitted to lines.
    """
    state, count = guess.state, len(guess.nuisance)
    sigmas = [_told(state.numbers[i], float(state.values[i])) for i in state.free]
    at = np.concatenate([np.zeros(count), state.values[list(state.free)]])
    information = np.concatenate([np.ones(count), np.array(sigmas) ** -2.0])
    return Known(at, np.diag(information))


def _told(number: Number, value: float) -> float:
    """Standard deviation of a number, as lines tell it."""
    if number.shape is None:
        return max(STRENGTH * abs(value), number.step)
    return BEGINS * 0.5 * (number.high - number.low) if number.shape.term else number.width
