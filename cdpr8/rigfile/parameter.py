"""A physical parameter as a row: value, how well it is known, unit and source."""

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, field_validator


@dataclass(frozen=True)
class Kind:
    """How well a kind of parameter is known where a rig file does not say.

    Parameters
    ----------
    unit
        Unit of the value, as written in a rig file.
    sigma
        Default standard deviation in `unit`.
    relative_sigma
        Default standard deviation as a fraction of the value, used where `sigma` is zero.
    """

    unit: str
    sigma: float = 0.0
    relative_sigma: float = 0.0


STIFFNESS = Kind("N/m", relative_sigma=0.02)
PRETENSION = Kind("N", sigma=0.1)
MASS = Kind("kg", relative_sigma=0.01)
INERTIA = Kind("kg m2", relative_sigma=0.05)
POINT = Kind("m", sigma=1e-3)
LINE_DENSITY = Kind("kg/m", relative_sigma=0.05)
DAMPING = Kind("1/s", relative_sigma=0.30)
DELAY = Kind("s", relative_sigma=0.10)

LONGEST_DELAY_S = 10.0
"""Of an amplifier's filter: the slowest (0.05 Hz) delays by 3.2 s."""


class _Row(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    sigma: float = Field(ge=0.0, description="standard deviation, in the unit; 0 fixes the value")
    unit: str
    source: str = Field(default="", description="where the value comes from")


class Scalar(_Row):
    """One number with its uncertainty, unit and source."""

    value: float


class DelayRow(Scalar):
    """A delay in seconds, 0 to `LONGEST_DELAY_S`."""

    @field_validator("value", "sigma", mode="before")
    @classmethod
    def _seconds(cls, raw: Any) -> Any:
        number = isinstance(raw, int | float) and not isinstance(raw, bool)
        if not number or not 0.0 <= raw <= LONGEST_DELAY_S:
            raise ValueError(f"a number, 0 to {LONGEST_DELAY_S:g}: seconds, not ms")
        return raw


class Point(_Row):
    """Three coordinates in metres; `sigma` holds for each."""

    value: tuple[float, float, float]


class Tensor(_Row):
    """An inertia: three principal values, or a symmetric 3x3 tensor; `sigma` holds for each."""

    value: (
        tuple[float, float, float]
        | tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    )


def _largest(value: Any) -> float:
    if isinstance(value, list | tuple):
        return max((_largest(item) for item in value), default=0.0)
    return abs(float(value)) if isinstance(value, int | float) else 0.0


def _row(kind: Kind) -> BeforeValidator:
    """A validator that turns a bare value into a row and fills what a row leaves out."""

    def expand(raw: Any) -> Any:
        if isinstance(raw, _Row):
            return raw
        row = dict(raw) if isinstance(raw, dict) else {"value": raw}
        unit = row.setdefault("unit", kind.unit)
        if unit != kind.unit:
            raise ValueError(f"unit {kind.unit!r}; the key says it too")
        row.setdefault("sigma", kind.sigma or kind.relative_sigma * _largest(row.get("value")))
        return row

    return BeforeValidator(expand)


Stiffness = Annotated[Scalar, _row(STIFFNESS)]
Pretension = Annotated[Scalar, _row(PRETENSION)]
Mass = Annotated[Scalar, _row(MASS)]
Inertia = Annotated[Tensor, _row(INERTIA)]
Position = Annotated[Point, _row(POINT)]
LineDensity = Annotated[Scalar, _row(LINE_DENSITY)]
Damping = Annotated[Scalar, _row(DAMPING)]
Delay = Annotated[DelayRow, _row(DELAY)]
