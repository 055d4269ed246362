"""A diagnosis as the JSON of design, section 6."""

import re
from collections.abc import Sequence
from dataclasses import replace
from math import degrees, hypot, isfinite
from typing import Any

from analysis.diagnosis.candidates import PAIRS
from analysis.diagnosis.machine import RecordedMachine
from analysis.engine.candidate import Candidate, Shape
from analysis.engine.cause import Cause
from analysis.engine.confirm import Confirmation
from analysis.engine.diagnosis import Diagnosis
from analysis.engine.locate import Finding
from analysis.engine.until import until_of

WHEN = {
    "pulley_coulomb": "velocity reversal",
    "pulley_capstan": "velocity reversal, more at high tension",
    "pulley_stribeck": "velocity reversal",
    "pulley_presliding": "after velocity reversal",
    "anchor_play": "after reversal of the force",
    "drive_backlash": "after reversal of the drive",
    "cable_slack": "low tension",
    "cell_saturation": "high tension",
    "frames_dropped": "from one frame on",
    "cable_creep": "slowly, over the run",
    "cell_drift": "slowly, over the run",
    "clock_drift": "growing over the run",
    "drive_frequency": "growing over the run",
}

SHOWN_SHARE = 0.1
"""A cable whose magnitude is less than this, of the largest, is not among those named."""

SHOWN_SIGMAS = 2.0

AS_STRONG = 0.5, 1.0
"""Beside cables that stand out, one that is so much of the strongest of them, by so many sigmas."""

NOT_RULED_OUT = 0.1
"""Where nothing is named, what is likelier than this is told."""


def statement(machine: RecordedMachine, diagnosis: Diagnosis) -> dict[str, Any]:
    """The JSON of design, section 6, as a dictionary."""
    sides = {one.name: one.side for one in machine.candidates}
    judgement, remains = diagnosis.judgement, diagnosis.remains
    causes = [] if judgement is None else [_cause(one, sides, machine) for one in judgement.causes]
    likely: list[dict[str, Any]] = []
    if judgement is not None and diagnosis.search is not None and diagnosis.verdict == "none":
        sets = [one.hypothesis.names for one in diagnosis.search.fitted]
        likely = not_ruled_out(sets, judgement.probability)
    said: dict[str, Any] = {
        "verdict": diagnosis.verdict or "not asked",
        "causes": causes,
        "not_ruled_out": likely,
        "limits": _limits(diagnosis) if diagnosis.verdict == "none" else [],
        "remains": {
            "significant": bool(remains and remains.significant),
            "where": where(remains.findings) if remains and remains.significant else None,
            "misfit": None if remains is None else remains.misfit,
            "not_followed": [] if diagnosis.search is None else list(diagnosis.search.aside),
            "shown": diagnosis.judgement is not None and diagnosis.judgement.shown,
            **_foretold(diagnosis),
        },
        "fit": _fit(machine, diagnosis.confirmation),
        "located": [_finding(one) for one in diagnosis.findings],
        "parameters": moved_parameters(machine, diagnosis),
        "next_experiment": None,
        "improved_rig": None,
        "notes": [
            *(f"{one.run.name}: {note}" for one in machine.recordings for note in one.notes),
            *diagnosis.notes,
        ],
    }
    return said


def not_ruled_out(
    sets: Sequence[tuple[str, ...]], probability: Sequence[float]
) -> list[dict[str, Any]]:
    """Effects that are likely all the same, where nothing is named; the likeliest first.

    Parameters
    ----------
    sets, probability
        Of each hypothesis that was weighed its effects, and how likely it is.
    """
    found: dict[str, float] = {}
    for names, share in zip(sets, probability, strict=True):
        for name in names:
            found[name] = found.get(name, 0.0) + share
    likely = sorted(found.items(), key=lambda one: -one[1])
    return [{"effect": name, "probability": share} for name, share in likely
            if share > NOT_RULED_OUT]  # fmt: skip


def _foretold(diagnosis: Diagnosis) -> dict[str, Any]:
    """Up to when the recording counts, in s, and what begins at once later; null: no end."""
    cut = until_of(diagnosis.system)
    at_once = None if cut is None else cut.begins
    return {
        "foretold_until_s": None if cut is None else cut.end_s,
        "begins_s": None if at_once is None else at_once.t_s,
        "begins_in": None if at_once is None else at_once.channel,
    }


def _limits(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """From which size on each effect would not have gone unnoticed; null: at no plausible one."""
    return [
        {
            "effect": one.candidate,
            "parameter": one.parameter,
            "unit": one.unit,
            "everywhere": one.everywhere if isfinite(one.everywhere) else None,
            "placed": one.in_one is not None,
            "in_one_cable": one.in_one if one.in_one is not None and isfinite(one.in_one) else None,
        }
        for one in (() if diagnosis.search is None else diagnosis.search.limits)
    ]


def cables_of(cause: Cause) -> list[int]:
    """Cables where it acts; none: it has no choice.

    Those where it stands out of its uncertainty, and those where it is about as strong: numbers of
    shape leave the size of all of them open alike. Where it stands out nowhere, though it is there,
    its size is open, as that of a friction within its presliding: then those where it is large.
    """
    places = {term: re.fullmatch(r".*@(\d+)", term) for term in cause.values}
    own = {term: int(match.group(1)) for term, match in places.items() if match is not None}
    largest = max((abs(cause.values[term]) for term in own), default=0.0)
    large = [term for term in own if abs(cause.values[term]) > SHOWN_SHARE * largest]
    sure = [term for term in large if _stands_out(cause, term, SHOWN_SIGMAS)]
    share, sigmas = AS_STRONG
    strong = share * max((abs(cause.values[term]) for term in sure), default=0.0)
    beside = [
        term
        for term in large
        if sure and abs(cause.values[term]) > strong and _stands_out(cause, term, sigmas)
    ]
    return sorted({own[term] for term in [*sure, *beside] or large})


def other_cables(cause: Cause) -> list[list[int]]:
    """Sets of cables where it might as well be: the data hardly tell them from `cables_of`."""
    known = [cables_of(cause)]
    for values in cause.elsewhere:
        other = cables_of(replace(cause, values=values, sigmas={}))
        # What came to nothing in every cable is nowhere else.
        if other and other not in known:
            known.append(other)
    return known[1:]


def _stands_out(cause: Cause, term: str, sigmas: float) -> bool:
    return abs(cause.values[term]) > sigmas * cause.sigmas.get(term, 0.0)


def _cause(cause: Cause, sides: dict[str, str], machine: RecordedMachine) -> dict[str, Any]:
    cables = cables_of(cause)
    if cause.name == "cell_swapped":
        cables = list(PAIRS[round(cause.shapes.get("pair", 0.0))])
    return {
        "effect": cause.name,
        "probability": cause.probability,
        "present": cause.present,
        "where": {
            "side": sides[cause.name],
            "cables": cables,
            "or_cables": other_cables(cause),
            "when": WHEN.get(cause.name, "throughout the motion"),
            "harmonics": [],
        },
        "parameters": parameters_of(
            cause, next(one for one in machine.candidates if one.name == cause.name)
        ),
        "indistinguishable_from": [one.name for one in cause.rivals],
        "rivals": [{"effect": one.name, "probability": one.probability} for one in cause.rivals],
        "implausible": list(cause.at_limit),
    }


def parameters_of(cause: Cause, candidate: Candidate) -> dict[str, Any]:
    """What each of its parameters is: in each cable, and the mean over the cables it acts on."""
    named = {str(cable) for cable in cables_of(cause)}
    found: dict[str, Any] = {}
    for term in candidate.terms:
        if term.name not in cause.values:
            continue
        value, sigma = cause.values[term.name], cause.sigmas.get(term.name, 0.0)
        entry = found.setdefault(term.parameter, {"all": [], "named": [], "unit": term.unit})
        entry["all"].append((value, sigma))
        if term.place:
            entry.setdefault("cables", {})[term.place] = value
            entry.setdefault("sigma_cables", {})[term.place] = sigma
        if term.place in named:
            entry["named"].append((value, sigma))
    for entry in found.values():
        everywhere, there = entry.pop("all"), entry.pop("named")
        values, sigmas = zip(*(there or everywhere), strict=True)
        entry["value"] = sum(values) / len(values)
        entry["sigma"] = sum(sigmas) / len(sigmas)
        if cause.name == "drive_harmonic":
            entry["value"] = hypot(*values)
    for name, value in cause.shapes.items():
        shape = next((one for one in candidate.shapes if one.name == name), None)
        if shape is None:
            continue
        if shape.term:
            _begun(found, cause, shape)
            continue
        if cause.name == "frames_dropped" and shape.name.startswith("again_") and not value:
            continue
        sigma = cause.shape_sigmas.get(name, 0.0)
        found[name] = {
            "value": value,
            "sigma": sigma * value if shape.logarithmic else sigma,
            "unit": shape.unit,
        }
    if cause.name == "frames_dropped":
        further = sum(one.startswith("again_") for one in found)
        found["frames"]["value"] = round(found["count"]["value"]) + further
    return found


def _begun(found: dict[str, Any], cause: Cause, shape: Shape) -> None:
    """Add what one cable began the one run with; that of several runs is no number of the rig's."""
    name, _, place = shape.name.partition("@")
    if not place.isdecimal() or shape.term not in cause.values:
        return
    entry = found.setdefault(name, {"unit": shape.unit, "cables": {}, "sigma_cables": {}})
    entry["cables"][place] = cause.shapes[shape.name]
    entry["sigma_cables"][place] = cause.shape_sigmas.get(shape.name, 0.0)
    for key, each in (("value", "cables"), ("sigma", "sigma_cables")):
        entry[key] = sum(entry[each].values()) / len(entry[each])


def _fit(machine: RecordedMachine, proof: Confirmation | None) -> dict[str, Any]:
    noise: dict[str, Any] = {}
    for bundle in machine.bundles:
        for i, (name, unit) in enumerate(zip(bundle.names, bundle.units, strict=True)):
            sigma = float(bundle.covariance[i, i]) ** 0.5
            angle = unit == "rad"
            noise.setdefault(bundle.record, {})[name] = {
                "sigma": degrees(sigma) if angle else sigma, "unit": "deg" if angle else unit,
            }  # fmt: skip
    if proof is None:
        return {"noise": noise, "before": {}, "after": {}}
    return {
        "noise": noise,
        "before": {part: dict(kinds) for part, kinds in proof.before.items()},
        "after": {part: dict(kinds) for part, kinds in proof.after.items()},
        "unit": "rms of the residual over the noise of a sample",
        "held_record": proof.held_record,
    }


def _finding(one: Finding) -> dict[str, Any]:
    return {
        "run": one.record,
        "channel": one.channel,
        "segment": one.segment,
        "line": one.line,
        "slow": one.slow,
        "in_phase": one.in_phase,
        "quadrature": one.quadrature,
        "unit": one.unit,
        "sigmas": one.sigmas,
        "significance": one.significance,
    }


def where(findings: tuple[Finding, ...]) -> str | None:
    """The strongest places in words."""
    if not findings:
        return None
    seen = dict.fromkeys(
        f"{one.channel}, {one.segment}, line {one.line:.3g}" for one in findings[:4]
    )
    return "; ".join(seen)


def moved_parameters(machine: RecordedMachine, diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """The parameters that moved, the farthest first: what was nominal, and by how many sigmas."""
    if diagnosis.judgement is None or diagnosis.search is None:
        at = diagnosis.calibrated.at
    else:
        chosen = diagnosis.judgement.chosen
        at = diagnosis.calibrated.rotation @ chosen.weighed.nuisance
    found: list[dict[str, Any]] = []
    for nuisance, sigmas in zip(machine.nuisances, at, strict=True):
        if abs(sigmas) > 0.5:
            found.append(
                {
                    "parameter": nuisance.name,
                    "moved": float(sigmas * nuisance.sigma),
                    "unit": nuisance.unit,
                    "sigmas": float(sigmas),
                }
            )
    return sorted(found, key=lambda one: -abs(one["sigmas"]))[:12]
