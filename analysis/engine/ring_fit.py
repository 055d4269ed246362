"""The ring itself: parameters moved until a simulation rings in the recording's own phase.

Naming what is strong leaves rings out, for their phase is lost where parameters are a little off.
Over a short stretch none is far off: parameters are led to the phase there first, and then over
longer stretches, as far as it can be followed. Where it cannot be followed further tells as much.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from analysis.engine.array import Array
from analysis.engine.followed import Followed, Lent
from analysis.engine.known import Known
from analysis.engine.ring_samples import Samples
from analysis.engine.state import State
from analysis.engine.system import System
from analysis.engine.way import LOST, STRAIN, WINDOWS, Way

EFFORT, PATIENCE = 1000.0, 300.0
"""Whole simulations after which nothing is led on: some ten times all differences. At the beginning
of the motion it is less: what is stuck there, above the noise, will not come far."""

STEPS, STEPS_BETWEEN = 15, 5
"""So many steps are taken for each window, at most, and in those that had to be put in between:
each is led through until no step promises anything. What is left behind is a wrong turn in the
next."""

TELLING = 10.0
"""Where this is left of the squared misfit of a sample, the ring has just been lost."""

STRETCHES = 200
"""How closely it is told up to where a ring could be followed."""

FAINT = 1.5
"""A ring is followed as far as no more than this is left of the squared misfit of a sample."""

FAR = 150.0
"""Parameters whose squares come to more than this, in sigmas, have made up for something, though
nothing is left."""

GOES_ON = 6.0
"""With a cause on, a ring is followed on while no more than this is left: laws are not exact."""

BEHIND = 600.0
"""What stays this far behind another, in squared misfit, is not followed further."""


def follow_ring(
    system: System,
    nuisance: Array,
    state: State | None = None,
    *,
    held: str = "",
    everything: bool = False,
    near: bool = False,
    ahead: Mapping[float, float] | None = None,
    most: float = EFFORT,
    lent: Lent | None = None,
    known: Known | None = None,
    passed: float = 0.0,
) -> Followed:
    """Free numbers at which the simulation, ring and all, fits best.

    Parameters
    ----------
    system
        What is simulated.
    nuisance, state
        From where.
    held, everything
        See `Samples`.
    near
        The phase is near enough for the whole of the time at once.
    ahead
        Costs of another hypothesis: what stays far behind it is given up.
    most
        Whole simulations, after which no step is begun.
    lent
        See `Way`: for what is near another hypothesis, over the same samples.
    known
        What is known of free numbers; None: priors of nuisances.
    passed
        Share of the time over which they were led there.
    """
    samples = Samples(system, held=held, everything=everything)
    way = Way(samples, Followed(nuisance, state), lent, known)
    costs = {one: way.cost(one) for one in WINDOWS if one <= passed}
    share = passed
    came: Followed | None = None
    about: Followed | None = None
    while share < 1.0 and samples.effort < most:
        impatient = samples.effort > PATIENCE + (most - PATIENCE) * share
        stuck = way.left(share) > way.allowed(share)
        # What is in phase over all of the time is nearly there.
        if impatient and stuck and way.left(1.0) > way.in_phase(share):
            break
        passed, share = share, 1.0 if near else way.window(share)
        best = (ahead or {}).get(share, np.inf)
        over = [one for one in WINDOWS if passed < one <= share]
        for _ in range(STEPS * len(over) or STEPS_BETWEEN):
            if samples.effort > most or not way.step(
                share, lost=LOST if costs or near else np.inf, best=best
            ):
                break
        if came is None and share == 1.0:
            came = Followed(nuisance, state)
        if about is None and came is not None and way.strained(share):
            about = replace(came, telling=share)
        came = way.at
        costs |= {one: way.cost(one) for one in over}
        behind = way.cost(share) > best + BEHIND
        most_left = max(FAINT if state is None else GOES_ON, way.allowed(share))
        if way.left(share) > most_left or behind:
            break
    way.look(1.0)
    lefts = [(way.left(share), share) for share in np.linspace(0.0, 1.0, STRETCHES + 1)[1:]]
    lost = (one for one in lefts if one[0] > max(FAINT, way.allowed(one[1])))
    left, share = next(lost, lefts[-1])
    to_noise = share == 1.0 and left <= FAINT
    # Where it began as far from what is known, nothing was told better.
    made_up = about is not None and is_far(way.at) and not is_far(about)
    return replace(
        way.arrived(),
        share=float(share),
        left=left,
        telling=float(next((one[1] for one in lefts if one[0] > TELLING), lefts[-1][1])),
        about=about if made_up or not to_noise else None,
        misfit=float(way.here @ way.here),
        roughness=samples.roughness(way.here),
        effort=samples.effort,
        costs=costs,
    )


def is_far(at: Followed) -> bool:
    """Whether parameters are so far from what is known of them that something else is there.

    Parameters
    ----------
    at
        Where they were led, nothing left out.
    """
    return at.strain > FAR or (at.is_bent and at.strain > STRAIN)
