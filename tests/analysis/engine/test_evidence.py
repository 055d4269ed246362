"""The evidence against brute force: dense Gaussians and a general bounded solver."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from scipy.stats import multivariate_normal

from analysis.engine.bundle import Bundle, Segment
from analysis.engine.evidence import Frame, Problem, _inverse, directions, weigh
from analysis.engine.lens import Lens
from analysis.engine.solve import bounded
from analysis.engine.variance import form_variance


@pytest.fixture
def problem() -> Problem:
    generator = np.random.default_rng(3)
    t_s = np.arange(0.0, 5.0, 0.05)
    made = Bundle(
        ("a",), ("N",), t_s, np.zeros((len(t_s), 1)), np.eye(1), (Segment(0.0, 5.0, 1.0),)
    )
    lens = Lens([made])
    return Problem(
        residual=generator.standard_normal(lens.size) * 3.0,
        nuisance=generator.standard_normal((lens.size, 4)),
        at=np.zeros(4),
        base=generator.uniform(0.5, 2.0, lens.size),
        labels=lens.labels,
        used=np.ones(lens.size, dtype=bool),
    )


def test_nuisances_are_marginalised_as_a_dense_gaussian_does_it(problem: Problem) -> None:
    frame = Frame(problem, problem.base)
    dense = np.diag(problem.base) + problem.nuisance @ problem.nuisance.T
    expected = multivariate_normal(cov=dense).logpdf(problem.residual)
    size = len(problem.residual)
    found = -0.5 * (frame.chi2 + frame.log_determinant + size * np.log(2 * np.pi))
    assert found == pytest.approx(expected, rel=1e-10)


def test_normal_equations_are_those_of_generalised_least_squares(problem: Problem) -> None:
    columns = np.random.default_rng(5).standard_normal((len(problem.residual), 3))
    dense = np.linalg.inv(np.diag(problem.base) + problem.nuisance @ problem.nuisance.T)
    matrix, right = Frame(problem, problem.base).normal(columns)
    assert matrix == pytest.approx(columns.T @ dense @ columns, rel=1e-9)
    assert right == pytest.approx(columns.T @ dense @ problem.residual, rel=1e-9)


def test_where_the_simulation_stood_does_not_change_the_evidence(problem: Problem) -> None:
    from dataclasses import replace

    at = np.array([0.5, -1.0, 0.2, 0.0])
    moved = replace(problem, residual=problem.residual - problem.nuisance @ at, at=at)
    first, second = Frame(problem, problem.base), Frame(moved, problem.base)
    assert first.chi2 == pytest.approx(second.chi2, rel=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_bounded_minimum_is_that_of_a_general_solver(seed: int) -> None:
    generator = np.random.default_rng(seed)
    rows, right = generator.standard_normal((30, 5)), generator.standard_normal(30) * 3
    low, high = np.zeros(5), np.full(5, 0.3)
    expected = lsq_linear(rows, right, (low, high), tol=1e-12).x
    found = bounded(rows.T @ rows, rows.T @ right, low, high)
    worse = np.sum((rows @ found - right) ** 2) - np.sum((rows @ expected - right) ** 2)
    assert np.all((found >= low) & (found <= high))
    assert worse < 0.02 * np.sum((rows @ expected - right) ** 2)


def test_bounded_minimum_does_not_know_units() -> None:
    generator = np.random.default_rng(1)
    rows, right = generator.standard_normal((30, 3)), generator.standard_normal(30)
    unit = np.array([1.0, 1e-7, 1e6])
    plain = bounded(rows.T @ rows, rows.T @ right, None, None)
    other = bounded((rows * unit).T @ (rows * unit), (rows * unit).T @ right, None, None)
    assert other * unit == pytest.approx(plain, rel=1e-6)


def test_directions_that_nothing_shows_are_left_out(problem: Problem) -> None:
    doubled = np.hstack([problem.nuisance, problem.nuisance[:, :1], 1e-6 * problem.nuisance])
    kept = directions(doubled, problem.base, problem.used)
    assert kept.shape == (9, 4)
    assert kept.T @ kept == pytest.approx(np.eye(4), abs=1e-9)


def test_a_law_is_less_certain_at_high_harmonics_and_never_more_wrong_than_by_all_it_does(
    problem: Problem,
) -> None:
    done = np.ones(len(problem.residual))
    spread = np.sqrt(form_variance(problem.labels, done, 0.1, 1.0))
    by_line = [
        spread[(problem.labels.line == n) & (problem.labels.order == 0)].mean()
        for n in range(1, 11)
    ]
    assert np.all(np.diff(by_line[:5]) > 0)
    assert by_line[-1] < 2.5 * np.sqrt(2)


def test_an_exact_law_stands_before_parameters_that_imitate_it_far_out(problem: Problem) -> None:
    generator = np.random.default_rng(8)
    size = len(problem.residual)
    law = 300.0 * generator.standard_normal(size)
    # One parameter imitates all but a hundredth of the law, at 10 sigmas.
    imitation = 0.1 * (law + 0.01 * 300.0 * generator.standard_normal(size))[:, None]
    noise = generator.standard_normal(size)
    before = Problem(
        law + noise, imitation, np.zeros(1), np.ones(size), problem.labels, problem.used
    )
    nothing = weigh(before, {}, {}, {})
    after = Problem(noise, imitation, np.zeros(1), np.ones(size), problem.labels, problem.used)
    named = weigh(
        after, {"law": law[:, None]}, {"law": law}, {"law": 0.05}, rounds=1, standing=True
    )
    assert named.log_evidence > nothing.log_evidence + 10.0


def test_a_number_is_as_sure_in_whatever_units_it_and_its_neighbours_are() -> None:
    generator = np.random.default_rng(4)
    columns, units = generator.normal(size=(40, 2)), np.array([1e-9, 1e4])
    matrix = columns.T @ columns
    scaled = _inverse(matrix * np.outer(units, units))
    assert scaled * np.outer(units, units) == pytest.approx(_inverse(matrix))
    assert _inverse(matrix) == pytest.approx(np.linalg.inv(matrix))
