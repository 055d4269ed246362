"""Processes that simulate beside this one: what comes does not depend on who did it."""

import gc
import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

from analysis.diagnosis import crew
from analysis.diagnosis.crew import Crew


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


def test_little_work_starts_nobody() -> None:
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
