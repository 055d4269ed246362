"""Processes that simulate beside this one: what comes does not depend on who did it."""

import gc
import math
import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

from cdpr8 import crew
from cdpr8.crew import Crew


@dataclass(frozen=True)
class Squarer:
    """Tells who did the work."""

    offset: int

    def do(self, work: int) -> tuple[int, int]:
        return work * work + self.offset, os.getpid()


def test_others_take_their_part_once_they_are_ready() -> None:
    team: Crew[int, tuple[int, int]] = Crew(Squarer(7), 2)
    started = time.monotonic()
    who: set[int] = set()
    while len(who) < 2 and time.monotonic() < started + 60.0:
        found = team.do(range(9))
        assert [value for value, _ in found] == [i * i + 7 for i in range(9)]
        who |= {process for _, process in found}
    assert len(who) == 2
    assert os.getpid() in who


def test_what_a_killed_process_had_to_do_is_done_here() -> None:
    team: Crew[int, tuple[int, int]] = Crew(Squarer(0), 2)
    others: set[int] = set()
    started = time.monotonic()
    while not others and time.monotonic() < started + 60.0:
        others = {process for _, process in team.do(range(9))} - {os.getpid()}
    os.kill(others.pop(), signal.SIGKILL)
    found = team.do(range(9))
    assert [value for value, _ in found] == [i * i for i in range(9)]
    assert [value for value, _ in team.do(range(9))] == [i * i for i in range(9)]


ASKS = """
import os, sys, time
sys.path.insert(0, {root!r})
from cdpr8.crew import Crew
from tests.cdpr8.test_crew import Squarer
team = Crew(Squarer(0), 2)
others = set()
while not others:
    others = {{process for _, process in team.do(range(9))}} - {{os.getpid()}}
print(others.pop(), team._path, flush=True)
time.sleep(60.0)
"""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="asks /proc who is there")
def test_where_the_process_that_asked_is_killed_its_copies_end_and_leave_nothing() -> None:
    root = str(Path(__file__).parents[2])
    with subprocess.Popen(
        [sys.executable, "-c", ASKS.format(root=root)], stdout=subprocess.PIPE, text=True
    ) as asker:
        assert asker.stdout is not None
        number, path = asker.stdout.readline().split()
        other = int(number)
        os.kill(other, 0)
        assert Path(path).exists()
        asker.kill()
    until_s = time.monotonic() + 30.0
    while _is_there(other) and time.monotonic() < until_s:
        time.sleep(0.1)
    assert not _is_there(other)
    assert not Path(path).exists()


def _is_there(process: int) -> bool:
    """Whether a process is there, and has not only left its number behind."""
    try:
        state = Path(f"/proc/{process}/stat").read_text(encoding="ascii")
    except FileNotFoundError:
        return False
    return state.rsplit(")", 1)[1].split()[0] != "Z"


def test_little_work_starts_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crew.Crew, "answered_s", -math.inf)
    team: Crew[int, tuple[int, int]] = Crew(Squarer(0), 2)
    found = team.do(range(crew.FEW - 1))
    assert {process for _, process in found} == {os.getpid()}
    assert team._path is None


def test_one_process_is_enough() -> None:
    team: Crew[int, tuple[int, int]] = Crew(Squarer(0), 1)
    found = team.do(range(3 * crew.FEW))
    assert {process for _, process in found} == {os.getpid()}


def test_the_copy_goes_with_the_worker() -> None:
    team: Crew[int, tuple[int, int]] = Crew(Squarer(0), 2)
    team.do(range(2 * crew.FEW))
    path = team._path
    assert isinstance(path, Path)
    assert path.exists()
    del team
    gc.collect()
    assert not path.exists()
