"""The whole of it: calibrate, locate, search, judge, confirm."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from analysis.engine.all_samples import noise_of
from analysis.engine.array import Array
from analysis.engine.calibrate import Calibrated
from analysis.engine.check import check
from analysis.engine.confirm import Confirmation, confirm
from analysis.engine.doubt import FORMS_OFF, missed
from analysis.engine.finder import Tell
from analysis.engine.implausible import Implausible, implausible
from analysis.engine.judge import Judgement, judge
from analysis.engine.leftover import leftover
from analysis.engine.locate import Finding, locate
from analysis.engine.look import look
from analysis.engine.moved import EVEN
from analysis.engine.part import records_of, rings
from analysis.engine.reach import Unreached, unreached
from analysis.engine.restated import restatements
from analysis.engine.search import REMAINS_ALONE, Search, search
from analysis.engine.summary import place_of, summary
from analysis.engine.system import Nuisance, System
from analysis.engine.until import until_of
from cdpr8.errors import UsageError

Stage = Literal["align", "locate", "name", "confirm"]

POORLY = 2.0
"""A hypothesis whose misfit is more than this for each feature leaves something unexplained."""


REMAINS = 0.2
"""Where it was led to the ring's phase: what is so much more than noise for each sample. Laws are
never quite exact."""

MOVED = (
    "nuisance {name!r} fits {sigmas:+.1f} sigmas from what is known of it: a number that is off "
    "is named where it is a candidate's, which `Nuisance.cause` and `term` say"
)

BESIDE = (
    "nuisance {name!r} fits {sigmas:+.1f} sigmas from what is known of it beside what is named: "
    "{cause} may be there as well, and these data do not make it sure"
)

ALONE = (
    "nuisance {name!r} fits {sigmas:+.1f} sigmas from what is known of it: {cause} may be there, "
    "and these data do not make it sure"
)

LEAST_CHANCE = 1e-6
"""Where nothing is named, what noise makes anywhere with a smaller chance than this is said."""

DIFFERS = (
    "{place}: noise makes that with a chance of {chance:.0e}, and nothing in the list explains it"
)

FORETOLD, EVEN_ODDS = 1.05, 0.5
"""Held-out data that are off by so much more, as an amplitude, with what is named than without it
are against it: it is as likely something else. Of 73 blind cases of CDPR-8 two were, both wrong,
and none that was right by more than 1.02."""

WORSE = (
    "on data that the fit did not use, {kind} is off by {after:.3g} of its noise with what is "
    "named, and by {before:.3g} without: it may well be something else"
)


@dataclass(frozen=True)
class Remains:
    """What the chosen hypothesis leaves.

    Attributes
    ----------
    misfit
        Squared residual over its variance, a feature; of a sample, where the ring was followed.
    significant
        Whether that is more than noise and the error of form allow.
    findings
        Where.
    """

    misfit: float
    significant: bool
    findings: tuple[Finding, ...]


@dataclass(frozen=True)
class Diagnosis:
    """What was found out about a system; stages that were not asked for are None.

    Attributes
    ----------
    system
        What was diagnosed; an `Until`, where nothing foretells what came after some time, a
        `Sharper`, where the recording told how well parameters are known, and a `Louder`, where it
        told what its noise is.
    calibrated
        The system at its likeliest parameters, nothing left out.
    findings
        Where recording and simulation differ there, the strongest first.
    search
        Everything that was weighed.
    judgement
        The verdict.
    remains
        What the chosen hypothesis leaves.
    confirmation
        Fit before and after, on used and on held-out data.
    implausible
        Better fits that are not believed, the best first.
    notes
        What else is to be known, such as candidates that do nothing by themselves.
    """

    system: System
    calibrated: Calibrated
    findings: tuple[Finding, ...]
    search: Search | None
    judgement: Judgement | None
    remains: Remains | None
    confirmation: Confirmation | None
    implausible: tuple[Implausible, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """The word "none", "parameter", "explained", "ambiguous" or "unexplained"."""
        return "" if self.judgement is None else self.judgement.verdict

    def __str__(self) -> str:
        return summary(self)


def diagnose(
    system: System,
    *,
    stop_after: Stage | None = None,
    tell: Tell | None = None,
    anew: bool = False,
    most_causes: int = 3,
) -> Diagnosis:
    """Find out what a simulation leaves out.

    Parameters
    ----------
    system
        What was recorded, how it is simulated, and what may have been left out.
    stop_after
        "align": parameters only; "locate": where it differs; "name": no proof on held-out data.
    tell
        Told of progress.
    anew, most_causes
        As `search` has them.

    Raises
    ------
    DataError
        Something that the system states, or that it simulates, cannot be.
    UsageError
        There is no such stage.
    """
    if stop_after not in (None, *get_args(Stage)):
        raise UsageError(
            f"stop_after is {stop_after!r}", allowed=", ".join(get_args(Stage)),
            remedy="None: to the end",
        )  # fmt: skip
    notes = check(system)
    if stop_after in ("align", "locate"):
        seen = look(system, tell)
        found = locate(system.bundles, seen.calibrated.problem, seen.calibrated.problem.residual)
        return Diagnosis(system, seen.calibrated, found, None, None, None, None, notes=notes)
    beyond = () if rings(system) else unreached(system)
    searched = search(system, tell, anew=anew, most_causes=most_causes)
    system, problem = searched.system, searched.calibrated.problem
    notes = (*notes, *(one.note for one in restatements(system)))
    findings = locate(system.bundles, problem, searched.null.problem.residual)
    candidates = {one.name: one for one in system.candidates}
    noise = noise_of(system)
    aside = len(searched.aside) / len(records_of(system))
    judgement = judge(
        searched.fitted, candidates, lost=searched.lost, noise=noise, aside=aside,
        settled=not rings(system), moved=searched.moved, beside=searched.beside,
    )  # fmt: skip
    far = [] if rings(system) else _moved_far(system, judgement)
    for one, sigmas in far:
        words = MOVED if one.cause is None else BESIDE if judgement.causes else ALONE
        notes = (*notes, words.format(name=one.name, sigmas=sigmas, cause=one.cause))
    notes = (*notes, *(one.note for one in beyond))
    if (judgement.causes and far) or _may_be(beyond, judgement):
        judgement = _unsure(judgement)
    remains = _remains(searched, judgement, noise)
    cut = until_of(system)
    left_out = remains.significant or (cut is not None and cut.tells)
    if left_out and judgement.verdict == "none":
        judgement = replace(judgement, verdict="unexplained")
    if judgement.verdict == "none" and not rings(system):
        notes = (*notes, *_differs(remains.findings))
    chosen = judgement.chosen.point
    notes = (*notes, *leftover(system, chosen, explained=not remains.significant))
    proof = None if stop_after == "name" else confirm(searched, judgement.chosen)
    numbers = len(judgement.chosen.state.free) + (len(system.nuisances) if rings(system) else 0)
    for kind, before, after in () if proof is None else _worse(proof, numbers):
        notes = (*notes, WORSE.format(kind=kind or "it", before=before, after=after))
        judgement = _unsure(judgement, even=True)
    flagged = implausible(searched, judgement.chosen)
    return Diagnosis(
        system, searched.calibrated, findings, searched, judgement, remains, proof, flagged, notes
    )


def _unsure(judgement: Judgement, *, even: bool = False) -> Judgement:
    """What is named is not sure; or as likely something else."""
    causes = judgement.causes
    if even:
        causes = tuple(replace(one, probability=min(one.probability, EVEN_ODDS)) for one in causes)
    sure = judgement.verdict in ("explained", "parameter")
    return replace(judgement, verdict="ambiguous" if sure else judgement.verdict, causes=causes)


def _may_be(beyond: Sequence[Unreached], judgement: Judgement) -> bool:
    """Whether something that cannot be simulated as it usually is may be there instead."""
    named = {name for one in judgement.causes for name in one.names}
    return bool(named) and any(one.usual and one.candidate not in {"", *named} for one in beyond)


def _worse(proof: Confirmation, numbers: int) -> Iterator[tuple[str, float, float]]:
    """Kinds of channels that were foretold better with nothing left out: before and after.

    By more than numbers are off that were told by the used part alone, one of variance each: where
    something rings, those of nothing have seen all of the data.
    """
    held = proof.before.get("held_out", {}), proof.after.get("held_out", {})
    for kind in held[0].keys() & held[1].keys():
        before, after = (one[kind] for one in held)
        more = proof.held_values[kind] * (after**2 - before**2) / max(before, 1.0) ** 2
        if after > FORETOLD * before and more > numbers:
            yield kind, before, after


def _differs(findings: Sequence[Finding]) -> Iterator[str]:
    """Where more than noise is left, though it is no more than noise on average."""
    for one in findings[:1]:
        if one.significance < LEAST_CHANCE:
            yield DIFFERS.format(place=place_of(one), chance=one.significance)


def _moved_far(system: System, judgement: Judgement) -> list[tuple[Nuisance, float]]:
    """Parameters that moved too far, and by how many sigmas: of no cause that is named."""
    named = {one.name for one in judgement.causes}
    at = judgement.chosen.point.nuisance
    return [
        (one, float(sigmas))
        for one, sigmas in zip(system.nuisances, at, strict=True)
        if abs(sigmas) > EVEN and one.cause not in named
    ]


def _remains(searched: Search, judgement: Judgement, noise: float) -> Remains:
    chosen = judgement.chosen
    problem = chosen.problem
    # What does not ring was simulated where parameters are likeliest: no straight line is needed.
    residual = chosen.remaining if rings(searched.system) else problem.residual
    scaled = _allowed(residual, chosen.weighed.variance, problem.base)
    found = locate(searched.system.bundles, problem, np.where(problem.used, scaled, 0.0))
    if searched.faint and not np.isnan(chosen.left):
        most = noise + (REMAINS if chosen.hypothesis.parts else REMAINS_ALONE)
        return Remains(chosen.left, chosen.left > most, found)
    if not rings(searched.system):
        known = {one.name: one for one in searched.system.candidates}
        most = noise + (REMAINS if chosen.hypothesis.parts else REMAINS_ALONE)
        poor = missed(chosen, searched.null, known, noise) > 1.0 / FORMS_OFF
        poor = poor or not chosen.hypothesis.parts
        return Remains(chosen.left, chosen.left > most and poor, found)
    misfit = chosen.lines_left
    return Remains(misfit, misfit > POORLY, found)


def _allowed(residual: Array, variance: Array, base: Array) -> Array:
    """The residual, scaled so that the error of form counts as noise."""
    return np.asarray(residual * np.sqrt(base / variance))
