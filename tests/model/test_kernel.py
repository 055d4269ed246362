import numpy as np
import pytest
from scipy.integrate import DOP853

from cdpr8.rigfile import Excitation, Rig
from model import Machine, compiled, kernel, simulate
from model.drive import wrench_table
from model.method import METHODS, find_method
from model.motion import RampedSine
from model.steps import divide


def problem(rig: Rig, steps_taken: int) -> tuple:
    """Arguments of `integrate` for the start of a lively run, made afresh each time."""
    machine, method = Machine.from_rig(rig), find_method("dop853")
    motion = RampedSine.from_excitation(Excitation(rest_s=0.0, motion_s=1.0, ramp_s=0.0))
    steps = divide(motion, 1000.0, 1e-3)
    wrench = wrench_table(machine, motion, steps.stage_s(method.nodes), steps.middle_s)
    state = np.random.default_rng(1).normal(size=kernel.STATES) * 1e-2
    return (
        state,
        steps.step_s[:steps_taken],
        wrench[:steps_taken],
        0,
        np.full(kernel.STATES, 1e-4),
        np.arange(steps_taken + 1),
        np.full(kernel.STATES, 1e3),
        method.stage_weights,
        method.step_weights,
        machine.plant(),
        np.empty((steps_taken + 1, kernel.STATES)),
    )


def test_the_compiled_kernel_is_the_python_kernel(rig: Rig) -> None:
    plain, fast = problem(rig, 20), problem(rig, 20)
    assert kernel.integrate(*plain) == compiled.integrator()(*fast)
    assert fast[-1] == pytest.approx(plain[-1], rel=1e-12, abs=1e-14)


def test_a_nan_counts_as_beyond_every_limit() -> None:
    limit = np.ones(3)
    assert kernel.first_beyond(np.array([0.5, -0.9, 1.0]), limit) == -1
    assert kernel.first_beyond(np.array([0.5, np.nan, 2.0]), limit) == 1
    assert kernel.first_beyond(np.array([0.5, 0.0, -2.0]), limit) == 2


def test_the_coefficients_of_dop853_are_scipys() -> None:
    method, stages = find_method("dop853"), DOP853.n_stages
    assert np.array_equal(method.nodes, DOP853.C[:stages])
    assert np.array_equal(method.stage_weights, DOP853.A[:stages, :stages])
    assert np.array_equal(method.step_weights, DOP853.B[:stages])


@pytest.mark.parametrize("name", METHODS)
def test_a_tableau_is_consistent(name: str) -> None:
    method = find_method(name)
    assert method.step_weights.sum() == pytest.approx(1.0)
    assert method.stage_weights.sum(axis=1) == pytest.approx(method.nodes)
    assert not np.triu(method.stage_weights).any(), "explicit"


@pytest.mark.parametrize(("name", "steps_s"), [("dop853", (0.02, 0.01)), ("rk4", (2e-3, 1e-3))])
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
