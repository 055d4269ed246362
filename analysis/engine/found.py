"""What the ring has told so far, and from where it is asked."""

from collections.abc import Sequence
from typing import NamedTuple

from analysis.engine.array import Array
from analysis.engine.begins import Begins
from analysis.engine.faint import Faint
from analysis.engine.fitted import Fitted
from analysis.engine.followed import Followed, Lent
from analysis.engine.followed_search import FollowedSearch
from analysis.engine.guess import Guess
from analysis.engine.screen import Scored
from analysis.engine.system import System


class Found(NamedTuple):
    """Single causes to first order, hypotheses, whether by the ring, and what was led so far.

    Of several recordings, those that stand aside: hypotheses do not count what is there. Up to
    which share of the time anything can be foretold, what begins at once after that, and a cause
    that foretells some of it. The system with the noise that its samples have, or with loosely
    known parameters as well known as the recording tells, where that is not as stated, and from
    where to begin again with it. Where parameters alone came to the noise, everything about there.
    """

    screened: Sequence[Scored]
    fitted: Sequence[Fitted]
    faint: bool
    led: "Led | None" = None
    aside: tuple[str, ...] = ()
    foretold: float = 1.0
    begins: Begins | None = None
    foretells: Followed | None = None
    again: "tuple[System, Start] | None" = None
    alone: Faint | None = None


class Led(NamedTuple):
    """What was led to the ring's phase so far, and what the ring promised alone."""

    search: FollowedSearch
    single: Sequence[Guess]


class Start(NamedTuple):
    """Where some of the recordings have led to, from where all of them are.

    Attributes
    ----------
    nuisance
        Of parameters alone, in sigmas.
    hypotheses
        What was found there, the best first, with nuisances of the whole system. None: parameters
        alone came to the noise.
    near
        Whether parameters alone ring in phase there.
    lent
        What nuisances do to all samples about there; None: not known.
    seen
        What candidates do about a place that may be near; None: not known.
    stuck
        See `FollowedSearch.follow_from`.
    """

    nuisance: Array
    hypotheses: Sequence[Followed] = ()
    near: bool = False
    lent: Lent | None = None
    seen: Faint | None = None
    stuck: bool = False
