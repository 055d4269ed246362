"""Host-side zeros: what each cell gives without load, taken with date and spread, never a tare.

The amplifiers' own tare is left alone (protocol note, section 7): a zero that lives in a device is
lost with it, and nobody sees it in the data.
"""

from datetime import datetime
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from cdpr8.errors import CheckError, DataError

ZEROS_FILE = "zeros.json"
"""Beside the rig file; `rig record` reads it."""

MOST_SPREAD_MV_PER_V = 1e-3
"""A cell that moves more than this (0.1 % of its range) is not at rest."""


MOST_ZERO_MV_PER_V = 0.1
"""A cell that gives more than this (a tenth of its range) carries a load."""


class Zero(BaseModel):
    """One cell without load."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    zero_mv_per_v: float = Field(description="mean")
    spread_mv_per_v: float = Field(ge=0.0, description="standard deviation of one value")
    values: int = Field(gt=0)
    taken: datetime
    serial_number: str = Field(description="of the amplifier it was taken with")


class Zeros(BaseModel):
    """The zeros of a rig's cells, by cable."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    cables: dict[int, Zero]


def take_zero(
    values_mv_per_v: "np.typing.ArrayLike", taken_: datetime, serial_number: str, cable: int
) -> Zero:
    """The zero from values at rest.

    Raises
    ------
    CheckError
        The values move, or are those of a loaded cell.
    """
    values = np.asarray(values_mv_per_v, dtype=float)
    halves = np.array_split(values, 2)
    spread = float(values.std(ddof=1)) if len(values) > 1 else 0.0
    drift = float(abs(halves[1].mean() - halves[0].mean())) if len(values) > 1 else 0.0
    worst = max(spread, drift)
    if worst > MOST_SPREAD_MV_PER_V:
        raise CheckError(
            f"cable {cable} is not at rest: it moves by {worst:.2g} mV/V",
            allowed=f"up to {MOST_SPREAD_MV_PER_V:g} mV/V",
            remedy="let the cable hang free and still, then take the zero again",
        )
    mean = float(values.mean())
    if abs(mean) > MOST_ZERO_MV_PER_V:
        raise CheckError(
            f"cable {cable} carries a load: its cell gives {mean:+.3f} mV/V",
            allowed=f"up to {MOST_ZERO_MV_PER_V:g} mV/V either way",
            remedy="let the cable hang free; a cell that gives so much without load is damaged",
        )
    return Zero(
        zero_mv_per_v=round(mean, 9),
        spread_mv_per_v=round(spread, 9),
        values=len(values),
        taken=taken_,
        serial_number=serial_number,
    )


def read_zeros(path: Path) -> Zeros | None:
    """The zeros in a file; None where there is no such file.

    Raises
    ------
    DataError
        The file is no zeros file.
    """
    if not path.is_file():
        return None
    try:
        return Zeros.model_validate_json(path.read_text(encoding="utf-8"))
    except (ValidationError, UnicodeDecodeError, OSError) as error:
        raise DataError(
            f"is no zeros file: {str(error).splitlines()[0]}",
            where=str(path),
            remedy="take the zeros again with `rig zero`",
        ) from None


def write_zeros(path: Path, zeros: Zeros) -> None:
    """Write the zeros whole or not at all."""
    part = path.with_suffix(path.suffix + ".part")
    part.write_text(zeros.model_dump_json(indent=1) + "\n", encoding="utf-8")
    part.replace(path)


def zero_values(zeros: Zeros | None) -> dict[int, float]:
    """Cable -> zero in mV/V."""
    if zeros is None:
        return {}
    return {cable: zero.zero_mv_per_v for cable, zero in zeros.cables.items()}


def taken(zeros: Zeros | None, cable: int) -> str:
    """When a cable's zero was taken, for start.json."""
    zero = None if zeros is None else zeros.cables.get(cable)
    return "never" if zero is None else zero.taken.isoformat()


def default_zeros_path(rig_path: Path) -> Path:
    """Beside the rig file; in the working directory where the rig file is the packaged one."""
    from cdpr8.rigfile import packaged_rig_path

    packaged = rig_path.resolve() == packaged_rig_path().resolve()
    return Path(ZEROS_FILE) if packaged else rig_path.parent / ZEROS_FILE


def check_zeros(zeros: Zeros | None, serial_numbers: dict[int, str]) -> None:
    """Hold that each zero was taken with the amplifier that is on the cable now.

    Raises
    ------
    DataError
        It was taken with another.
    """
    for cable, zero in ({} if zeros is None else zeros.cables).items():
        serial_number = serial_numbers.get(cable, "")
        if serial_number != zero.serial_number:
            raise DataError(
                f"the zero of cable {cable} was taken with amplifier {zero.serial_number!r}, "
                f"and {serial_number!r} is on it now",
                remedy="take the zeros again with `rig zero`",
            )
