"""Effects of the cables and of the frame that holds them."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.concealed import (
    UNEVEN,
    Details,
    Effect,
    Law,
    Parts,
    Scene,
    between,
    mean_told,
    uneven,
    unsaid,
)
from analysis.challenge.outsider.plant import Hidden

Array = NDArray[np.float64]

ANY = {"one": 0.25, "pair": 0.35, "all": 0.4}
MORE = {"pair": 0.5, "all": 0.5}
ALL = {"all": 1.0}

BRANCHES = ((0.85, 1.0), (0.15, 8.0))
"""Shares and times of two relaxation branches, over those of the whole."""

LADDER_S = 2.0 * 10.0 ** np.arange(-3.0, 2.0)
"""Times of the Maxwell branches of structural loss, a decade apart, s."""

LOOP_POWER = 1.5
IWAN_OVER_BOUC_WEN = 1.6
"""Yield of Iwan's sliders over that of a Bouc-Wen loop about as wide."""

POST_LOSS = 0.03
"""Share of critical damping of a post."""

UNILATERAL_N = 1.0


def _row(place: int) -> Law:
    """A law of one number of each cable."""

    def law(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
        return Parts(Hidden({place: uneven(size, mask, details)}))

    return law


def _relaxation(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Two Maxwell branches beside the spring; at once the cable is stiffer by the size."""
    rows = {}
    for j, (share, time) in enumerate(BRANCHES):
        rows[at_.MAXWELL + j] = share * size * scene.true.stiffness * mask
        rows[at_.MAXWELL_TIME + j] = time * details["relaxation_s"] * mask
    return Parts(Hidden(rows))


def _structural(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Five branches whose loss is nearly the same at all frequencies.

    The spring is made softer, so that the stiffness at the drive's frequency stays as it was.
    """
    branch = size * 2.0 / np.pi * np.log(10.0)
    quick = (2.0 * np.pi * scene.excitation.frequency_hz * LADDER_S) ** 2
    softer = 1.0 - float(np.sum(branch * quick / (1.0 + quick)))
    rows = {at_.STIFFNESS: scene.true.stiffness * softer * mask}
    for j, time_s in enumerate(LADDER_S.tolist()):
        rows[at_.MAXWELL + j] = branch * scene.true.stiffness * mask
        rows[at_.MAXWELL_TIME + j] = time_s * mask
    return Parts(Hidden(rows))


def _hysteresis(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """A share of the stiffness that is Bouc and Wen's, or Iwan's five sliders: one or the other."""
    if details["sliders"] > 0.5:
        yield_m = IWAN_OVER_BOUC_WEN * details["yield_m"]
        return Parts(Hidden({at_.SLIDING: size * mask, at_.SLIDING_YIELD: yield_m * mask}))
    rows = {
        at_.LOOP: size * mask,
        at_.LOOP_YIELD: details["yield_m"] * mask,
        at_.LOOP_POWER: LOOP_POWER * mask,
    }
    return Parts(Hidden(rows))


def _either(generator: np.random.Generator) -> dict[str, float]:
    drawn = {"yield_m": float(generator.uniform(1.2e-3, 3e-3))}
    return drawn | {"sliders": float(generator.integers(2))}


def _slack(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """T = max(0, T); the rig file's pretension is so low that it matters."""
    return Parts(Hidden({at_.UNILATERAL: mask * (size > 0.5 * UNILATERAL_N)}))


def _end_forcing(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Three modes in two planes, shaken by the anchor, whose slope the platform feels."""
    on = mask * (size > 0.5)
    rows = {at_.SHAKEN: on, at_.MODES: 3.0 * on, at_.PLANES: 2.0 * on}
    return Parts(Hidden(rows))


def _sag(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    return Parts(Hidden(weight_share=size * mask))


def _frame(size: float, mask: Array, details: Details, scene: Scene) -> Parts:
    """Size: give of a post in each of three directions."""
    stiffness, mass = 1.0 / size, details["post_kg"]
    platform = {
        at_.POST_STIFFNESS: stiffness,
        at_.POST_MASS: mass,
        at_.POST_LOSS: 2.0 * POST_LOSS * float(np.sqrt(stiffness * mass)),
    }
    return Parts(Hidden(platform=platform))


CABLE_EFFECTS = (
    Effect(
        "cable_viscous", "plant", "viscous_n_s_per_m", "N s/m", 9.0, 50.0, _row(at_.VISCOUS), ANY,
        UNEVEN, told=mean_told("viscous_n_s_per_m"), straight=True,
    ),
    Effect(
        "cable_relaxation", "plant", "branch_share", "1", 0.13, 0.5, _relaxation, ANY,
        between(relaxation_s=(0.04, 0.3)), straight=True,
    ),
    Effect("cable_hysteresis", "plant", "loop_share", "1", 0.15, 0.6, _hysteresis, ANY, _either),
    Effect(
        "cable_stiffening", "plant", "beta", "1", 0.28, 1.2, _row(at_.STIFFENING), MORE,
        told=unsaid, straight=True,
    ),
    Effect(
        "cable_slack", "plant", "unilateral", "1", 1.0, 1.0, _slack, ALL, told=unsaid, least=1.0
    ),
    Effect(
        "cable_creep", "plant", "creep_m", "m", 1.2e-4, 1e-3, _row(at_.CREEP), MORE, UNEVEN,
        told=unsaid, straight=True,
    ),
    Effect(
        "cable_end_forcing", "plant", "forcing_share", "1", 1.0, 1.0, _end_forcing, ALL, least=1.0
    ),
    Effect("cable_sag", "plant", "weight_share", "1", 1.0, 1.0, _sag, ALL),
    Effect(
        "cable_structural", "plant", "loss_factor", "1", 0.04, 0.15, _structural, MORE,
        straight=True,
    ),
    Effect(
        "anchor_play", "plant", "half_gap_m", "m", 1e-4, 8e-4, _row(at_.PLAY),
        {"one": 0.5, "pair": 0.5}, told=unsaid,
    ),
    Effect(
        "frame_compliance", "plant", "compliance_m_per_n", "m/N", 7e-5, 2.5e-4, _frame, ALL,
        between(post_kg=(1.5, 4.0)), straight=True,
    ),
)  # fmt: skip
