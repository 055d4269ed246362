import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from distributed import Client

from cdpr8.errors import DataError, UsageError
from cdpr8.rigfile import Excitation, Rig
from model import jobs
from model.jobs import Job, Row, Where, run_jobs
from model.sweep import Plan, sweep

VALUES = [{"x": float(k)} for k in range(11)]
IDENTITY = {"what": "squares"}

SHORT = Plan(
    Excitation(rest_s=0.05, motion_s=0.3, ramp_s=0.1), (2.0, 5.0, 9.0), repetitions=4, seed=3
)


class Squares:
    """Squares with a random part; remembers what it was asked."""

    def __init__(self) -> None:
        self.asked: list[int] = []

    def __call__(self, block: Sequence[Job]) -> list[Row]:
        self.asked += [job.number for job in block]
        return [{"square": job.values["x"] ** 2, "draw": job.generator().normal()} for job in block]


def run(work: Squares, results: Path | None, **how: object) -> dict[int, Row]:
    arguments = {"seed": 7, "identity": IDENTITY, "block": 3, **how}
    return dict(run_jobs(work, VALUES, results=results, **arguments))


def test_every_task_draws_from_its_own_child_of_the_seed() -> None:
    rows = run(Squares(), None)
    children = np.random.SeedSequence(7).spawn(len(VALUES))
    assert sorted(rows) == list(range(len(VALUES)))
    for number, child in enumerate(children):
        assert rows[number]["draw"] == np.random.default_rng(child).normal()
        assert rows[number]["square"] == number**2


def test_a_file_cut_at_any_byte_leads_to_the_same_rows(tmp_path: Path) -> None:
    results = tmp_path / "runs.jsonl"
    whole = run(Squares(), results)
    content = results.read_bytes()
    header = content.index(b"\n") + 1
    for cut in range(0, len(content), 7):
        results.write_bytes(content[:cut])
        work = Squares()
        assert run(work, results) == whole
        kept = content[:cut].count(b"\n") - 1 if cut >= header else 0
        assert len(work.asked) == len(VALUES) - kept
        assert sorted(results.read_bytes().splitlines()) == sorted(content.splitlines())


def test_seed_and_identity_are_written_and_another_file_is_refused(tmp_path: Path) -> None:
    results = tmp_path / "runs.jsonl"
    run(Squares(), results)
    header = json.loads(results.read_text().splitlines()[0])
    assert (header["seed"], header["identity"]) == (7, IDENTITY)
    for how, says in (
        ({"seed": 8}, "seed 7, here 8"),
        ({"identity": {"what": "cubes"}}, "what differ"),
    ):
        with pytest.raises(DataError, match=says):
            run(Squares(), results, **how)


def test_a_file_of_something_else_is_refused_and_left_alone(tmp_path: Path) -> None:
    results = tmp_path / "runs.jsonl"
    results.write_text("t_s,x_m\n0,1\n")
    with pytest.raises(DataError, match="other jobs"):
        run(Squares(), results)
    assert results.read_text() == "t_s,x_m\n0,1\n"


def test_tasks_are_made_and_done_as_their_rows_are_asked_for() -> None:
    work = Squares()
    rows = run_jobs(work, VALUES, seed=0, identity=IDENTITY, block=3)
    list(islice(rows, 4))
    assert work.asked == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("how", [{"block": 0}, {"where": Where(0)}, {"where": Where(-2)}])
def test_no_workers_or_no_blocks_are_refused(how: dict) -> None:
    with pytest.raises(UsageError, match="at least 1"):
        run(Squares(), None, **how)


def test_two_processes_give_the_rows_of_one(rig: Rig, short_rows: dict[int, Row]) -> None:
    assert dict(sweep(rig, SHORT, where=Where(workers=2))) == short_rows


def test_a_dask_cluster_gives_the_rows_of_one_process(
    rig: Rig, short_rows: dict[int, Row], scheduler: str
) -> None:
    assert dict(sweep(rig, SHORT, where=Where(scheduler=scheduler))) == short_rows
    with Client(scheduler, set_as_default=False) as client:
        done = client.run(lambda dask_worker: dask_worker.state.executed_count)
    assert len(done) == 2
    assert sum(done.values()) > 0, "the workers did it"


def test_a_sweep_killed_in_the_middle_goes_on_where_it_was(
    rig: Rig, tmp_path: Path, short_rows: dict[int, Row]
) -> None:
    results = tmp_path / "runs.jsonl"
    killed = subprocess.Popen(
        [sys.executable, "-c", KILLED, str(results)], stderr=subprocess.DEVNULL
    )
    try:
        wait_for(lambda: results.exists() and results.read_bytes().count(b"\n") > 2)
    finally:
        killed.send_signal(signal.SIGKILL)
        killed.wait()
    before = results.read_bytes().count(b"\n") - 1
    assert 0 < before < len(SHORT.jobs())
    assert dict(sweep(rig, SHORT, results=results)) == short_rows
    assert results.read_bytes().count(b"\n") - 1 == len(SHORT.jobs())


def test_a_scheduler_that_does_not_answer_is_told(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(jobs, "SCHEDULER_WAIT_S", 0.5)
    with pytest.raises(UsageError, match="dask scheduler"):
        dict(sweep(rig, SHORT, where=Where(scheduler="tcp://127.0.0.1:9")))


KILLED = """
import sys, time
from pathlib import Path
from cdpr8.rigfile import Excitation, load_rig, packaged_rig_path
from model import jobs
from model.sweep import Plan, sweep
plan = Plan(Excitation(rest_s=0.05, motion_s=0.3, ramp_s=0.1), (2.0, 5.0, 9.0), 4, seed=3)
jobs.run_jobs.__kwdefaults__["block"] = 1
for _ in sweep(load_rig(packaged_rig_path()), plan, results=Path(sys.argv[1])):
    time.sleep(0.3)
"""


@pytest.fixture(scope="module")
def short_rows(rig: Rig) -> dict[int, Row]:
    return dict(sweep(rig, SHORT))


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A real `dask scheduler` with two `dask worker`, on the loopback."""
    folder = tmp_path_factory.mktemp("dask")
    file = folder / "scheduler.json"
    common = ["--no-dashboard", "--scheduler-file", str(file)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    started: list[subprocess.Popen[bytes]] = []

    def start(*arguments: str) -> None:
        with (folder / f"{len(started)}.log").open("wb") as log:
            command = [sys.executable, "-m", "dask", *arguments, *common]
            started.append(
                subprocess.Popen(command, stdout=log, stderr=log, cwd=folder, env=environment)
            )

    try:
        start("scheduler", "--host", "127.0.0.1", "--port", "0")
        wait_for(file.exists)
        for _ in range(2):
            start("worker", "--nthreads", "1", "--no-nanny")
        address = json.loads(file.read_text())["address"]
        with Client(address, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
        yield address
    finally:
        for process in reversed(started):
            process.terminate()
        for process in started:
            try:
                process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def wait_for(condition, timeout_s: float = 60.0) -> None:
    ends = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < ends, "waited in vain"
        time.sleep(0.02)
