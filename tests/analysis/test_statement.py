"""What the statement says of where a cause acts."""

from dataclasses import replace

import pytest

from analysis.diagnosis.statement import cables_of, not_ruled_out, other_cables, parameters_of
from analysis.engine.candidate import Candidate, Shape, Term
from analysis.engine.cause import Cause


def cause(values: dict[str, float], sigma: float) -> Cause:
    return Cause("pulley_presliding", 1.0, 1.0, (), values, dict.fromkeys(values, sigma),
                 values, {}, {}, ())  # fmt: skip


@pytest.mark.parametrize(
    ("values", "sigma", "cables"),
    [
        ({"coulomb_n@2": 0.3, "coulomb_n@7": 0.2, "coulomb_n@1": 0.01}, 0.02, [2, 7]),
        ({"coulomb_n@2": 0.018}, 0.023, [2]),
        ({"coulomb_n@2": 0.018, "coulomb_n@3": 0.017, "coulomb_n@4": 0.0}, 0.023, [2, 3]),
        ({"coulomb_n@2": 0.05, "coulomb_n@3": 0.035, "coulomb_n@4": 0.026}, 0.024, [2, 3, 4]),
        ({"coulomb_n@2": 0.3, "coulomb_n@3": 0.035}, 0.024, [2]),
        ({"drag_area_m2": 0.3}, 0.1, []),
    ],
    ids=[
        "some stand out",
        "one, its size open",
        "two, their sizes open",
        "one stands out, and what is about as strong",
        "one stands out, and what is far weaker",
        "no choice",
    ],
)
def test_cables_are_those_that_stand_out_or_all_where_sizes_are_open(
    values: dict[str, float], sigma: float, cables: list[int]
) -> None:
    assert cables_of(cause(values, sigma)) == cables


def test_cables_where_it_might_as_well_be_are_told_once_each() -> None:
    upper = {f"coulomb_n@{k}": 0.2 for k in (1, 2, 3, 4)}
    every = {f"coulomb_n@{k}": 0.15 for k in range(1, 9)}
    one_large = {"coulomb_n@2": 0.5, "coulomb_n@7": 0.01}
    elsewhere = (every, upper, one_large, dict(every), dict.fromkeys(every, 0.0))
    found = replace(cause(upper, 0.02), elsewhere=elsewhere)
    assert other_cables(found) == [[1, 2, 3, 4, 5, 6, 7, 8], [2]]
    assert other_cables(cause(upper, 0.02)) == []


def test_a_size_is_the_mean_over_the_cables_it_acts_on_and_told_for_each_that_was_asked() -> None:
    values = {"coulomb_n@2": 0.3, "coulomb_n@7": 0.2, "coulomb_n@1": 0.01}
    terms = tuple(Term(one, "coulomb_n", "N", one[-1], 0.0, 5.0, 0.1) for one in values)
    candidate = Candidate("pulley_presliding", "presliding", "plant", terms)
    (told,) = parameters_of(cause(values, 0.02), candidate).values()
    assert told["value"] == pytest.approx(0.25)
    assert told["cables"] == {"2": 0.3, "7": 0.2, "1": 0.01}
    (open_size,) = parameters_of(cause(values, 0.4), candidate).values()
    assert open_size["value"] == pytest.approx(0.25)


def test_what_each_cable_began_the_run_with_is_told_for_those_that_are_on() -> None:
    terms = tuple(Term(f"coulomb_n@{k}", "coulomb_n", "N", f"{k}", 0.0, 5.0, 0.1) for k in (2, 7))
    shapes = tuple(
        Shape(f"bent_at_rest@{k}", "1", 0.0, -1.0, 1.0, term=f"coulomb_n@{k}") for k in (2, 7)
    )
    candidate = Candidate("pulley_coulomb", "friction", "plant", terms, shapes)
    on = replace(
        cause({"coulomb_n@2": 0.3}, 0.02),
        shapes={"bent_at_rest@2": -0.4, "bent_at_rest@7": 0.0},
        shape_sigmas={"bent_at_rest@2": 0.1},
    )
    told = parameters_of(on, candidate)
    assert told["bent_at_rest"] == {
        "value": -0.4, "sigma": 0.1, "unit": "1", "cables": {"2": -0.4}, "sigma_cables": {"2": 0.1},
    }  # fmt: skip
    several = replace(candidate, shapes=(replace(shapes[0], name="bent_at_rest@2 in run 1"),))
    in_runs = replace(on, shapes={"bent_at_rest@2 in run 1": -0.4})
    assert set(parameters_of(in_runs, several)) == {"coulomb_n"}


def test_where_nothing_is_named_what_is_likely_all_the_same_is_said() -> None:
    sets = [(), ("mass",), ("mass", "air_drag"), ("cell_lag",)]
    said = not_ruled_out(sets, [0.5, 0.3, 0.13, 0.07])
    assert [one["effect"] for one in said] == ["mass", "air_drag"]
    assert said[0]["probability"] == pytest.approx(0.43)
    assert not_ruled_out([()], [1.0]) == []
