"""The bus's thread comes before others, where the user may ask for that."""

import os
import sys
import threading
from collections.abc import Callable

import pytest

from rig.schedule import PREFERRED_NICE, prefer_this_thread

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="Linux only")


def on_a_thread(act: Callable[[], int]) -> int:
    found: list[int] = []
    thread = threading.Thread(target=lambda: found.append(act()))
    thread.start()
    thread.join()
    return found[0]


def policy() -> int:
    return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK


def require_real_time() -> None:
    def ask() -> int:
        try:
            os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(1))
        except PermissionError:
            return False
        return True

    if not on_a_thread(ask):
        pytest.skip("this user may have no real-time thread")


def test_it_is_a_real_time_thread_and_what_it_starts_is_not() -> None:
    require_real_time()

    def preferred() -> int:
        prefer_this_thread()
        return policy()

    def started() -> int:
        prefer_this_thread()
        return on_a_thread(policy)

    assert on_a_thread(preferred) == os.SCHED_RR
    assert on_a_thread(started) == os.SCHED_OTHER
    assert policy() == os.SCHED_OTHER


def test_where_that_is_refused_it_asks_for_a_lower_niceness(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[int, int, int]] = []

    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    def note(*those: int) -> None:
        asked.append(those)  # type: ignore[arg-type]
        refuse()  # this user may not even that, and the recording goes on

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    monkeypatch.setattr(os, "setpriority", note)

    def preferred() -> int:
        prefer_this_thread()
        return threading.get_native_id()

    own = on_a_thread(preferred)
    assert asked == [(os.PRIO_PROCESS, own, PREFERRED_NICE)]
