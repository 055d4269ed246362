"""A diagnosis in a few lines, for whoever prints it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from analysis.engine.candidate import Candidate
from analysis.engine.cause import Cause
from analysis.engine.confirm import Confirmation
from analysis.engine.locate import Finding

if TYPE_CHECKING:
    from analysis.engine.diagnosis import Diagnosis

PLACES = 8
"""Magnitudes of one cause that are said; of more, how many more."""


def summary(found: "Diagnosis") -> str:
    """Verdict, causes with their numbers and rivals, what remains, the proof, and the notes.

    Parameters
    ----------
    found
        As `diagnose` returns it, after whichever stage.
    """
    return "\n".join(_lines(found))


def _lines(found: "Diagnosis") -> Iterator[str]:
    known = {one.name: one for one in found.system.candidates}
    yield f"{found.system.name}: {found.verdict or 'nothing asked to be named'}"
    for cause in () if found.judgement is None else found.judgement.causes:
        yield from _named(cause, known[cause.name])
    if found.judgement is not None and found.judgement.doubt > 0.0:
        yield f"  something else altogether: {found.judgement.doubt:.2f}"
    if found.remains is not None:
        beyond = "more than noise" if found.remains.significant else "no more than noise allows"
        yield f"  left, squared, in units of the noise: {found.remains.misfit:.3g}, {beyond}"
    if found.confirmation is not None:
        yield from _proof(found.confirmation)
    findings = found.findings if found.remains is None else found.remains.findings
    if findings and (found.remains is None or found.remains.significant):
        yield f"  differs most in {place_of(findings[0])}"
    yield from (f"  note: {one}" for one in found.notes)


def _named(cause: Cause, candidate: Candidate) -> Iterator[str]:
    units = {one.name: one.unit for one in candidate.terms}
    numbers = [
        f"{term} {value:.4g} +- {cause.sigmas[term]:.2g} {units[term]}"
        for term, value in cause.values.items()
    ]
    more = len(numbers) - PLACES
    for shape in candidate.shapes:
        if shape.name in cause.shapes:
            numbers.append(_shape(cause, shape.name, shape.unit, ratio=shape.logarithmic))
    if more > 0:
        numbers[PLACES : PLACES + more] = [f"{more} more"]
    yield f"  {cause.name}, {cause.probability:.2f}: {', '.join(numbers)}"
    for rival in cause.rivals:
        yield f"    or {rival.name}, {rival.probability:.2f}"
    if cause.at_limit:
        yield f"    at the edge of what is plausible: {', '.join(cause.at_limit)}"


def _shape(cause: Cause, name: str, unit: str, *, ratio: bool) -> str:
    value, sigma = cause.shapes[name], cause.shape_sigmas.get(name, 0.0)
    if not sigma:
        return f"{name} {value:.4g} {unit}"
    off = f"a factor {np.exp(min(sigma, 99.0)):.3g}" if ratio else f"{sigma:.2g}"
    return f"{name} {value:.4g} +- {off} {unit}"


def _proof(proof: Confirmation) -> Iterator[str]:
    for part, kinds in proof.after.items():
        for kind, after in kinds.items():
            before = proof.before[part][kind]
            what = f"{part.replace('_', ' ')}{', ' if kind else ''}{kind}"
            yield f"  rms over noise, {what}: {before:.3g} before, {after:.3g} after"


def place_of(one: Finding) -> str:
    """Where, and by how much."""
    channel = " of ".join(part for part in (one.channel, one.record) if part)
    where = f"{one.start_s:g} to {one.end_s:g} s"
    if np.isfinite(one.line):
        where = f"line {one.line:g}, {where}"
    return f"{channel}, {where}: {one.sigmas:.1f} sigmas"
