"""The drive at every stage: what a few times of it make is what every time of it would."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cdpr8.rigfile import Excitation, Rig
from model import Task, tabulated
from model.drive import drive_table
from model.library.selection import ActiveEffect
from model.method import find_method

Array = NDArray[np.float64]

DOP853 = find_method("dop853")


def course(**changes: object) -> Excitation:
    values = {"rest_s": 0.2, "motion_s": 2.0, "ramp_s": 0.3137, **changes}
    return Excitation.model_validate(values)


def both(task: Task, step_s: float | None = None) -> tuple[Array, Array]:
    """The table, and the same computed at every stage."""
    steps = task.steps(DOP853, 333.0, step_s)
    stage_s = steps.point_s[:-1, None] + DOP853.nodes * steps.step_s[:, None]
    every = drive_table(task.nominal_machine, task.driven, stage_s, steps.middle_s, task.drive_kind)
    return task.drive_at_stages(DOP853, steps), every


@pytest.mark.parametrize("kind", ["wrench", "winch"])
@pytest.mark.parametrize("step_s", [None, 1.1e-3, 2e-4])
def test_a_table_made_of_a_few_times_is_that_of_every_stage(
    rig: Rig, kind: str, step_s: float | None
) -> None:
    table, every = both(Task(rig, course(), drive=kind), step_s)
    assert table.shape == every.shape
    assert np.abs(table - every).max() < 1e-12 * np.abs(every).max()


def test_a_table_costs_a_small_part_of_all_its_stages(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def counted(machine: Any, motion: Any, time_s: Array, *rest: Any) -> Array:
        asked.append(time_s.size)
        return drive_table(machine, motion, time_s, *rest)

    monkeypatch.setattr(tabulated, "drive_table", counted)
    table, _ = both(Task(rig, course(motion_s=10.0)))
    assert sum(asked) < table[..., 0].size / 8


@pytest.mark.parametrize("changed", ["slack", "play", "break between"])
def test_what_is_not_smooth_is_computed_at_every_stage(rig: Rig, changed: str) -> None:
    play = [ActiveEffect("drive_backlash", {"backlash_deg": 0.2})]
    task = {
        "slack": Task(rig, course(amplitude_deg=14.0, frequency_hz=1.0)),
        "play": Task(rig, course(), effects=play),
        "break between": Task(rig, course(ramp_s=0.0)),
    }[changed]
    table, every = both(task)
    assert np.abs(table - every).max() < 3e-9 * np.abs(every).max()


def test_a_run_of_a_few_steps_has_a_table(rig: Rig) -> None:
    table, every = both(Task(rig, course(rest_s=0.0, motion_s=0.01, ramp_s=0.0)))
    assert len(table) < 2 * tabulated.FEWEST
    assert table == pytest.approx(every, abs=1e-12)
