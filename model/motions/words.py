"""A motion from one line of text."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cdpr8.errors import UsageError
from model.motions.free_decay import FreeDecay
from model.motions.multisine import Multisine
from model.motions.pose import COORDINATES, Pose, along
from model.motions.recorded import Recorded
from model.motions.staircase import Staircase
from model.motions.windowed import Times


def motion_of(words: str, generator: np.random.Generator) -> Any:
    """A motion from one line of text: a kind, and what it takes.

    Parameters
    ----------
    words
        ``sine:pitch=2,frequency=2.06,phase=90``, ``multisine:yaw=1,base=0.5,highest=5``,
        ``steps:x=0.01,rise=0.3,stay=1`` (there and back), ``decay:z=0.01,free=10`` or
        ``csv:FILE,ramp=0.5``. Coordinates in m and deg, times in s, and beside these ``start``,
        ``motion``, ``ramp`` and ``rest``.
    generator
        For random phases.

    Returns
    -------
    Motion
        See `model.motion.Motion`.

    Raises
    ------
    UsageError
        No such kind, or a word it does not take.
    """
    kind, _, rest = words.partition(":")
    if kind not in _TAKES:
        raise UsageError(f"no motion {kind!r}", allowed=", ".join(_TAKES))
    pieces = [piece for piece in rest.split(",") if piece]
    file = pieces.pop(0) if kind == "csv" and pieces else ""
    allowed = (*_TAKES[kind], *(() if kind == "csv" else COORDINATES))
    given: dict[str, float] = {}
    for piece in pieces:
        key, _, value = piece.partition("=")
        try:
            given[key] = float(value)
        except ValueError:
            key = ""
        if key not in allowed:
            raise UsageError(
                f"{piece!r} in the motion {words!r} is refused",
                allowed=f"NAME=NUMBER, the names {', '.join(allowed)}",
            )
    pose = np.sum([along(name, given.pop(name, 0.0)) for name in COORDINATES], axis=0)
    direction: Any = tuple(float(value) for value in pose)
    if kind != "csv" and not any(direction):
        raise UsageError(
            f"the motion {words!r} goes nowhere",
            allowed=f"at least one of {', '.join(COORDINATES)}",
        )
    return _built(kind, direction, given, file, generator)


_TIMES = ("start", "motion", "ramp", "rest")

_TAKES: dict[str, Sequence[str]] = {
    "sine": ("frequency", "phase", *_TIMES),
    "multisine": ("base", "highest", *_TIMES),
    "steps": ("rise", "stay", "start", "rest"),
    "decay": ("hold", "free"),
    "csv": ("start", "ramp", "rest"),
}


def _built(
    kind: str, direction: Pose, given: dict[str, float], file: str, generator: np.random.Generator
) -> Any:
    seconds = {f"{name}_s": value for name, value in given.items()}
    if kind == "csv":
        return Recorded.from_csv(Path(file), **seconds)
    if kind == "steps":
        return Staircase((direction,), **seconds)
    if kind == "decay":
        return FreeDecay(direction, **seconds)
    times = Times(**{f"{name}_s": given[name] for name in _TIMES if name in given})
    if kind == "sine":
        phase = float(np.deg2rad(given.get("phase", 0.0)))
        return Multisine.sine(direction, given.get("frequency", 1.0), phase, times)
    base = given.get("base", 0.5)
    return Multisine.odd_random_phase(
        direction, base, given.get("highest", 10.0 * base), generator, times
    )
