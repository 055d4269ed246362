"""A long recording: what its first part tells is led through the whole of it.

Where a ring can be followed is found out by many simulations, and how many does not depend on how
long they are. So most of them are of no more of a recording than it takes to tell causes apart.
"""

from collections.abc import Sequence

from analysis.engine.bundle import Bundle
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed
from analysis.engine.found import Start
from analysis.engine.lifting import LIFTED, MOST_LIFTED
from analysis.engine.part import has_several, rings
from analysis.engine.ring_fit import FAINT
from analysis.engine.system import System
from analysis.engine.until import Until

TURNS, PERIODS = 70.0, 20.0
"""As much leads the way as takes the lowest tone so many turns, and the motion so many periods."""

WORTH_IT = 0.6
"""A first part that is more than this of the whole saves nothing."""


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
    start_s, end_s = float(bundle.t_s[0]), float(bundle.t_s[-1])
    repeats = {one.start_s: one.fundamental_hz for one in bundle.segments if one.fundamental_hz}
    enough_s = max([TURNS / min(bundle.tones_hz), *(PERIODS / hz for hz in repeats.values())])
    begins_s = min(repeats, default=start_s)
    return (begins_s - start_s + enough_s) / (end_s - start_s)


def from_opening(system: System, fitted: Sequence[Fitted]) -> Start | None:
    """From where the whole is led; None: its first part leads nowhere.

    As of a pilot's, what contends is led on: of laws of the same things the best.

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
    kind_of = {one.name: one.kind for one in system.candidates}
    led: dict[frozenset[str], Followed] = {}
    for one in fitted:
        if one.hypothesis.parts and one.log_score > fitted[0].log_score - LIFTED:
            kinds = frozenset(kind_of[name] for name in one.hypothesis.names)
            led.setdefault(kinds, Followed(one.point.nuisance, one.state))
    return Start(nuisance, list(led.values())[:MOST_LIFTED]) if led else None
