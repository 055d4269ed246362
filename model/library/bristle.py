"""The bristle by which dry friction sticks (LuGre): compiled into every kernel.

Canudas de Wit, Olsson, Astrom & Lischinsky, IEEE Trans. Autom. Control 40 (1995) 419.
"""

from typing import Any

import numpy as np

from model.library.effect import Parameter

CREEP_M_PER_S = 2e-7
"""|v| is at least this: in a minute at rest a bristle forgets 12 um of its way."""

CATCHES_S = 5e-4
"""However fast the cable slips, its bristles take this long to turn over: steps need not be shorter
than what the rest of a machine asks for. `held` makes up for it."""

STEEP = 0.41
"""Largest slope of 1 - (1 + u^4)^(-1/4), rounded up."""

LONGEST_STEP_S = 3.1 * CATCHES_S
"""No step is longer: dp5 follows a decay over up to 3.3 of its times, and beyond that a bristle
grows without bound, however weak the friction."""

BRISTLE_LOSS = Parameter(
    "bristle_loss_s", "s", 5e-4, 0.0, 5e-3, "t_b, loss of the bristle over its stiffness"
)

DAHL_EXPONENT = Parameter(
    "dahl_exponent", "1", 1.0, 1.0, 2.0, "a: how a bristle eases as it nears where it slips"
)
"""Of 1 - z sgn v (Dahl, AIAA J. 14 (1976) 1675): 1 in LuGre's law, 1.5 of ball bearings."""

ELASTIC_SHARE = Parameter(
    "elastic_share", "1", -1.0, -1.0, 0.7, "e: up to this share of where it slips a bristle springs"
)
"""-1: never (LuGre); 0: as it is bent back (Bouc and Wen with beta = gamma); above that, until it
yields (Dupont et al., IEEE Trans. Autom. Control 47 (2002) 787)."""

BENT_AT_REST = Parameter(
    "bent_at_rest", "1", 0.0, -1.0, 1.0, "z_0, z at rest; what it holds there is pretension"
)
"""The state of a bristle is z - z_0, which begins at zero: whatever came before left it bent."""


def bent(
    bristle: Any, slip: Any, presliding_m: Any, level: Any, exponent: Any, elastic: Any
) -> Any:
    """Give z' = v D / (x_s^4 + (c v t)^4)^(1/4), with D as `gives` has it of d = 1 - z sgn v / g.

    Parameters
    ----------
    bristle
        z, how far it is bent, over how far constant friction bends it.
    slip
        v, at which the cable slips over its pulley, m/s.
    presliding_m
        x_s, the way that bends it, m.
    level
        g, the friction at this speed over the constant one.
    exponent
        a, from 1 to 2.
    elastic
        e, from -1 to 0.7.
    """
    size = np.sqrt(slip * slip + CREEP_M_PER_S * CREEP_M_PER_S)
    toward = slip / size - bristle / level
    return size * gives(toward, exponent, elastic) / _way(size, presliding_m, exponent, elastic)


def gives(toward: Any, exponent: Any, elastic: Any) -> Any:
    """Give D = min(d, 1 - e)^a / min(1 - e, 1): how fast a bristle is bent, over how fast at rest.

    Parameters
    ----------
    toward
        d, with the sign of the slip: how far a bristle is from where it slips, over how far
        constant friction bends it.
    exponent, elastic
        As for `bent`.
    """
    most = 1.0 - elastic
    near = np.minimum(np.maximum(toward, -most), most)
    return near * eased(np.abs(near), exponent) / np.minimum(most, 1.0)


def eased(toward: Any, exponent: Any) -> Any:
    """Give d^(a - 1): exact for a of 1, 1.5 and 2, and a parabola through these in between.

    Parameters
    ----------
    toward
        d, how far a bristle is from where it slips, over how far constant friction bends it; beyond
        2, from where it slips the other way, as at 2.
    exponent
        a.
    """
    more = exponent - 1.0
    near = np.minimum(toward, 2.0)
    eases = 4.0 * more * (1.0 - more) * np.sqrt(near) + more * (2.0 * more - 1.0) * near
    return (1.0 - more) * (1.0 - 2.0 * more) + eases


def held(
    bristle: Any, slip: Any, presliding_m: Any, level: Any, exponent: Any, elastic: Any
) -> Any:
    """What a bristle that is bent by z holds: w of z, and 1 - w of g sgn v, which it turns to.

    With w = x_s / (x_s^4 + (c v t)^4)^(1/4) that is, to first order of t, what a bristle would hold
    that turns over at once: of one that sticks all of z, of one that slips the friction itself.

    Parameters
    ----------
    bristle, slip, presliding_m, level, exponent, elastic
        As for `bent`.
    """
    size = np.sqrt(slip * slip + CREEP_M_PER_S * CREEP_M_PER_S)
    sticks = presliding_m / _way(size, presliding_m, exponent, elastic)
    return sticks * bristle + (1.0 - sticks) * level * slip / size


def _way(size: Any, presliding_m: Any, exponent: Any, elastic: Any) -> Any:
    """(x_s^4 + (c v t)^4)^(1/4): the way that bends a bristle, however slow it may turn over, m.

    It turns over fastest as it is bent back, c times as fast as LuGre's: (3 a - 2) / min(1 - e, 1).
    """
    caught = (3.0 * exponent - 2.0) * CATCHES_S * size / np.minimum(1.0 - elastic, 1.0)
    stuck, slid = presliding_m * presliding_m, caught * caught
    return np.sqrt(np.sqrt(stuck * stuck + slid * slid))


def lost_over(presliding_m: Any, bristle_loss_s: Any) -> Any:
    """The largest slope of `held` and of the loss over speed, s/m."""
    return (bristle_loss_s + STEEP * CATCHES_S) / presliding_m


def steepest(coulomb_n: Any, presliding_m: Any, bristle_loss_s: Any) -> Any:
    """F_c (t_b + 0.41 t) / x_s, of a bristle that begins to slip: see `Effect.steepest`."""
    return coulomb_n * lost_over(presliding_m, bristle_loss_s)


def stiffest(coulomb_n: Any, presliding_m: Any) -> Any:
    """F_c / x_s, of a bristle that sticks: see `Effect.stiffest`."""
    return coulomb_n / presliding_m
