"""Numbers of a machine that are a cause's own: what they have moved by is the cause's.

A number that is uncertain and may be off is a nuisance and a cause's magnitude at once, and the
simulator adds the two. However much of it is the one or the other, the simulation is the same; but
the nuisance costs what it moves by, and the cause does not. Differences that serve for a while tell
the two apart by what they are off by, and no step then leads from one to the other.
"""

from dataclasses import replace

import numpy as np

from analysis.engine.followed import Followed
from analysis.engine.system import System, own_nuisances


def relieved(system: System, at: Followed) -> Followed:
    """The same simulation, with nuisances as little strained as causes that are on allow.

    Parameters
    ----------
    system
        What is simulated.
    at
        Where; what is told of it but for its point stays as it was told.

    Returns
    -------
    Followed
        There; the same, where no cause has such numbers.
    """
    if at.state is None:
        return at
    places = own_nuisances(system.nuisances)
    nuisance, values, moves = at.nuisance.copy(), at.state.values.copy(), False
    for i in at.state.free:
        number = at.state.numbers[i]
        terms = [(number.candidate, one) for one in number.terms]
        own = [places[one] for one in terms if one in places]
        if number.shape is not None or len(own) < len(terms):
            continue
        sigmas = np.array([system.nuisances[k].sigma for k in own])
        # Of several places that have one value, what they have moved by together.
        shift = float(np.sum(nuisance[own] / sigmas) / np.sum(sigmas**-2.0))
        shift = float(np.clip(values[i] + shift, number.low, number.high)) - values[i]
        nuisance[own] -= shift / sigmas
        values[i] += shift
        moves = moves or shift != 0.0
    if not moves:
        return at
    return replace(at, nuisance=nuisance, state=replace(at.state, values=values))
