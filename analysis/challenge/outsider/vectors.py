"""Vectors of three as tuples: compiled, they live in registers."""

from typing import Any

from numpy.typing import NDArray

from analysis.challenge.outsider.compiled import law

Vector = tuple[float, float, float]


@law
def at(row: NDArray[Any], start: int) -> Vector:
    """Three numbers of an array from a place on."""
    return row[start], row[start + 1], row[start + 2]


@law
def gained(row: NDArray[Any], start: int, gain: Vector) -> None:
    """Add a vector to three numbers of an array."""
    row[start] += gain[0]
    row[start + 1] += gain[1]
    row[start + 2] += gain[2]


@law
def plus(a: Vector, b: Vector) -> Vector:
    """The sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@law
def minus(a: Vector, b: Vector) -> Vector:
    """The difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@law
def times(share: float, a: Vector) -> Vector:
    """A multiple."""
    return share * a[0], share * a[1], share * a[2]


@law
def dot(a: Vector, b: Vector) -> float:
    """The inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@law
def cross(a: Vector, b: Vector) -> Vector:
    """The vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@law
def turned(matrix: NDArray[Any], a: Vector) -> Vector:
    """A matrix of shape (3, 3) times a vector."""
    return (
        matrix[0, 0] * a[0] + matrix[0, 1] * a[1] + matrix[0, 2] * a[2],
        matrix[1, 0] * a[0] + matrix[1, 1] * a[1] + matrix[1, 2] * a[2],
        matrix[2, 0] * a[0] + matrix[2, 1] * a[1] + matrix[2, 2] * a[2],
    )


@law
def turned_back(matrix: NDArray[Any], a: Vector) -> Vector:
    """The transposed matrix times a vector."""
    return (
        matrix[0, 0] * a[0] + matrix[1, 0] * a[1] + matrix[2, 0] * a[2],
        matrix[0, 1] * a[0] + matrix[1, 1] * a[1] + matrix[2, 1] * a[2],
        matrix[0, 2] * a[0] + matrix[1, 2] * a[1] + matrix[2, 2] * a[2],
    )
