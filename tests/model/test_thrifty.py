"""What a fit takes: fewer evaluations, and an error far below the noise of cells."""

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import ActiveEffect, Task, simulate_many
from model.library.discovery import library
from model.library.effect import Effect
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


def largest(effect: Effect) -> ActiveEffect:
    """With every magnitude at a quarter of what is plausible, or its default, if that is more."""
    values = {
        one.name: max(0.25 * one.high, one.default) for one in effect.parameters if one.magnitude
    }
    return ActiveEffect(effect.name, values)


IN_KERNEL = [one for one in library().values() if one.acts.in_kernel]


@pytest.mark.parametrize("effect", IN_KERNEL, ids=lambda one: one.name)
def test_no_effect_errs_by_more_than_its_usual_step_makes_it(rig: Rig, effect: Effect) -> None:
    short = Excitation(rest_s=0.3, motion_s=1.5, ramp_s=0.3)
    for one in (ActiveEffect(effect.name), largest(effect)):
        task = Task(rig, short, effects=[one])
        exact = run(task, step_s=2.5e-4, output_rate_hz=RATE_HZ).tension_n
        usual = run(task, output_rate_hz=RATE_HZ).tension_n
        thrifty = run(task, *task.thrifty(RATE_HZ), RATE_HZ).tension_n
        if len(usual) < len(exact) or len(exact) < len(thrifty):
            continue  # such a machine flies apart
        missed = [float(np.sqrt(np.mean((one - exact) ** 2))) for one in (thrifty, usual)]
        assert missed[0] < max(0.1 * NOISE_N, 3.0 * missed[1])


@pytest.mark.parametrize(
    ("name", "presliding_m", "loss_s"),
    [
        ("pulley_coulomb", 2.5e-5, 5e-5),
        ("pulley_stribeck", 5e-5, 0.0),
        ("pulley_presliding", 2e-4, 0.0),
    ],
)
def test_a_platform_on_cables_that_stick_does_not_ring_up(
    rig: Rig, name: str, presliding_m: float, loss_s: float
) -> None:
    """What holds 1 N within 25 um is as stiff as thirty cables: steps must suit its tone too.

    Without any loss it is the last digits that say when such a cable slips, at a tenth of the step.
    """
    numbers = {"coulomb_n": 1.0, "presliding_m": presliding_m, "bristle_loss_s": loss_s}
    short = Excitation(rest_s=0.3, motion_s=1.0, ramp_s=0.3)
    task = Task(rig, short, effects=[ActiveEffect(name, numbers)])
    exact = run(task, step_s=1e-4, output_rate_hz=RATE_HZ).tension_n
    method, step_s = task.thrifty(RATE_HZ)
    missed = run(task, method, step_s, RATE_HZ).tension_n - exact
    assert np.sqrt(np.mean(missed**2)) < NOISE_N
    too_long = run(task, "dp5", 1.5e-3, RATE_HZ).tension_n - exact
    assert np.sqrt(np.mean(too_long**2)) >= np.sqrt(np.mean(missed**2))


@pytest.mark.long
def test_lanes_of_a_fit_do_not_depend_on_what_stands_beside_them(rig: Rig) -> None:
    """What is off in a lane has its states there all the same, which must stay at rest."""
    tasks = [task_with(rig, effect.name) for effect in IN_KERNEL]
    alike: dict[tuple[str, float], list[Task]] = {}
    for task in tasks:
        alike.setdefault(task.thrifty(RATE_HZ), []).append(task)
    for (method, step_s), group in alike.items():
        lanes = simulate_many(group, method=method, step_s=step_s, output_rate_hz=RATE_HZ)
        for task, lane in zip(group, lanes, strict=True):
            alone = run(task, method, step_s, RATE_HZ)
            assert lane.tension_n == pytest.approx(alone.tension_n, abs=1e-4)


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
