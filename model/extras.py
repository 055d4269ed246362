"""The effects that are on, packed as the kernel reads them."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from inspect import signature
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from model.kernel import STATES, Extras
from model.library.discovery import first_parameters, kernel_effects, parameter_rows
from model.library.effect import Acts, Effect, Law, State
from model.library.lanes import CABLE
from model.library.let_go import LET_GO
from model.library.selection import ActiveEffect
from model.machine import Machine

Array = NDArray[np.float64]

SMALL_N = 1e-3
"""Step of the differences that tell what a state does that a rate holds at rest: all are forces."""


class Told(NamedTuple):
    """A state that the elongation of its cable tells, or its rate.

    Parameters
    ----------
    places
        Of the cables' in the state vector, shape (8,).
    law
        What elongations or their rates, shape (..., 8), have made of it.
    let_go
        With which share of what the platform gains at once it goes along, shape (8,).
    """

    places: NDArray[np.int64]
    law: Callable[[Array], Array]
    let_go: NDArray[np.float64]


def pack(machine: Machine, effects: Sequence[ActiveEffect]) -> Extras | None:
    """The effects of the plant, for the kernel.

    Parameters
    ----------
    machine
        Says which cables share a post.
    effects
        All effects that are on; those that do not act in the plant are passed over. One that is
        named has its law run, also where its magnitude is zero.
    """
    on = switches(effects)
    if not on.any():
        return None
    offset = np.zeros(len(kernel_effects()), dtype=np.int64)
    states = STATES
    names = {one.name for one in effects}
    for place, effect in enumerate(kernel_effects()):
        if effect.name in names:
            offset[place] = states
            states += CABLES * len(effect.states)
    return Extras(on, offset, posts(machine)[0], cable_numbers(machine, effects))


def resting(extras: Extras | None, effects: Sequence[ActiveEffect], machine: Machine) -> list[Told]:
    """The states that the elongation of their cables tells at rest.

    Parameters
    ----------
    extras, effects
        The effects of the plant, packed and as they are.
    machine
        The plant.
    """
    return list(_told_by("elongation", extras, effects, machine))


def going(extras: Extras | None, effects: Sequence[ActiveEffect], machine: Machine) -> list[Told]:
    """The states that gain of a speed that the platform is given at once; see `resting`."""
    return list(_told_by("elongation_rate", extras, effects, machine))


def _told_by(
    argument: str, extras: Extras | None, effects: Sequence[ActiveEffect], machine: Machine
) -> Iterator[Told]:
    known = {one.name: one.columns() for one in effects}
    for first, effect, state in _states(extras):
        told = state.rests if argument == "elongation" else state.goes
        if told is not None:
            numbers = {**known[effect.name], "stiffness": machine.stiffness}
            own = {one: numbers[one] for one in signature(told).parameters if one in numbers}
            let_go = numbers.get(LET_GO.name, np.zeros(CABLES))
            yield Told(first + np.arange(CABLES), partial(_of, told, own, argument), let_go)


def _of(law: Law, numbers: Mapping[str, Array], argument: str, values: Array) -> Array:
    return np.asarray(law(**{argument: values}, **numbers))


def held(
    extras: Extras | None,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Places of the states that a rate holds at rest, of the states whose rate, and small steps."""
    places: list[int] = []
    by: list[int] = []
    steps: list[float] = []
    for first, effect, state in _states(extras):
        if state.held_by and extras is not None:
            names = [one.name for one in effect.states]
            apart = CABLES * (names.index(state.held_by) - names.index(state.name))
            own = extras.carrier if state.shared else np.arange(CABLES)
            places += [first + int(one) for one in np.unique(own)]
            by += [first + int(one) + apart for one in np.unique(own)]
            steps += [SMALL_N] * len(np.unique(own))
    return np.array(places, dtype=np.int64), np.array(by, dtype=np.int64), np.array(steps)


def _states(extras: Extras | None) -> Iterator[tuple[int, Effect, State]]:
    """Each state of the effects that are on, and where that of the first cable is."""
    for place, effect in enumerate(kernel_effects()):
        if extras is not None and extras.offset[place]:
            for which, state in enumerate(effect.states):
                yield int(extras.offset[place]) + which * CABLES, effect, state


def switches(effects: Sequence[ActiveEffect]) -> NDArray[np.int64]:
    """Which effects act on each cable, a bit for each; those of the platform with cable 1."""
    on = np.zeros(CABLES, dtype=np.int64)
    named = {one.name: one for one in effects}
    for place, effect in enumerate(kernel_effects()):
        if effect.name in named:
            cables = np.array(named[effect.name].cables) - 1
            on[0 if effect.acts is Acts.PLATFORM else cables] |= 1 << place
    return on


def cable_numbers(machine: Machine, effects: Sequence[ActiveEffect]) -> Array:
    """What laws may ask of each cable, and the parameters of all effects.

    Of effects that are off, magnitudes are zero, and the rest have their default: no law shall
    divide by zero.

    Returns
    -------
    Array
        Shape (8, any), laid out as `model.library.lanes` says.
    """
    numbers = np.zeros((CABLES, CABLE["values"] + parameter_rows()))
    known = {
        "base": machine.base,
        "anchor": machine.anchor,
        "rest_length": machine.rest_length,
        "stiffness": machine.stiffness,
        "pretension": machine.pretension,
        "line_density": machine.line_density,
        "damping": machine.damping,
        "gravity": np.full(CABLES, machine.gravity),
        "post_share": posts(machine)[1],
        "rest_direction": (machine.base - machine.anchor) / machine.rest_length[:, None],
    }
    for name, values in known.items():
        block = values.reshape(CABLES, -1)
        numbers[:, CABLE[name] : CABLE[name] + block.shape[1]] = block
    named = {one.name: one.columns() for one in effects}
    for effect in kernel_effects():
        column = CABLE["values"] + first_parameters()[effect.name]
        for which, parameter in enumerate(effect.parameters):
            off = 0.0 if parameter.magnitude else parameter.default
            numbers[:, column + which] = named.get(effect.name, {}).get(parameter.name, off)
    return numbers


def state_count(effects: Sequence[ActiveEffect]) -> int:
    """Length of the state vector with these effects."""
    extra = (len(one.effect.states) for one in effects if one.effect.acts.in_kernel)
    return STATES + CABLES * sum(extra)


def posts(machine: Machine) -> tuple[NDArray[np.int64], Array]:
    """The cables of a post: those whose base points stand in the same quadrant of the floor.

    Returns
    -------
    carrier, share
        Index of the first cable of each cable's post, and one over the number of its cables.
    """
    quadrant = 2 * (machine.base[:, 0] > 0.0) + (machine.base[:, 1] > 0.0)
    same = quadrant[:, None] == quadrant[None, :]
    return same.argmax(axis=1).astype(np.int64), 1.0 / same.sum(axis=1)
