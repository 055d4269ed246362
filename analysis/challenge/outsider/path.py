"""The way of a cable from platform to frame: a straight line."""

from math import sqrt

from analysis.challenge.outsider.compiled import law
from analysis.challenge.outsider.vectors import Vector, dot, minus


@law
def straight(anchor: Vector, base: Vector) -> tuple[float, Vector]:
    """Length, m, and direction from anchor to base, both in O-XYZ."""
    line = minus(base, anchor)
    length = sqrt(dot(line, line))
    return length, (line[0] / length, line[1] / length, line[2] / length)
