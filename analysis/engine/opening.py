"""A long recording: what its first part tells is led through the whole of it.

Where a ring can be followed is found out by many simulations, and how many does not depend on how
long they are. So most of them are of no more of a recording than it takes to tell causes apart.
"""

from collections.abc import Sequence

from analysis.engine.by_ring import Start
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.part import has_several, rings
from analysis.engine.ring_fit import FAINT
from analysis.engine.system import Bundle, System
from analysis.engine.until import Until

TURNS, PERIODS = 70.0, 20.0
"""As much leads the way as takes the lowest tone so many turns, and the motion so many periods."""

WORTH_IT = 0.6
"""A first part that is more than this of the whole saves nothing."""

BEHIND, MOST = 40.0, 6
"""What is no farther behind the best of the first part, as a score, is led through the whole, at
most so many; of laws of the same things the best."""


def opening_of(system: System) -> Until | None:
    """The first part of a long recording; None: the system is not one.

    Parameters
    ----------
    system
        Any.
    """
    if isinstance(system, Until) or has_several(system) or not rings(system):
        return None
    share = max(_share(one) for one in system.bundles if one.tones_hz)
    return Until(system, share) if share < WORTH_IT else None


def _share(bundle: Bundle) -> float:
    """Of the time of a bundle, how much leads the way."""
    moves = [one for one in bundle.segments if one.fundamental_hz is not None]
    enough_s = TURNS / min(bundle.tones_hz)
    begins_s = min((one.start_s for one in moves), default=float(bundle.t_s[0]))
    repeats_hz = min((one.fundamental_hz or 0.0 for one in moves), default=0.0)
    if repeats_hz > 0.0:
        enough_s = max(enough_s, PERIODS / repeats_hz)
    start_s, end_s = float(bundle.t_s[0]), float(bundle.t_s[-1])
    return (begins_s - start_s + enough_s) / (end_s - start_s)


def from_opening(system: System, fitted: Sequence[Fitted]) -> Start | None:
    """From where the whole is led; None: its first part leads nowhere.

    Parameters
    ----------
    system
        The whole.
    fitted
        What the first part says, led to the ring's phase, the best first; the null among them.
    """
    alone = next((one for one in fitted if not one.hypothesis.parts), None)
    if alone is None:
        return None
    nuisance = alone.point.nuisance
    if alone.left < FAINT:
        return Start(nuisance)
    family = {one.name: one.family or one.name for one in system.candidates}
    led: dict[frozenset[str], Followed] = {}
    for one in fitted:
        if one.hypothesis.parts and one.log_score > fitted[0].log_score - BEHIND:
            kinds = frozenset(family[name] for name in one.hypothesis.names)
            led.setdefault(kinds, Followed(one.point.nuisance, one.state))
    return Start(nuisance, list(led.values())[:MOST]) if led else None
