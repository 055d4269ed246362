"""What a system states of its parameters and its candidates: whether it can be."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from analysis.engine.bundle import Bundle, Segment
from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.part import records_of, rings
from analysis.engine.recorded import check_number, listed, name_of
from analysis.engine.system import Nuisance, System
from cdpr8.errors import DataError


def check_lists(system: Any) -> None:
    """Whether what a system states are lists of the engine's own things, and arrays in them.

    Raises
    ------
    DataError
        Something is not what it should be.
    """
    for what, kind in (("bundles", Bundle), ("nuisances", Nuisance), ("candidates", Candidate)):
        _check_list(getattr(system, what), kind, what)
    for i, bundle in enumerate(system.bundles):
        where = name_of(bundle, i)
        _check_list(bundle.segments, Segment, f"{where}, segments")
        _check_list(bundle.tones_hz, (int, float, np.number), f"{where}, tones_hz")
        for what in ("t_s", "value"):
            if not isinstance(getattr(bundle, what), np.ndarray):
                raise DataError(
                    f"{what} is a {type(getattr(bundle, what)).__name__}",
                    allowed="an array of numbers", where=where, remedy="np.asarray(...)",
                )  # fmt: skip
    for one in system.candidates:
        where = f"candidate {one.name!r}"
        _check_list(one.terms, Term, f"{where}, terms")
        _check_list(one.shapes, Shape, f"{where}, shapes")


def _check_list(found: Any, kind: Any, where: str) -> None:
    name = getattr(kind, "__name__", "number")
    if not isinstance(found, list | tuple):
        raise DataError(
            f"a {type(found).__name__}", allowed=f"a tuple of {name}", where=where,
            remedy="of one, (it,) with the comma",
        )  # fmt: skip
    for place, one in enumerate(found):
        if not isinstance(one, kind):
            raise DataError(
                f"a {type(one).__name__} in place {place}", allowed=name, where=where,
                remedy="see docs/engine.md, 'What you write'",
            )  # fmt: skip


def check_nuisances(system: System) -> None:
    """Whether parameters can be free within what is stated.

    Raises
    ------
    DataError
        They cannot.
    """
    _check_unique([one.name for one in system.nuisances], "nuisance")
    records = set(records_of(system))
    known = {one.name: {term.name for term in one.terms} for one in system.candidates}
    for one in system.nuisances:
        where = f"nuisance {one.name!r}"
        check_number("sigma", one.sigma, where, above=0.0)
        check_number("step", one.step, where, above=0.0)
        if one.record and one.record not in records:
            raise DataError(
                f"record {one.record!r}", allowed=listed(records), where=where,
                remedy="the `record` of a bundle, or ''",
            )  # fmt: skip
        # Of a machine that states itself, some of what it knows may be left out of the list.
        if one.cause is not None and one.cause not in known and not rings(system):
            raise DataError(
                f"cause {one.cause!r}", allowed=listed(known), where=where,
                remedy="the name of a candidate, or None",
            )  # fmt: skip
        if one.cause in known and one.term not in known[one.cause]:
            raise DataError(
                f"term {one.term!r}", allowed=listed(known[one.cause]), where=where,
                remedy="the term of its cause that it is",
            )  # fmt: skip


def check_candidates(candidates: Sequence[Candidate]) -> None:
    """Whether candidates can be tried.

    Raises
    ------
    DataError
        They cannot.
    """
    _check_unique([one.name for one in candidates], "candidate")
    for one in candidates:
        where = f"candidate {one.name!r}"
        if not one.terms:
            raise DataError(
                "it has no terms", allowed="at least one", where=where,
                remedy="what is there or not there has one, and is `fixed`",
            )  # fmt: skip
        names = [term.name for term in one.terms]
        _check_unique(names, "term", where)
        _check_unique([shape.name for shape in one.shapes], "shape", where)
        if isinstance(one.akin, str):
            raise DataError(
                f"akin is {one.akin!r}", allowed="a tuple of names", where=where,
                remedy="of one, (it,) with the comma",
            )  # fmt: skip
        check_number("form_share", one.form_share, where, least=0.0, most=1.0)
        check_number("prior", one.prior, where, above=0.0)
        unknown = sorted({term for whole in one.combinations for term in whole} - set(names))
        if unknown:
            raise DataError(
                f"combinations name {listed(unknown)}", allowed=listed(names), where=where,
                remedy="combinations are of its own terms",
            )  # fmt: skip
        for term in one.terms:
            _check_term(term, f"{where}, term {term.name!r}")
        for shape in one.shapes:
            _check_shape(shape, f"{where}, shape {shape.name!r}")
            if shape.term and shape.term not in names:
                raise DataError(
                    f"shape {shape.name!r} belongs to {shape.term!r}", allowed=listed(names),
                    where=where, remedy="one of its own terms, or none",
                )  # fmt: skip


def _check_term(term: Term, where: str) -> None:
    _check_range(term.low, term.high, where)
    if not (term.step and term.low <= term.step <= term.high):
        raise DataError(
            f"step {term.step:g}", allowed=f"not 0, within {term.low:g} to {term.high:g}",
            where=where, remedy="a size at which it would be seen",
        )  # fmt: skip
    for what, end, right in (("least", term.least, term.low), ("most", term.most, term.high)):
        wider = end is None or (end <= right if what == "least" else end >= right)
        if not wider:
            raise DataError(
                f"{what} {end:g}", allowed=f"beyond {right:g}", where=where,
                remedy="how far beyond its plausible range a fit may go, or None",
            )  # fmt: skip


def _check_shape(shape: Shape, where: str) -> None:
    _check_range(shape.low, shape.high, where)
    if shape.logarithmic and not shape.low > 0.0:
        raise DataError(
            f"low {shape.low:g} of a logarithmic shape", allowed="above 0", where=where,
            remedy="logarithmic=False, where equal differences count alike",
        )  # fmt: skip
    for value in (shape.default, *shape.grid):
        if not shape.low <= value <= shape.high:
            raise DataError(
                f"{value:g} as default or in the grid",
                allowed=f"{shape.low:g} to {shape.high:g}", where=where,
                remedy="within its plausible range",
            )  # fmt: skip


def _check_range(low: float, high: float, where: str) -> None:
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise DataError(
            f"low {low:g}, high {high:g}", allowed="finite, low below high", where=where,
            remedy="the range that is plausible",
        )  # fmt: skip


def _check_unique(names: Sequence[str], what: str, where: str = "") -> None:
    twice = sorted({one for one in names if list(names).count(one) > 1})
    if twice:
        raise DataError(
            f"more than one {what} is called {listed(twice)}", allowed="names that differ",
            where=where or f"{what}s", remedy="rename or leave out one",
        )  # fmt: skip
