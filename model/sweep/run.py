"""`sweep`: the runs of a plan, as rows."""

import hashlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import model
from cdpr8.provenance import versions
from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.schema import Rig
from model.batch import simulate_many
from model.compiled import Announce
from model.jobs import HERE, Row, Where, run_jobs
from model.sweep.amplitudes import run_block
from model.sweep.plan import Plan
from model.task import Task


def sweep(
    rig: Rig, plan: Plan, *, results: Path | None = None, where: Where = HERE
) -> Iterator[tuple[int, Row]]:
    """Run a sweep.

    Parameters
    ----------
    rig
        The machine.
    plan
        What is run.
    results
        File the rows are appended to, and from which a sweep that was stopped goes on.
    where
        Where to run.

    Yields
    ------
    tuple of int and dict
        Number of a run, by which rows are put in order, and its row: `model.sweep.amplitudes`.
    """
    identity = plan.identity() | {
        "rig": rig.name,
        "rig_sha256": hashlib.sha256(rig.model_dump_json().encode()).hexdigest(),
        "model_sha256": _source_digest(),
        "versions": versions(),
    }
    yield from run_jobs(
        partial(run_block, rig, plan),
        plan.jobs(),
        seed=plan.seed,
        identity=identity,
        results=results,
        where=where,
    )


def warm_up(rig: Rig, announce: Announce) -> None:
    """Have the kernel compiled and kept on disk before processes ask for it all at once.

    Parameters
    ----------
    rig
        The machine.
    announce
        Told one line if it has to be compiled, which takes some seconds.
    """
    brief = Excitation(rest_s=0.0, motion_s=0.02, ramp_s=0.0)
    simulate_many([Task(rig, brief)], lambda _: None, announce=announce)


def _source_digest() -> str:
    """Of the whole model: rows of two models must not stand in one file."""
    folder = Path(str(model.__file__)).parent
    sources = sorted(folder.rglob("*.py"))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in sources)).hexdigest()
