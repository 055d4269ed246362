"""What a fit takes: fewer evaluations, and an error far below the noise of cells."""

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import ActiveEffect, Task
from model.method import find_method
from model.simulator import run

RATE_HZ = 333.0
MOTION = Excitation(rest_s=0.5, motion_s=5.0, ramp_s=0.5)
NOISE_N = 5e-3
"""Of the cells at rest, a sample."""


def task_with(rig: Rig, *names: str) -> Task:
    return Task(rig, MOTION, effects=[ActiveEffect(name) for name in names])


@pytest.mark.parametrize(
    ("names", "method"),
    [((), "dop853"), (("cable_viscous",), "dop853"), (("pulley_coulomb",), "dp5")],
)
def test_a_sharp_switch_takes_a_low_order(rig: Rig, names: tuple[str, ...], method: str) -> None:
    assert task_with(rig, *names).thrifty(RATE_HZ)[0] == method


@pytest.mark.parametrize(
    "names", [(), ("cable_viscous",), ("pulley_stribeck",), ("pulley_coulomb",)]
)
def test_it_evaluates_less_and_errs_by_less_than_a_tenth_of_noise(
    rig: Rig, names: tuple[str, ...]
) -> None:
    task = task_with(rig, *names)
    method, step_s = task.thrifty(RATE_HZ)
    thrifty = run(task, method, step_s, RATE_HZ)
    usual = run(task, output_rate_hz=RATE_HZ)
    exact = run(task, step_s=2e-4, output_rate_hz=RATE_HZ)
    assert thrifty.stats.derivatives < 0.7 * usual.stats.derivatives
    missed = thrifty.tension_n - exact.tension_n
    assert np.sqrt(np.mean(missed**2)) < 0.1 * NOISE_N


def test_steps_divide_rows_or_join_them(rig: Rig) -> None:
    for rate_hz in (50.0, 333.0, 1000.0):
        for names in ((), ("pulley_coulomb",)):
            task = task_with(rig, *names)
            method, step_s = task.thrifty(rate_hz)
            ratio = step_s * rate_hz
            assert round(ratio) == pytest.approx(ratio) or round(1 / ratio) == pytest.approx(
                1 / ratio
            )
            assert step_s <= task.step_s(find_method(method), thrifty=True) * (1.0 + 1e-9)
