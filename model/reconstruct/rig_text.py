"""A reconstructed machine as a rig file: the text of another, with its mechanical numbers replaced.

All that is not mechanical (amplifiers, camera, plate, excitation) stays as it was written.
"""

import re
from collections.abc import Iterable

from cdpr8.errors import RigFileError
from model.reconstruct.layout import Layout

DIGITS = 6
"""Significant digits of what is written; figures to the printed digits need four or so."""

HEAD = """\
# {name}: mechanical numbers found by `model reconstruct`.
#
# An inference, not a measurement: the paper's Table I (mass, inertia, geometry, pretension, cable
# properties) is not in our copy. Published are the stiffnesses, Kevlar of at most 3 mm, the motion
# and the initial disturbances; everything else was fitted to the paper's published outcomes.
# {origin}
#
# Frame O-XYZ at the rest position of the centre of mass: X forward, Y left, Z up; pitch is
# rotation about Y. Cables 1-8 stand in order.
"""


def rig_text(layout: Layout, pattern: str, *, name: str, origin: str) -> str:
    """The text of a rig file.

    Parameters
    ----------
    layout
        The machine; rounded as it is written, pretensions in equilibrium with what is written.
    pattern
        Text of a rig file with eight [[cable]] tables, whose numbers are replaced.
    name
        Of the rig, for the comment on top.
    origin
        One line: how these numbers came about.

    Raises
    ------
    RigFileError
        The pattern does not have one value of each kind for each cable, on lines of their own.
    """
    layout = layout.rounded(DIGITS)
    base, anchor, pretension = layout.base, layout.anchor, layout.pretension
    inertia = ", ".join(f"{value:.{DIGITS}g}" for value in layout.inertia)
    text = pattern
    for key, values in {
        "mass_kg": [f"{layout.mass:.{DIGITS}g}"],
        "inertia_kg_m2": [f"[{inertia}]   # principal, about the centre of mass"],
        "base_m": [_point(point) for point in base],
        "anchor_m": [_point(point) for point in anchor],
        "pretension_n": [f"{value:.6f}" for value in pretension],
        "line_density_kg_per_m": [f"{layout.line_density:.{DIGITS}g}"] * 8,
        "damping_1_per_s": [f"{layout.damping:.{DIGITS}g}"] * 8,
    }.items():
        text = _replaced(text, key, values)
    body = text.splitlines()
    while body and (not body[0].strip() or body[0].startswith("#")):
        body.pop(0)
    return HEAD.format(name=name, origin=origin) + "\n" + "\n".join(body) + "\n"


def _point(point: Iterable[float]) -> str:
    values = [float(value) for value in point]
    return "[" + ", ".join(f"{value:.{DIGITS}g}" for value in values) + "]"


def _replaced(text: str, key: str, values: list[str]) -> str:
    """The text with the values of a key, one a line, replaced in order."""
    line = re.compile(rf"^({key}\s*=).*$", re.MULTILINE)
    found = len(line.findall(text))
    if found != len(values):
        raise RigFileError(
            f"{found} lines give {key}", allowed=f"{len(values)}, each on a line of its own"
        )
    left = iter(values)
    return line.sub(lambda match: f"{match[1]} {next(left)}", text)
