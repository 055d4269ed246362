"""Effects of the cables and their pulleys."""

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.concealed import Details, Effect, Law, Parts, between, unsaid
from analysis.challenge.plant.machine import Machine
from analysis.challenge.plant.plant import Hidden

Array = NDArray[np.float64]

BRANCHES = ((0.6, 0.5), (0.4, 2.0))
"""Shares and times of two relaxation branches, over those of the whole."""

QUARTER_TURN = float(np.pi / 2.0)
"""Angle of wrap that friction of a pulley is told for."""


def _rows(**rows: Array) -> Parts:
    """Numbers of the cables, by their names in `layout`."""
    return Parts(Hidden(cables={getattr(at, name): values for name, values in rows.items()}))


def _plain(place: str, **constants: float) -> Law:
    """A law of one number a cable, with constants beside it."""

    def law(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
        fixed = {name: np.full(8, value) for name, value in constants.items()}
        return _rows(**{place: size * mask}, **fixed)

    return law


def _coulomb(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    static = details.get("static_ratio", 1.0)
    return _rows(
        COULOMB=size * mask,
        STATIC=size * static * mask,
        STRIBECK=np.full(8, details.get("stribeck_m_per_s", 1.0)),
        BRISTLE=np.full(8, details["presliding_m"]),
    )


def _capstan(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return _rows(
        CAPSTAN=size * QUARTER_TURN * mask, CAPSTAN_BRISTLE=np.full(8, details["presliding_m"])
    )


def _relaxation(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    rows: dict[int, Array] = {}
    for j, (share, time) in enumerate(BRANCHES):
        rows[at.RELAX + j] = size * share * mask
        rows[at.RELAX_TIME + j] = np.full(8, details["relaxation_s"] * time)
    return Parts(Hidden(cables=rows))


def _loop(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return _rows(LOOP=size * mask, LOOP_YIELD=np.full(8, details["yield_m"]))


def _creep(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return _rows(CREEP=size * mask, CREEP_TIME=np.full(8, details["settled_s"]))


def _play(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    return _rows(PLAY=size * mask, HOLD=np.full(8, details["hold_n"]))


def _frame(size: float, mask: Array, details: Details, machine: Machine) -> Parts:
    platform = {
        at.FRAME_GIVE: size,
        at.FRAME_HZ: details["frame_hz"],
        at.FRAME_LOSS: details["frame_loss"],
    }
    return Parts(Hidden(platform=platform))


CABLE_EFFECTS = (
    Effect(
        "pulley_coulomb",
        "plant",
        "coulomb_n",
        "N",
        0.3,
        3.0,
        _coulomb,
        "some",
        between(presliding_m=(3e-5, 1e-4)),
    ),
    Effect(
        "pulley_capstan",
        "plant",
        "friction",
        "1",
        0.02,
        0.2,
        _capstan,
        "some",
        between(presliding_m=(3e-5, 1e-4)),
    ),
    Effect(
        "pulley_stribeck",
        "plant",
        "coulomb_n",
        "N",
        0.3,
        3.0,
        _coulomb,
        "some",
        between(presliding_m=(3e-5, 8e-5), static_ratio=(1.3, 2.0), stribeck_m_per_s=(3e-3, 2e-2)),
    ),
    Effect(
        "pulley_presliding",
        "plant",
        "coulomb_n",
        "N",
        0.4,
        3.0,
        _coulomb,
        "some",
        between(presliding_m=(4e-4, 3e-3)),
    ),
    Effect(
        "cable_viscous",
        "plant",
        "viscous_n_s_per_m",
        "N s/m",
        4.0,
        50.0,
        _plain("VISCOUS", VISCOUS_TIME=1.2e-3),
        "all",
        straight=True,
    ),
    Effect(
        "cable_relaxation",
        "plant",
        "branch_share",
        "1",
        0.08,
        0.5,
        _relaxation,
        "all",
        between(relaxation_s=(0.015, 1.0)),
        straight=True,
    ),
    Effect(
        "cable_hysteresis",
        "plant",
        "loop_share",
        "1",
        0.08,
        0.5,
        _loop,
        "all",
        between(yield_m=(3e-4, 3e-3)),
    ),
    Effect(
        "cable_stiffening",
        "plant",
        "cubic_n_per_m3",
        "N/m3",
        4e6,
        8e7,
        _plain("CUBIC", CUBIC_REACH=0.02),
        "all",
        straight=True,
    ),
    Effect("cable_slack", "plant", "slack_m", "m", 2e-3, 0.015, _plain("SLACK"), "one"),
    Effect(
        "cable_creep",
        "plant",
        "creep_e_share",
        "1",
        4e-3,
        0.05,
        _creep,
        "all",
        between(settled_s=(0.3, 5.0)),
        told=unsaid,
    ),
    Effect("cable_modes", "plant", "coupling", "1", 0.8, 2.0, _plain("MODES"), "all"),
    Effect("cable_end_forcing", "plant", "forcing_share", "1", 0.8, 2.0, _plain("SHAKEN"), "all"),
    Effect("cable_sag", "plant", "weight_share", "1", 1.0, 4.0, _plain("SAG"), "all"),
    Effect(
        "cable_structural",
        "plant",
        "loss_factor",
        "1",
        0.03,
        0.2,
        _plain("LOSS_FACTOR"),
        "all",
        straight=True,
    ),
    Effect(
        "anchor_play",
        "plant",
        "play_m",
        "m",
        2e-4,
        2e-3,
        _play,
        "some",
        between(hold_n=(0.2, 1.0)),
    ),
    Effect(
        "pulley_geometry",
        "plant",
        "radius_m",
        "m",
        0.03,
        0.12,
        _plain("RADIUS"),
        "all",
        straight=True,
    ),
    Effect(
        "pulley_inertia",
        "plant",
        "equivalent_kg",
        "kg",
        0.06,
        0.3,
        _plain("RIM"),
        "all",
        straight=True,
    ),
    Effect(
        "frame_compliance",
        "plant",
        "compliance_m_per_n",
        "m/N",
        3e-5,
        2.5e-4,
        _frame,
        "none",
        between(frame_hz=(12.0, 40.0), frame_loss=(0.01, 0.1)),
        straight=True,
    ),
)
