"""The part of the time that a cause foretells to the noise, where it does not foretell the rest."""

from dataclasses import replace

from analysis.engine.followed import Followed
from analysis.engine.ring_fit import FAR
from analysis.engine.ring_samples import Samples

SOME, CLEAR = 0.2, (1.1, 1.2, 1.3)
"""Of the time: what explains as much, when lines were asked before, is looked at in that alone: up
to where no more than so much is left of the squared misfit of a sample, the least of these with
which it is that long."""

MOST, NEARLY_CLEAR = 0.7, 1.5
"""What explains so much of the time, and leaves no more than this of it, is looked at in that, and
lines need not be asked: a law that is not exact is off most where a motion has ended, and rings
down where everything sticks."""


def clear_part(samples: Samples, best: Followed) -> Followed | None:
    """What foretells a part of the time to the noise, and parameters are hardly bent for it.

    Where they are, it is what came as far as they were not: what grows of itself is followed on in
    any direction.

    Parameters
    ----------
    samples
        By which it is told.
    best
        What was led farthest, not to the noise of the end.

    Returns
    -------
    Followed or None
        With the share of the time up to which little more than noise is left; None: that is short.
    """
    if best.about is not None and best.strain >= FAR:
        best = replace(best.about, share=best.about.telling)
    if best.state is None or best.share == 1.0 or best.strain >= FAR:
        return None
    shares, left = samples.means(best.point, best.share)
    longest = [float(max(shares[left < most], default=0.0)) for most in CLEAR]
    clear = next((one for one in longest if one >= SOME), 0.0)
    return replace(best, share=clear) if clear else None


def most_of_it(samples: Samples, led: Followed) -> Followed | None:
    """What foretells most of the time nearly to the noise, and not the rest of it.

    There a law may be off, and parameters bend for what it is off by: what is not bent counts.

    Parameters
    ----------
    samples
        By which it is told.
    led
        What was led to the end.

    Returns
    -------
    Followed or None
        With the share of the time up to which that is so; None: that is short, or all of it.
    """
    at = led if led.strain < FAR or led.about is None else led.about
    if at.state is None or at.strain >= FAR:
        return None
    shares, left = samples.means(at.point, 1.0)
    share = float(max(shares[left < NEARLY_CLEAR], default=0.0))
    return replace(at, share=share, about=None) if MOST <= share < 1.0 else None
