"""What cannot be is said before anything is made of it: what, where, what is right, what to do."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from analysis.engine import Bundle, Candidate, Nuisance, Point, Segment, Shape, Term, diagnose
from analysis.engine.array import Array
from analysis.engine.check import check
from analysis.engine.system import Prediction
from cdpr8.errors import DataError

T_S = np.arange(0.0, 20.0, 0.1)
NOISE = 0.01
DRAWN = np.random.default_rng(2)


class Line:
    """A line with an offset, of which a bend or a ripple may be left out."""

    name = "line"
    nuisances: tuple[Nuisance, ...] = (
        Nuisance("offset", 0.3, "V"),
        Nuisance("slope", 0.05, "V/s", cause="bend", term="bend"),
    )
    candidates: tuple[Candidate, ...] = (
        Candidate("bend", "a bend", "plant", (Term("bend", "bend", "V/s^2", "", -0.1, 0.1, 0.01),)),
        Candidate("ripple", "a ripple", "cell", (Term("ripple", "ripple", "V", "", 0.0, 1.0, 0.1),),
                  (Shape("period_s", "s", 5.0, 1.0, 10.0, grid=(2.0, 5.0)),)),
    )  # fmt: skip

    def __init__(self) -> None:
        value = np.random.default_rng(0).normal(0.0, NOISE, (len(T_S), 1)) + T_S[:, None]
        stretch = Segment(0.0, 20.0, name="all")
        self.bundles: Sequence[Bundle] = (
            Bundle(("x",), ("V",), T_S, value, np.array([[NOISE**2]]), (stretch,)),
        )

    def predict(self, point: Point) -> Prediction:
        at = {
            one.name: one.sigma * x for one, x in zip(self.nuisances, point.nuisance, strict=True)
        }
        y = T_S * (1.0 + at.get("slope", 0.0)) + at.get("offset", 0.0)
        if "bend" in point.effects:
            y = y + point.effects["bend"].values["bend"] * T_S**2
        if "ripple" in point.effects:
            on = point.effects["ripple"]
            y = y + on.values["ripple"] * np.sin(2.0 * np.pi * T_S / on.shapes["period_s"])
        return [y[:, None]]

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        return [reduce(self.predict(point)) for point in points]


def bundle(**change: Any) -> Line:
    system = Line()
    system.bundles = (replace(system.bundles[0], **change),)
    return system


def segment(**change: Any) -> Line:
    return bundle(segments=(replace(Line().bundles[0].segments[0], **change),))


def nuisance(**change: Any) -> Line:
    system = Line()
    system.nuisances = (system.nuisances[0], replace(system.nuisances[1], **change))
    return system


def candidate(**change: Any) -> Line:
    system = Line()
    system.candidates = (replace(system.candidates[0], **change), system.candidates[1])
    return system


def term(**change: Any) -> Line:
    return candidate(terms=(replace(Line.candidates[0].terms[0], **change),))


def shape(**change: Any) -> Line:
    system = Line()
    ripple = system.candidates[1]
    system.candidates = (
        system.candidates[0],
        replace(ripple, shapes=(replace(ripple.shapes[0], **change),)),
    )
    return system


def put(values: Array, place: int, value: float) -> Array:
    changed = values.copy()
    changed[place] = value
    return changed


def simulated(predict: Callable[[Line, Point], Any]) -> Line:
    class Other(Line):
        def predict(self, point: Point) -> Prediction:
            found: Prediction = predict(Line(), point)
            return found

    return Other()


def lists(simulate: Callable[[Sequence[Point], Any], Any]) -> Line:
    class Other(Line):
        def simulate(self, points: Sequence[Point], reduce: Any) -> list[Any]:
            found: list[Any] = simulate(points, reduce)
            return found

    return Other()


def other(**change: Any) -> Line:
    system = Line()
    for name, value in change.items():
        setattr(system, name, value)
    return system


def raises(_line: Line, _point: Point) -> Prediction:
    raise ValueError("the tank is empty")


def fails_with_ripple(line: Line, point: Point) -> Prediction:
    if "ripple" in point.effects:
        raise ZeroDivisionError("no period")
    return line.predict(point)


VALUE = Line().bundles[0].value
BEND, RIPPLE = Line.candidates
OFFSET, SLOPE = Line.nuisances

WRONG: dict[str, tuple[Callable[[], Any], str, str]] = {
    "nothing": (object, "has no name, bundles", ""),
    "no bundles": (lambda: other(bundles=()), "no bundles", "bundles"),
    "no segment": (lambda: bundle(segments=()), "no segment that may be seen", ""),
    "outside": (lambda: segment(start_s=50.0, end_s=60.0), "no segment that may be seen", ""),
    "sealed": (lambda: segment(sealed=True), "no segment that may be seen", ""),
    "backwards": (lambda: segment(start_s=9.0, end_s=1.0), "from 9 to 1 s", "segment 'all'"),
    "no rate": (lambda: segment(fundamental_hz=0.0), "fundamental_hz is 0", "segment 'all'"),
    "too fast": (lambda: segment(fundamental_hz=7.0), "fundamental_hz is 7", "below half"),
    "no line": (lambda: segment(highest_hz=-1.0), "highest_hz is -1", "segment 'all'"),
    "NaN value": (lambda: bundle(value=put(VALUE, 7, np.nan)), "first at 0.7 s", "bundle 0 (x)"),
    "infinite": (lambda: bundle(value=put(VALUE, 7, np.inf)), "not finite", "bundle 0"),
    "NaN time": (lambda: bundle(t_s=put(T_S, 3, np.nan)), "t_s[3] is nan", "bundle 0"),
    "back in time": (lambda: bundle(t_s=put(T_S, 3, 0.1)), "t_s[3] is 0.1 after 0.2", "bundle 0"),
    "uneven": (lambda: bundle(t_s=T_S + 0.5 * (T_S > 9.95)), "0.6 s at 9.9 s", "highest_hz"),
    "rows": (lambda: bundle(value=VALUE[:-1]), "199 rows of value for 200", "bundle 0"),
    "flat value": (lambda: bundle(value=VALUE[:, 0]), "value (200,)", "value[:, None]"),
    "names": (lambda: bundle(names="x"), "names is 'x'", '("x",)'),
    "units": (lambda: bundle(units=("V", "V")), "units is", "a tuple of 1"),
    "looked at twice": (lambda: bundle(segments=(Segment(0.0, 9.05, name="first"),
                                                 Segment(8.0, 20.0, name="last"))),
                        "11 samples lie in two segments ('first', 'last')", "at 8 s"),
    "all held out": (lambda: segment(held_out=True), "every segment is held out", "fit"),
    "scalar noise": (lambda: bundle(covariance=np.array(1.0)), "has shape ()", "(1, 1)"),
    "no noise": (lambda: bundle(covariance=np.zeros((1, 1))), "not positive definite", "bundle 0"),
    "negative noise": (lambda: bundle(covariance=-np.eye(1)), "not positive definite", "bundle 0"),
    "NaN noise": (lambda: bundle(covariance=np.full((1, 1), np.nan)), "nan", "symmetric"),
    "own error": (lambda: bundle(base_share=-0.1), "base_share is -0.1", "0 to 1"),
    "per cent": (lambda: bundle(base_share=5.0), "base_share is 5.0", "0 to 1"),
    "a list": (lambda: bundle(value=VALUE.tolist()), "value is a list", "bundle 0 (x)"),
    "one bundle": (lambda: other(bundles=Line().bundles[0]), "a Bundle", "bundles"),
    "one segment": (lambda: bundle(segments=Segment(0.0, 9.0)), "a Segment", "segments"),
    "one tone": (lambda: bundle(tones_hz=1.0), "a float", "tones_hz"),
    "no tone": (lambda: bundle(tones_hz=(-1.0,)), "tones_hz is -1.0", "above 0"),
    "one candidate": (lambda: other(candidates=BEND), "a Candidate", "candidates"),
    "one term": (lambda: candidate(terms=BEND.terms[0]), "a Term", "candidate 'bend', terms"),
    "no bundle": (lambda: other(bundles=(1,)), "a int in place 0", "Bundle"),
    "sigma 0": (lambda: nuisance(sigma=0.0), "sigma is 0", "nuisance 'slope'"),
    "sigma NaN": (lambda: nuisance(sigma=np.nan), "sigma is nan", "nuisance 'slope'"),
    "step 0": (lambda: nuisance(step=0.0), "step is 0", "nuisance 'slope'"),
    "twice": (lambda: other(nuisances=(OFFSET, OFFSET)), "called 'offset'", "nuisances"),
    "record": (lambda: nuisance(record="b"), "record 'b'", "nuisance 'slope'"),
    "its cause": (lambda: nuisance(cause="x"), "cause 'x'", "'bend', 'ripple'"),
    "its term": (lambda: nuisance(term="x"), "term 'x'", "'bend'"),
    "causes twice": (lambda: other(candidates=(BEND, BEND)), "called 'bend'", "candidates"),
    "no terms": (lambda: other(candidates=(replace(RIPPLE, terms=()),)), "no terms", "'ripple'"),
    "terms twice": (lambda: candidate(terms=2 * BEND.terms), "one term is called", "'bend'"),
    "form": (lambda: candidate(form_share=-1.0), "form_share is -1", "candidate 'bend'"),
    "form per cent": (lambda: candidate(form_share=5.0), "form_share is 5", "0 to 1"),
    "odds": (lambda: candidate(prior=0.0), "prior is 0", "candidate 'bend'"),
    "combination": (lambda: candidate(combinations=(("y",),)), "name 'y'", "'bend'"),
    "range": (lambda: term(low=1.0, high=0.0), "low 1, high 0", "term 'bend'"),
    "endless": (lambda: term(high=np.inf), "high inf", "term 'bend'"),
    "no step": (lambda: term(step=0.0), "step 0", "term 'bend'"),
    "far step": (lambda: term(step=9.0), "step 9", "within -0.1 to 0.1"),
    "least": (lambda: term(least=0.05), "least 0.05", "beyond -0.1"),
    "grid": (lambda: shape(grid=(0.5,)), "0.5 as default or in the grid", "shape 'period_s'"),
    "default": (lambda: shape(default=99.0), "99 as default", "1 to 10"),
    "logarithm": (lambda: shape(low=0.0), "low 0 of a logarithmic", "logarithmic=False"),
    "raises": (lambda: simulated(raises), "ValueError: the tank is empty", "the nominal point"),
    "raises on": (lambda: simulated(fails_with_ripple), "ZeroDivisionError", "'ripple'"),
    "one array": (lambda: simulated(lambda a, p: a.predict(p)[0]), "ndarray", "one for each"),
    "two arrays": (lambda: simulated(lambda a, p: 2 * a.predict(p)), "gives 2 arrays", "of 1"),
    "flat": (lambda: simulated(lambda a, p: [a.predict(p)[0][:, 0]]), "shape (200,)", "(200, 1)"),
    "short": (lambda: simulated(lambda a, p: [a.predict(p)[0][:-1]]), "(199, 1)", "(200, 1)"),
    "NaN": (lambda: simulated(lambda a, p: [a.predict(p)[0] * np.nan]), "200 of 200", "nominal"),
    "NaN on": (lambda: simulated(
        lambda a, p: [a.predict(p)[0] * (np.nan if "bend" in p.effects else 1.0)]
    ), "'bend' at its step is not finite", "smaller"),
    "drawn": (lambda: simulated(
        lambda a, p: [a.predict(p)[0] + DRAWN.normal()]
    ), "again", "random"),
    "deaf": (lambda: simulated(lambda a, _: a.predict(Point(np.zeros(2)))), "neither a", "effects"),
    "no parameter": (lambda: simulated(
        lambda a, p: a.predict(replace(p, nuisance=np.zeros(2)))
    ), "no nuisance changes", "in sigmas"),
    "complex": (lambda: simulated(lambda a, p: [a.predict(p)[0] + 0j]), "complex", "channels"),
    "unreduced": (lambda: lists(lambda p, _: [Line().predict(a) for a in p]), "reduce", "simul"),
    "nothing back": (lambda: lists(lambda _, reduce: None), "NoneType", "for 1 points"),
    "too few": (lambda: lists(lambda p, reduce: [reduce(Line().predict(p[0]))]), "1 results", "4"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_be_is_said(name: str) -> None:
    make, what, where = WRONG[name]
    with pytest.raises(DataError) as error:
        diagnose(make())
    said = str(error.value)
    assert what in said
    assert where in said


def test_a_simulation_that_ends_early_later_on_is_said() -> None:
    count = 0

    def shorter(line: Line, point: Point) -> Prediction:
        nonlocal count
        count += 1
        return [one[: -1 if count > 40 else None] for one in line.predict(point)]

    with pytest.raises(DataError, match=r"bundle 0 has shape \(199, 1\)"):
        diagnose(simulated(shorter))


def test_what_is_right_passes() -> None:
    assert check(Line()) == ()


def test_what_is_not_looked_at_may_be_anything() -> None:
    system = bundle(value=put(VALUE, 199, np.nan))
    system.bundles = (replace(system.bundles[0], segments=(Segment(0.0, 19.0),)),)
    assert check(system) == ()


def test_a_candidate_that_does_nothing_by_itself_is_told_of() -> None:
    system = Line()
    idle = replace(BEND, name="idle", terms=(replace(BEND.terms[0], name="idle"),))
    system.candidates = (*system.candidates, idle)
    (note,) = diagnose(system, stop_after="align").notes
    assert "'idle'" in note
    assert "changes nothing" in note
