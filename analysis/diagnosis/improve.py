"""The improved rig file: the causes switched on, the parameters where the fit has them."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.library_values import library_values
from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.nuisances import STRING_KEYS, STRINGS, Meaning
from analysis.engine.candidate import Setting
from analysis.engine.diagnosis import Diagnosis
from analysis.engine.system import Point
from cdpr8 import CABLES
from cdpr8.errors import RigFileError, ToolkitError
from cdpr8.rigfile import load_rig
from model.library.discovery import library
from model.strings import left_of

Array = NDArray[np.float64]


def write_improved(machine: RecordedMachine, diagnosis: Diagnosis, path: Path) -> Path:
    """Write the first run's rig file with the causes in it.

    Parameters
    ----------
    machine, diagnosis
        What was found.
    path
        Where.

    Raises
    ------
    RigFileError
        The fit has come to numbers that no rig file may hold, such as a stiffness below zero.
        There is no file then.
    """
    run = machine.recordings[0].run
    text = (run.folder / "rig.toml").read_text(encoding="utf-8")
    intrinsics = tomllib.loads(text).get("camera", {}).get("intrinsics")
    if isinstance(intrinsics, str) and (run.folder / intrinsics).is_file():
        (path.parent / intrinsics).write_bytes((run.folder / intrinsics).read_bytes())
    for balanced in (True, False):
        data = tomllib.loads(text)
        for name, table in physics(machine, diagnosis).items():
            data.setdefault("physics", {})[name] = table
        _move(data, machine, diagnosis, balanced=balanced)
        path.write_text(_HEAD.format(run=run.name) + _spell(data), encoding="utf-8")
        try:
            load_rig(path)
            break
        except RigFileError:
            if not balanced:
                path.unlink()
                raise
    return path


_HEAD = """# Written by `analysis diagnose`: the rig file of {run}, with what the diagnosis found.
# [physics.*] holds the left-out effects; parameters stand where the fit has them.

"""


def physics(machine: RecordedMachine, diagnosis: Diagnosis) -> dict[str, dict[str, Any]]:
    """The causes as tables of a rig file's [physics]."""
    assert diagnosis.judgement is not None
    found: dict[str, dict[str, Any]] = {}
    for cause in diagnosis.judgement.causes:
        setting = Setting(cause.own, cause.shapes)
        for record in range(len(machine.recordings)):
            own = library_values(
                cause.name,
                setting,
                machine.peaks_n,
                record,
                machine.sighting,
                len(machine.recordings),
            )
            if own is None:
                continue
            table: dict[str, Any] = {}
            for one in library()[cause.name].parameters:
                if one.name in own:
                    value = np.clip(own[one.name], one.low, one.high)
                    table[one.name] = (
                        [round(float(v), 9) for v in value] if np.ndim(value) else float(value)
                    )
            found[cause.name] = table
            break
    return found


def _move(
    data: dict[str, Any], machine: RecordedMachine, diagnosis: Diagnosis, *, balanced: bool
) -> None:
    """Stiffness, mass and pretension where the fit has them; what else moved stays as it was.

    Pretensions that do not carry the weight are no rig file's: where the fit has come to such,
    they and the mass are what the simulation had them as, effects beside the file's own numbers.
    """
    assert diagnosis.judgement is not None
    rig = machine.recordings[0].rig
    chosen = diagnosis.judgement.chosen
    at = diagnosis.calibrated.rotation @ chosen.weighed.nuisance
    tighter_n = machine.trim.moved_n(Point(at, chosen.point.effects), 0)
    for sigmas, nuisance, meaning in zip(at, machine.nuisances, machine.meanings, strict=True):
        amount = float(sigmas * nuisance.sigma)
        if meaning.record > 0:
            continue
        if meaning.effect == "stiffness":
            row = rig.cable[meaning.cable - 1].stiffness_n_per_m
            _set(data["cable"][meaning.cable - 1], "stiffness_n_per_m", row.value * (1 + amount),
                 row.sigma)  # fmt: skip
        elif meaning.effect == STRINGS and amount:
            key = STRING_KEYS[meaning.parameter]
            row = getattr(rig.cable[meaning.cable - 1], key)
            value = row.value * float(left_of(amount))
            _set(data["cable"][meaning.cable - 1], key, value, row.sigma)
        elif meaning.effect in ("pretension", "mass") and not balanced:
            _add(data, meaning, amount)
        elif meaning.parameter == "pretension_offset_n":
            tighter_n[meaning.cable - 1] += amount
        elif meaning.effect == "mass":
            mass = rig.platform.mass_kg
            _set(data["platform"], "mass_kg", mass.value * (1.0 + amount), mass.sigma)
        elif meaning.effect == "drive_amplitude":
            _drive(data, diagnosis, meaning, amount)
    for place, cable in enumerate(rig.cable) if balanced else ():
        row = cable.pretension_n
        if row.sigma > 0.0:
            tight_n = row.value + float(tighter_n[place])
            _set(data["cable"][place], "pretension_n", tight_n, row.sigma)


def _add(data: dict[str, Any], meaning: Meaning, amount: float) -> None:
    """Add to a number of an effect, of one cable or of the platform."""
    table = data.setdefault("physics", {}).setdefault(meaning.effect, {})
    known = table.get(meaning.parameter, [0.0] * CABLES if meaning.cable else 0.0)
    if not meaning.cable:
        table[meaning.parameter] = round(known + amount, 9)
        return
    each = list(known) if isinstance(known, list) else [known] * CABLES
    each[meaning.cable - 1] = round(each[meaning.cable - 1] + amount, 9)
    table[meaning.parameter] = each


def _drive(data: dict[str, Any], diagnosis: Diagnosis, meaning: Meaning, amount: float) -> None:
    """A drive that is a little off is an effect of the drive, not another command."""
    assert diagnosis.judgement is not None
    if abs(amount) > 0.0 and "drive_amplitude" not in {
        one.name for one in diagnosis.judgement.causes
    }:
        data.setdefault("physics", {})[meaning.effect] = {meaning.parameter: round(amount, 9)}


def _set(table: dict[str, Any], key: str, value: float, sigma: float) -> None:
    table[key] = {
        "value": round(value, 9),
        "sigma": sigma,
        "source": "fitted by analysis diagnose",
    }


def _spell(data: dict[str, Any]) -> str:
    import tomli_w

    try:
        return tomli_w.dumps(data)
    except TypeError as error:
        raise ToolkitError(f"the improved rig file cannot be written: {error}") from None
