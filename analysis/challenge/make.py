"""`analysis challenge make`: runs with concealed effects, and the sealed truth."""

import json
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from analysis.challenge.case import Case
from analysis.challenge.draw import KINDS, Slot, draw_case, slots
from analysis.challenge.plants import FIRST, Concealed, plant_named
from analysis.challenge.rig_text import rig_text
from analysis.challenge.seal import INDEX, seal
from analysis.challenge.strength import holds, of_strength, tamed
from analysis.challenge.visibility import Metric, Seen, look
from analysis.challenge.whitened import without_release
from cdpr8.errors import DataError
from model.jobs import HERE, Job, Row, Where, run_jobs

FORMAT = "cdpr8 challenge 1"
PROGRESS_FILE = ".making.jsonl"


def make(
    folder: Path,
    count: int,
    seed: int,
    *,
    plant: str = FIRST,
    rivals: bool = True,
    kinds: Sequence[str] = KINDS,
    plan: Sequence[Slot] | None = None,
    where: Where = HERE,
    step: Callable[[], None] = lambda: None,
) -> str:
    """Make a challenge.

    Parameters
    ----------
    folder
        Where; empty, or one whose making was interrupted.
    count
        Of cases.
    seed
        All its randomness.
    plant
        Which makes the runs, one of `analysis.challenge.plants.NAMES`.
    rivals
        Whether to find out which effects could be told from those concealed: half of the time.
    kinds
        "single" runs, "campaign"s, or both.
    plan
        What each case is to be; default: drawn, every effect and strength about as often.
    where
        Where to run.
    step
        Called after each case.

    Returns
    -------
    str
        SHA-256 of the sealed truth.

    Raises
    ------
    DataError
        The folder holds something else.
    """
    unfinished = folder / PROGRESS_FILE
    if folder.exists() and any(folder.iterdir()) and not unfinished.exists():
        raise DataError(
            "the folder is not empty", where=str(folder), remedy="choose another name for it"
        )
    folder.mkdir(parents=True, exist_ok=True)
    if plan is None:
        generator = np.random.default_rng(np.random.SeedSequence(seed))
        plan = slots(count, generator, kinds, plant_named(plant))
    jobs = [vars(slot) for slot in plan]
    version = metadata.version("cdpr8")
    # Nothing is said of the first plant: what it makes stays what it was, to the byte.
    which = {} if plant == FIRST else {"plant": plant}
    rows = {}
    for number, row in run_jobs(
        partial(_make_block, folder, plant, rivals),
        jobs,
        seed=seed,
        identity={"challenge": FORMAT, "version": version, "rivals": rivals} | which,
        results=unfinished,
        where=where,
        block=1,
    ):
        rows[number] = row
        step()
    cases = [rows[number] for number in range(len(plan))]
    made = {"format": FORMAT, "seed": seed, "version": version} | which
    index = made | {
        "cases": {row["case"]: {"kind": row["kind"], "runs": row["runs"]} for row in cases},
    }
    digest = seal(folder, made | {"cases": cases})
    (folder / INDEX).write_text(json.dumps(index, indent=1) + "\n", encoding="utf-8")
    unfinished.unlink()
    return digest


def _make_block(folder: Path, plant: str, rivals: bool, jobs: Sequence[Job]) -> list[Row]:
    return [_make_case(folder, plant, rivals, job) for job in jobs]


def _make_case(folder: Path, plant: str, rivals: bool, job: Job) -> Row:
    """Draw a case, size its effects, write its runs; returns the truth."""
    slot = _slot(job.values)
    drawn, sized = np.random.SeedSequence(job.seed, spawn_key=(job.number,)).spawn(2)
    case = draw_case(slot, drawn, plant_named(plant))
    seen: list[Seen] = []
    if case.concealed:
        compared = without_release(case)
        metric = Metric.of(compared)
        generator = np.random.default_rng(sized)
        sized_effects = [
            of_strength(compared, one, strength, metric, generator)
            for one, strength in zip(case.concealed, slot.strengths, strict=True)
        ]
        case = tamed(case.with_concealed(*sized_effects))
        compared = without_release(case)
        seen = look(compared, _stable(compared, metric), rivals=rivals)
    names = []
    for number, run in enumerate(case.runs, start=1):
        names.append(f"run{number:02d}")
        where = folder / case.name / names[-1]
        _clear(where)
        title = f"{job.seed} {case.name} {names[-1]}"
        text, measured = rig_text(run.rig), case.made(run)
        case.plant.write(where, title, text, run.excitation, case.sensing, measured)
    effects = [
        _told(one, strength, how, case)
        for one, strength, how in zip(case.concealed, slot.strengths, seen, strict=True)
    ]
    return {
        "case": case.name,
        "kind": case.kind,
        "runs": names,
        "machine": case.runs[0].rig.name,
        "effects": effects,
        "sensing": _plain(case.sensing),
        "offset": _plain(case.offset),
    }


def _stable(case: Case, metric: Metric) -> Metric:
    """The same metric, by a shorter step where what the case conceals asks for one."""
    if holds(case, metric.known.step_s):
        return metric
    steps_s = case.plant.steps_s
    shorter = [step_s for step_s in steps_s if step_s < metric.known.step_s]
    step_s = next((one for one in shorter if holds(case, one)), steps_s[-1])
    return Metric.of(case, step_s)


def _slot(values: Mapping[str, Any]) -> Slot:
    return Slot(
        values["number"], values["kind"], tuple(values["effects"]), tuple(values["strengths"])
    )


def _clear(folder: Path) -> None:
    """Remove what an interrupted making left of a run."""
    if folder.exists():
        import shutil

        shutil.rmtree(folder)


def _told(one: Concealed, strength: str, seen: Seen, case: Case) -> dict[str, Any]:
    """One effect as the sealed truth tells it."""
    effect = one.effect
    parameters = case.plant.told(one, case.runs[0].rig)
    return {
        "effect": effect.name,
        "side": effect.side,
        "cables": list(one.cables),
        "strength": strength,
        "size": one.size,
        "size_name": effect.size,
        "unit": effect.unit,
        "parameters": parameters,
        "details": dict(one.details),
        "change_rms": seen.rms,
        "change": seen.whole,
        "stands_out": seen.stands_out,
        "visible": bool(seen.visible),
        "detection_limit": _limit(one, seen),
        "rivals": seen.rivals,
        "separable": None if seen.separable is None else bool(seen.separable),
        "runs": len(case.runs),
    }


def _limit(one: Concealed, seen: Seen) -> float | None:
    """The size that would just be seen, by a straight line from this one."""
    return abs(one.size) * seen.threshold / seen.stands_out if seen.stands_out > 0.0 else None


def _plain(value: Any) -> dict[str, Any]:
    """A dataclass of numbers and arrays as JSON holds it."""
    return {
        name: part.tolist() if hasattr(part, "tolist") else part
        for name, part in vars(value).items()
    }
