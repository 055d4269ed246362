"""Terms of a cable's measured state that a proposed law can be made of."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STANDSTILL = 0.02
"""Of the greatest speed: sign(speed) passes through zero over about this."""


@dataclass(frozen=True)
class State:
    """A cable over one cycle, each of shape (n,).

    Attributes
    ----------
    elongation_m, speed_m_per_s
        Beyond the length at rest, and its rate.
    tension_n
        By the law of the rig file.
    angle_rad
        Of the platform about the driven axis, less its mean.
    t_s
        When the cycle was.
    """

    elongation_m: Array
    speed_m_per_s: Array
    tension_n: Array
    angle_rad: Array
    t_s: Array

    @property
    def sign(self) -> Array:
        """Of the speed, smoothed about standstill."""
        speed = self.speed_m_per_s
        return np.asarray(np.tanh(speed / (STANDSTILL * np.abs(speed).max() + 1e-12)))


@dataclass(frozen=True)
class Term:
    """One term of a law.

    Attributes
    ----------
    name
        As it is told.
    unit
        Of its coefficient.
    of
        Its value over a state, shape (n,).
    check
        What would show that it is this.
    common
        Whether it is of the platform: asked only where all cables are off.
    """

    name: str
    unit: str
    of: Callable[[State], Array]
    check: str
    common: bool = False


_LONGER = "another amplitude: {} (figure of loops)"
_QUICKER = "another frequency at the same amplitude: {} (figure of residual against speed)"
_RUBS = _QUICKER.format("its size stays") + "; a free decay is linear"

TERMS: tuple[Term, ...] = (
    Term("elongation", "N/m", lambda s: s.elongation_m,
         "weights hung on the platform: the slope of tension over elongation"),
    Term("elongation²", "N/m2", lambda s: s.elongation_m**2,
         _LONGER.format("it grows with the square, and pulls alike both ways")),
    Term("elongation³", "N/m3", lambda s: s.elongation_m**3,
         _LONGER.format("it grows with the cube")),
    Term("|elongation|", "N/m", lambda s: np.abs(s.elongation_m),
         _LONGER.format("it grows in proportion, with a kink at the length at rest")),
    Term("speed", "N s/m", lambda s: s.speed_m_per_s,
         _QUICKER.format("it grows in proportion") + "; a tap tells it from a late camera"),
    Term("speed |speed|", "N s2/m2", lambda s: s.speed_m_per_s * np.abs(s.speed_m_per_s),
         _QUICKER.format("it grows with the square")),
    Term("|speed|", "N s/m", lambda s: np.abs(s.speed_m_per_s),
         _QUICKER.format("it grows in proportion, alike both ways")),
    Term("sign(speed)", "N", lambda s: s.sign, _RUBS),
    Term("tension sign(speed)", "1", lambda s: s.tension_n * s.sign,
         "another pretension: it grows in proportion"),
    Term("|elongation| sign(speed)", "N/m", lambda s: np.abs(s.elongation_m) * s.sign,
         "another amplitude and another frequency: it grows with the first alone"),
    Term("elongation speed", "N s/m2", lambda s: s.elongation_m * s.speed_m_per_s,
         "another amplitude: it grows with the square"),
    Term("tension", "1", lambda s: s.tension_n,
         "a certified weight on the cell: its gain"),
    Term("time", "N/s", lambda s: s.t_s, "ten minutes at rest"),
    Term("platform angle", "N/rad", lambda s: s.angle_rad,
         "another axis of motion", common=True),
    Term("platform angle²", "N/rad2", lambda s: s.angle_rad**2,
         "another axis of motion", common=True),
)  # fmt: skip


def values(state: State) -> Array:
    """Of all terms, shape (n, terms)."""
    return np.column_stack([one.of(state) for one in TERMS])
