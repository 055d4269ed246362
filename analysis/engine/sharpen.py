"""Shapes that are only tried, such as the moment of an event: at ever closer values."""

from collections.abc import Callable

from analysis.engine.state import State


def sharpened(state: State, score: Callable[[State], float], *, everywhere: bool = True) -> State:
    """The best of the values that each such shape is tried at, and of ever closer ones about it.

    Parameters
    ----------
    state
        From where.
    score
        How well a state explains.
    everywhere
        Try them all; otherwise those about where it stands.
    """
    for name, part in state.hypothesis.parts.items():
        for shape in state.candidates[name].shapes:
            if not shape.finest or len(shape.grid) < 2:
                continue
            distance = abs(shape.grid[1] - shape.grid[0])
            at = part.shapes.get(shape.name, shape.default)
            best = score(state)
            values = shape.grid if everywhere else (at - distance, at + distance)
            while distance >= shape.finest:
                for tried in values:
                    there = state.shaped(name, shape.name, tried)
                    found = score(there)
                    if found > best:
                        best, at, state = found, tried, there
                distance *= 0.5
                values = (at - distance, at + distance)
    return state
