import numpy as np
import pytest
from scipy.integrate import DOP853, RK45

from cdpr8.rigfile import Excitation, Rig
from model import compiled, dop853, simulate
from model.extras import pack, state_count
from model.library.discovery import kernel_effects
from model.library.selection import ActiveEffect
from model.method import METHODS, find_method
from model.runge_kutta import first_beyond, integrate
from model.task import Task
from model.trajectory import rows_inside


def problem(rig: Rig, steps_taken: int, effects: tuple[ActiveEffect, ...] = ()) -> tuple:
    """Arguments of `integrate` for the start of a lively run, made afresh each time."""
    method, states = find_method("dop853"), state_count(effects)
    task = Task(rig, Excitation(rest_s=0.0, motion_s=1.0, ramp_s=0.0), effects=effects)
    steps = task.steps(method, 1000.0, 2e-3)
    inside, inside_weights = rows_inside(method, steps)
    state = np.random.default_rng(1).normal(size=states) * 1e-3
    return (
        state,
        steps.step_s[:steps_taken],
        task.drive_at_stages(method, steps)[:steps_taken],
        0,
        np.full(states, 1e-4),
        steps.first_row[: steps_taken + 2],
        inside,
        inside_weights,
        np.full(states, 1e9),
        method.stage_weights,
        method.step_weights,
        task.machine.plant(),
        pack(task.machine, effects),
        np.zeros((method.nodes.size, states)),
        np.zeros(states),
        np.zeros((2 * steps_taken + 2, states)),
    )


EFFECTS = tuple(ActiveEffect(effect.name) for effect in kernel_effects())


@pytest.mark.parametrize("effects", [(), EFFECTS], ids=["none", "all"])
def test_the_compiled_kernel_is_the_python_kernel(
    rig: Rig, effects: tuple[ActiveEffect, ...]
) -> None:
    plain, fast = problem(rig, 10, effects), problem(rig, 10, effects)
    assert integrate(*plain) == compiled.integrator()(*fast)
    assert fast[-1] == pytest.approx(plain[-1], rel=1e-9, abs=1e-12)
    assert plain[-1][20].any()


def test_a_nan_counts_as_beyond_every_limit() -> None:
    limit = np.ones(3)
    assert first_beyond(np.array([0.5, -0.9, 1.0]), limit) == -1
    assert first_beyond(np.array([0.5, np.nan, 2.0]), limit) == 1
    assert first_beyond(np.array([0.5, 0.0, -2.0]), limit) == 2


def test_the_coefficients_of_dop853_are_scipys() -> None:
    method = find_method("dop853")
    last = DOP853.n_stages
    assert np.array_equal(method.nodes, [*DOP853.C[:last], 1.0, *DOP853.C_EXTRA])
    assert np.array_equal(method.stage_weights[:last, :last], DOP853.A[:last, :last])
    assert np.array_equal(method.stage_weights[last, :last], DOP853.B)
    assert np.array_equal(method.stage_weights[last + 1 :], DOP853.A_EXTRA)
    assert np.array_equal(method.step_weights, DOP853.B)
    assert np.array_equal(np.array(dop853.DENSE_WEIGHTS), DOP853.D)


def test_the_coefficients_of_dp5_are_scipys() -> None:
    method = find_method("dp5")
    assert np.array_equal(method.nodes, RK45.C)
    assert np.allclose(method.stage_weights[:, :5], RK45.A, rtol=1e-15)
    assert np.allclose(method.step_weights, RK45.B, rtol=1e-15)


def test_values_inside_a_step_meet_its_ends() -> None:
    method = find_method("dop853")
    start, end = method.weights_inside(np.array([0.0, 1.0]))
    assert not start.any()
    assert end[:12] == pytest.approx(method.step_weights, abs=1e-14)
    assert end[12:] == pytest.approx(np.zeros(4), abs=1e-14)


@pytest.mark.parametrize("name", METHODS)
def test_a_tableau_is_consistent(name: str) -> None:
    method = find_method(name)
    assert method.step_weights.sum() == pytest.approx(1.0)
    assert method.stage_weights.sum(axis=1) == pytest.approx(method.nodes)
    assert not np.triu(method.stage_weights).any(), "explicit"


@pytest.mark.parametrize(
    ("name", "steps_s"),
    [("dop853", (0.02, 0.01)), ("dp5", (4e-3, 2e-3)), ("rk4", (2e-3, 1e-3))],
)
def test_a_method_has_its_order_on_this_machine(
    rig: Rig, name: str, steps_s: tuple[float, float]
) -> None:
    motion = Excitation(rest_s=0.0, motion_s=1.0, ramp_s=0.0)

    def end(step_s: float) -> np.ndarray:
        return simulate(rig, motion, method=name, step_s=step_s, output_rate_hz=10.0).pose[-1]

    exact = end(5e-4 if name == "dop853" else 1e-4)
    coarse, fine = (np.abs(end(step_s) - exact).max() for step_s in steps_s)
    order = np.log2(coarse / fine)
    assert order == pytest.approx(find_method(name).order, abs=1.0)
