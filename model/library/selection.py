"""The effects somebody switched on, with their numbers: from a rig file, a command or a program."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from cdpr8.errors import UsageError
from model.library.discovery import library
from model.library.effect import Effect, Parameter

Array = NDArray[np.float64]
Value = float | tuple[float, ...]

ALL_CABLES = tuple(range(1, CABLES + 1))


@dataclass(frozen=True)
class ActiveEffect:
    """One effect switched on.

    Parameters
    ----------
    name
        Of an effect of the library.
    values
        Parameters by name: one number, or eight, one for each cable. What is left out has its
        default.
    cables
        Where it acts, 1 to 8; default: everywhere.

    Raises
    ------
    UsageError
        There is no such effect, parameter or cable, or a value is beyond its plausible range.
    """

    name: str
    values: Mapping[str, Value] = field(default_factory=dict)
    cables: tuple[int, ...] = ALL_CABLES

    def __post_init__(self) -> None:
        known = library()
        if self.name not in known:
            raise UsageError(f"no effect {self.name!r}", allowed=", ".join(known))
        if wrong := [cable for cable in self.cables if cable not in ALL_CABLES]:
            raise UsageError(f"{self.name}: no cable {wrong[0]!r}", allowed="1 to 8")
        if self.cables != ALL_CABLES and not self.effect.per_cable:
            raise UsageError(
                f"{self.name} does not act on single cables", allowed="no choice of cables"
            )
        values = {name: self._checked(name, value) for name, value in self.values.items()}
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "cables", tuple(self.cables))

    @property
    def effect(self) -> Effect:
        """What the library says of it."""
        return library()[self.name]

    @cached_property
    def is_nothing(self) -> bool:
        """Whether every magnitude is zero: it is as if it were not there."""
        return not any(self._columns[name].any() for name in self.effect.magnitudes)

    def columns(self) -> Mapping[str, Array]:
        """Every parameter for every cable, shape (8,); magnitudes are zero where it does not act.

        A parameter that is no cable's own has one value eight times.
        """
        return self._columns

    @cached_property
    def _columns(self) -> Mapping[str, Array]:
        columns = {}
        for parameter in self.effect.parameters:
            column = np.full(CABLES, self.values.get(parameter.name, parameter.default))
            if parameter.magnitude and parameter.per_cable and self.cables != ALL_CABLES:
                elsewhere = np.setdiff1d(ALL_CABLES, self.cables) - 1
                column[elsewhere] = 0.0
            column.flags.writeable = False
            columns[parameter.name] = column
        return MappingProxyType(columns)

    def numbers(self) -> Mapping[str, float]:
        """One value of each parameter, for effects that are not a cable's own."""
        return MappingProxyType({name: float(column[0]) for name, column in self._columns.items()})

    def as_table(self) -> dict[str, object]:
        """As the rig file keeps it, below [physics.NAME]."""
        table: dict[str, object] = {
            name: list(value) if isinstance(value, tuple) else value
            for name, value in self.values.items()
        }
        if self.cables != ALL_CABLES:
            table["cables"] = list(self.cables)
        return table

    @classmethod
    def from_table(cls, name: str, table: Mapping[str, object]) -> Self:
        """From a table [physics.NAME] of a rig file."""
        values = dict(table)
        cables = values.pop("cables", ALL_CABLES)
        if isinstance(cables, int):
            cables = (cables,)
        if not isinstance(cables, (list, tuple)):
            raise UsageError(f"{name}: cables = {cables!r}", allowed="a list such as [1, 2]")
        return cls(name, {key: _plain(name, key, value) for key, value in values.items()},
                   tuple(cables))  # fmt: skip

    @classmethod
    def from_text(cls, text: str) -> Self:
        """From the command line: NAME, NAME:parameter=value,... and @cables, as in a=1@1,2."""
        head, at, places = text.partition("@")
        name, _, listed = head.partition(":")
        values: dict[str, Value] = {}
        for item in filter(None, listed.split(",")):
            key, equals, value = item.partition("=")
            values[key.strip()] = _number(name, key, value if equals else "")
        try:
            cables = tuple(int(place) for place in places.split(",")) if at else ALL_CABLES
        except ValueError:
            raise UsageError(f"{name}: cables {places!r}", allowed="such as @1,2") from None
        return cls(name.strip(), values, cables)

    def _checked(self, key: str, value: Value) -> Value:
        for parameter in self.effect.parameters:
            if parameter.name == key:
                return _in_range(self.name, parameter, value)
        allowed = ", ".join(parameter.name for parameter in self.effect.parameters)
        raise UsageError(f"{self.name} has no parameter {key!r}", allowed=allowed)


def _in_range(name: str, parameter: Parameter, value: Value) -> Value:
    values = np.atleast_1d(np.asarray(value, dtype=float))
    if values.shape not in ((1,), (CABLES,)) or (values.size > 1 and not parameter.per_cable):
        wanted = "one number, or eight, one a cable" if parameter.per_cable else "one number"
        raise UsageError(f"{name}: {parameter.name} = {value!r}", allowed=wanted)
    within = (values >= parameter.low) & (values <= parameter.high)
    if not within.all():
        wrong = float(values[~within][0])
        unit = "" if parameter.unit == "1" else f" {parameter.unit}"
        raise UsageError(
            f"{name}: {parameter.name} = {wrong:g} is not plausible",
            allowed=f"{parameter.low:g} to {parameter.high:g}{unit}",
        )
    return float(values[0]) if values.size == 1 else tuple(float(one) for one in values)


def _plain(name: str, key: str, value: object) -> Value:
    """A number of a rig file: bare, eight in a list, or a table with a value."""
    if isinstance(value, Mapping) and "value" in value:
        value = value["value"]
    if isinstance(value, (list, tuple)):
        return tuple(_number(name, key, one) for one in value)
    return _number(name, key, value)


def _number(name: str, key: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise UsageError(f"{name}: {key} = {value!r}", allowed="a number") from None


def of_rig(physics: Mapping[str, Mapping[str, object]]) -> tuple[ActiveEffect, ...]:
    """The effects a rig file has switched on."""
    return tuple(ActiveEffect.from_table(name, table) for name, table in physics.items())


def those_that_act(effects: Iterable[ActiveEffect]) -> tuple[ActiveEffect, ...]:
    """Those that are something, in the order of the library.

    Raises
    ------
    UsageError
        An effect is switched on twice.
    """
    found: dict[str, ActiveEffect] = {}
    for effect in effects:
        if effect.name in found:
            raise UsageError(
                f"{effect.name} is switched on twice",
                allowed="once, with eight values where cables differ",
            )
        found[effect.name] = effect
    return tuple(found[name] for name in library() if name in found and not found[name].is_nothing)
