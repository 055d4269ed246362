"""Effects of the pulleys: friction and inertia.

All friction is LuGre's; at rest the bristles are bent by up to 0.6 of full slip, and what they hold
then is in the pretension. The cell sits between platform and pulley and sees it.
"""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.concealed import (
    UNEVEN,
    Details,
    Effect,
    Parts,
    Scene,
    between,
    both,
    each,
    mean_told,
    of_each,
    uneven,
)
from analysis.challenge.outsider.plant import Hidden

Array = NDArray[np.float64]

ANY = {"one": 0.25, "pair": 0.35, "all": 0.4}
MORE = {"pair": 0.5, "all": 0.5}

BENT = each("bent", -0.6, 0.6)
"""How far the bristles are bent at rest, in shares of full slip."""

QUARTER_TURN = float(np.pi / 2.0)
"""Angle of wrap that the fitting library tells friction of a pulley for."""

NO_FRICTION_N = 1e-6
"""Stands for Coulomb's force where there is the capstan's alone: LuGre divides by their sum."""

FRONT_OVER_WHOLE, BACK_OVER_WHOLE = 5.0, 1.25
"""Stiffness of a cable before and behind its pulley over that of the whole; in series 1."""

BEARING_N_S_PER_M = 1.5
"""Loss of a bearing of a pulley with inertia; written as bristles of no stiffness."""


def _bristles(force: Array, length_m: float, loss: float, details: Details, **more: Array) -> Parts:
    """Bristles that slide at a force of each cable and bend by a length until then."""
    rows = {
        at_.COULOMB: force,
        at_.STATIC: more.get("static", force),
        at_.STRIBECK: np.full(8, details.get("stribeck_m_per_s", 1.0)),
        at_.BRISTLE: more.get("static", force) / length_m,
        at_.BRISTLE_LOSS: loss * (force > 0.0),
    }
    return Parts(Hidden(rows, bristles=of_each(details, "bent", 0.0)))


def _coulomb(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return _bristles(uneven(size, mask, details), details["presliding_m"], 0.4, details)


def _stribeck(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    force = uneven(size, mask, details)
    static = force * details["static_ratio"]
    return _bristles(force, details["presliding_m"], 0.5, details, static=static)


def _presliding(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return _bristles(uneven(size, mask, details), details["presliding_m"], 0.0, details)


def _capstan(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Size: friction times the angle of wrap."""
    share = uneven(size, mask, details)
    rows = {
        at_.CAPSTAN: share,
        at_.COULOMB: NO_FRICTION_N * mask,
        at_.STATIC: NO_FRICTION_N * mask,
        at_.STRIBECK: np.ones(8),
        at_.BRISTLE: share * scene.true.pretension / details["presliding_m"],
        at_.BRISTLE_LOSS: 0.3 * mask,
    }
    return Parts(Hidden(rows, bristles=of_each(details, "bent", 0.0)))


def _inertia(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Two springs in series, the pulley's rim between them; the cell is on the one in front."""
    rows = {
        at_.FRONT: FRONT_OVER_WHOLE * scene.true.stiffness * mask,
        at_.BACK: BACK_OVER_WHOLE * scene.true.stiffness * mask,
        at_.RIM_MASS: size * mask,
        # Bristles this soft hold nothing: what is left of LuGre is its damper.
        at_.BRISTLE: 1e-9 * mask,
        at_.BRISTLE_LOSS: BEARING_N_S_PER_M * mask,
        at_.COULOMB: mask,
        at_.STATIC: mask,
        at_.STRIBECK: np.ones(8),
    }
    return Parts(Hidden(rows))


FRICTION_EFFECTS = (
    Effect(
        "pulley_coulomb", "plant", "coulomb_n", "N", 0.32, 2.0, _coulomb, ANY,
        both(UNEVEN, BENT, between(presliding_m=(25e-6, 25e-6))),
        told=mean_told("coulomb_n"),
    ),
    Effect(
        "pulley_capstan", "plant", "mu_theta", "1", 0.035, 0.2, _capstan, ANY,
        both(UNEVEN, BENT, between(presliding_m=(30e-6, 30e-6))),
        told=mean_told("friction", 1.0 / QUARTER_TURN),
    ),
    Effect(
        "pulley_stribeck", "plant", "coulomb_n", "N", 0.25, 1.5, _stribeck, ANY,
        both(
            UNEVEN, BENT,
            between(
                presliding_m=(20e-6, 20e-6), static_ratio=(1.6, 2.2), stribeck_m_per_s=(4e-3, 0.015)
            ),
        ),
        told=mean_told("coulomb_n"),
    ),
    Effect(
        "pulley_presliding", "plant", "coulomb_n", "N", 0.55, 2.5, _presliding, ANY,
        both(UNEVEN, BENT, between(presliding_m=(4e-4, 1.4e-3))),
        told=mean_told("coulomb_n"),
    ),
    Effect(
        "pulley_inertia", "plant", "rim_mass_kg", "kg", 0.22, 0.8, _inertia, MORE,
        told=lambda size, mask, details: {"equivalent_kg": size}, least=0.02,
    ),
)  # fmt: skip
