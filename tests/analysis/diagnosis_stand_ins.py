"""A diagnosis made by hand: a statement and the arrays of its figures, with known numbers."""

from typing import Any

import numpy as np

from analysis.diagnosis.guesses import guesses
from analysis.diagnosis.pictures import Channel, Pictures, Record, Stretch
from analysis.diagnosis.results import Result
from analysis.diagnosis.words import sections

HERTZ = 2.0
FRICTION_N = 0.25
NOISE_N = 0.01
STIFFNESS = 1400.0

STRETCHES = (
    Stretch("rest", 0.0, 1.0, False, False),
    Stretch("steady", 1.0, 5.0, False, True),
    Stretch("steady, held out", 5.0, 7.0, True, True),
)


def pictures() -> Pictures:
    """Two cables with friction that the second simulation has, and the pitch."""
    record = Record("hand", 1.0, HERTZ, "pitch", STRETCHES, (2.03, 2.02, 1.92))
    t_s = np.arange(0.0, 7.0, 0.01)
    angle = 2.0 * np.pi * HERTZ * (t_s - 1.0)
    moving = t_s >= 1.0
    elongation = np.where(moving, 0.005 * np.sin(angle), 0.0)
    rate = np.where(moving, 0.005 * 2.0 * np.pi * HERTZ * np.cos(angle), 0.0)
    spring = 30.0 + STIFFNESS * elongation
    rubbing = spring + FRICTION_N * np.sign(rate)
    noise = NOISE_N * np.random.default_rng(1).standard_normal(len(t_s))
    sigma = np.full_like(t_s, NOISE_N)
    lines = np.ones(11)
    off = np.array([1.0, 200.0, 1.0, 70.0, 1.0, 40.0, 1.0, 20.0, 1.0, 10.0, 1.0])
    channels = [
        Channel(
            "hand", "tension", f"tension {cable}", "N", cable, STIFFNESS,
            t_s, rubbing + noise, sigma, spring, rubbing, elongation, elongation, rate, off, lines,
        )
        for cable in (1, 2)
    ]  # fmt: skip
    none = np.zeros(0)
    frames = t_s[::6]
    pitch = np.deg2rad(1.92) * np.sin(angle[::6]) * (frames >= 1.0)
    channels.append(
        Channel(
            "hand", "pose", "pitch_deg", "rad", 0, 0.0, frames, pitch, np.full_like(pitch, 1e-4),
            pitch * 2.03 / 1.92, pitch, none, none, none, off, lines,
        )
    )  # fmt: skip
    return Pictures((record,), tuple(channels), True)


def cause(effect: str = "pulley_coulomb", **changes: Any) -> dict[str, Any]:
    """Friction at the pulleys of cables 1 and 2."""
    found = {
        "effect": effect,
        "probability": 0.97,
        "present": 0.99,
        "where": {"side": "plant", "cables": [1, 2], "when": "velocity reversal", "harmonics": [1]},
        "parameters": {
            "coulomb_n": {
                "value": 0.25, "sigma": 0.02, "unit": "N",
                "cables": {"1": 0.25, "2": 0.25}, "sigma_cables": {"1": 0.02, "2": 0.02},
            }
        },
        "indistinguishable_from": [],
        "rivals": [],
        "implausible": [],
    }  # fmt: skip
    return {**found, **changes}


def statement(verdict: str = "explained", causes: Any = None, **changes: Any) -> dict[str, Any]:
    """The JSON of such a diagnosis."""
    causes = [cause()] if causes is None else causes
    names = [one["effect"] for one in causes]
    ranked = [
        _weighed(names, 0.0, 0.97, chosen=True),
        _weighed(["cable_hysteresis"], -7.0, 0.03),
        _weighed([], -400.0, 0.0),
    ]
    ranked = ranked if names else [_weighed([], 0.0, 0.99, chosen=True)]
    out = [
        {"effect": "cable_hysteresis", "log_odds": -7.0, "how": "instead", "probability": 0.03},
        {"effect": "air_drag", "log_odds": -3.9, "how": "beside", "probability": 0.01},
        {"effect": "camera_exposure", "log_odds": -350.0, "how": "screened", "probability": 0.0},
    ]
    found: dict[str, Any] = {
        "verdict": verdict,
        "causes": causes,
        "remains": {"significant": False, "where": None, "misfit": 1.0},
        "fit": {
            "noise": {"hand": {"tension 1": {"sigma": NOISE_N, "unit": "N"}}},
            "before": {"used": {"tension": 25.0, "pose": 12.0}, "held_out": {"tension": 26.0}},
            "after": {"used": {"tension": 1.02, "pose": 1.1}, "held_out": {"tension": 1.04}},
        },
        "located": [
            {"run": "hand", "channel": "tension 1", "segment": "steady", "line": 1.0,
             "slow": False, "in_phase": 0.1, "quadrature": 0.3, "unit": "N", "sigmas": 200.0,
             "significance": 0.0}
        ],
        "parameters": [
            {"parameter": "stiffness stiffness_share@3", "moved": 0.05, "unit": "1", "sigmas": 2.5}
        ],
        "next_experiment": None,
        "improved_rig": "results/improved.toml",
        "notes": ["hand: made by hand"],
        "ranking": ranked,
        "ruled_out": out,
        "paper_guesses": guesses(pictures(), ranked, out),
        "balance": [
            {"run": "hand", "means": "Cables 1 and 2 pull otherwise than k ΔL.", "residuals": [
                {"residual": "cables", "sees": "yes", "where": ["cable 1", "cable 2"],
                 "sigmas": 27.7},
                {"residual": "platform", "sees": "no", "where": [], "sigmas": 2.3},
                {"residual": "inner", "sees": "yes", "where": ["inner 1"], "sigmas": 32.0},
            ]}
        ],
        "missing": {"tap": "no run carries a tap"},
        "provenance": {
            "runs": [{"name": "hand", "id": "hand-1", "simulated": True, "reconstruction": None,
                      "rig_sha256": "", "excitation": {}}],
            "simulations": 10,
            "versions": {"cdpr8": "0.1.0"},
        },
    }  # fmt: skip
    found |= changes
    found["words"] = [{"heading": h, "text": t} for h, t in sections(found)]
    return found


def result() -> Result:
    """Statement and arrays."""
    return Result(statement(), pictures())


def _weighed(
    effects: list[str], log_odds: float, probability: float, *, chosen: bool = False
) -> dict[str, Any]:
    return {
        "effects": effects,
        "log_odds": log_odds,
        "tempered": log_odds / 2.0,
        "probability": probability,
        "chosen": chosen,
        "implausible": [],
    }
