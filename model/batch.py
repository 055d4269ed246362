"""Many simulations at once: sixteen side by side on one core, for sweeps, fits and Jacobians."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from model.compiled import Announce, compiled, lane_integrator
from model.extras import cable_numbers, pack, state_count, switches
from model.kernel import STATES, Extras
from model.library.discovery import kernel_effects
from model.library.lanes import LANES, PLATFORM, WORK
from model.library.selection import ActiveEffect
from model.method import Method, find_method
from model.simulation import Simulation
from model.simulator import as_simulation, run
from model.status import Status
from model.steps import Steps, steps_a_row
from model.task import Task
from model.trajectory import Trajectory, blow_up_limits, rows_inside

Array = NDArray[np.float64]
Result = TypeVar("Result")

CHUNK_STEPS = 1024
"""Steps whose drives are tabulated together where each lane has its own: some 13 MB."""


def simulate_many(
    tasks: Sequence[Task],
    reduce: Callable[[Simulation], Result] | None = None,
    *,
    method: str = "dop853",
    step_s: float | None = None,
    output_rate_hz: float = 1000.0,
    announce: Announce | None = None,
    fewest: int = 1,
) -> list[Any]:
    """Simulate many tasks, sixteen side by side.

    Tasks whose motions last equally long and break at the same times run together; each may have
    its own machine, drive, disturbance and effects.

    Parameters
    ----------
    tasks
        What to simulate.
    reduce
        Makes of each simulation what is kept of it; default: the simulation itself. No more than
        sixteen are held at a time.
    method, step_s, output_rate_hz, announce
        As for `model.simulate`. Tasks whose default steps differ do not run together.
    fewest
        Where fewer than this can run together, they run one by one: lanes that stay empty cost as
        much as those that do not, some eight simulations.

    Returns
    -------
    list
        One result a task, in their order.
    """
    scheme = find_method(method)
    results: list[Any] = [None] * len(tasks)
    for places in _groups(tasks, scheme, output_rate_hz, step_s):
        if len(places) < fewest:
            for place in places:
                simulation = run(tasks[place], method, step_s, output_rate_hz, announce)
                results[place] = simulation if reduce is None else reduce(simulation)
            continue
        for place, simulation in _run(
            [tasks[place] for place in places], places, scheme, output_rate_hz, step_s, announce
        ):
            kept = simulation
            if simulation.outcome.status is Status.BLOW_UP and _has_others(tasks, places, place):
                # A lane has the states of all that is on in any, and one of those may be to blame.
                kept = run(tasks[place], method, step_s, output_rate_hz, announce)
            results[place] = kept if reduce is None else reduce(kept)
    return results


def _has_others(tasks: Sequence[Task], places: Sequence[int], place: int) -> bool:
    """Whether a task ran beside others with effects that it has not."""
    own = {one.name for one in tasks[place].acting}
    return any(one.name not in own for other in places for one in tasks[other].acting)


def _groups(
    tasks: Sequence[Task], method: Method, output_rate_hz: float, step_s: float | None
) -> Iterator[list[int]]:
    """Places of tasks that share their times, `LANES` at most; like effects beside each other."""
    together: dict[object, list[int]] = {}
    for place, task in enumerate(tasks):
        motion = task.driven
        times = (
            motion.start_s, motion.disturbed_s, motion.duration_s, motion.breaks_s, task.drive_kind
        )  # fmt: skip
        # A sharp switch must not slow those without it.
        longest_s = task.step_s(method) if step_s is None else step_s
        divided = steps_a_row(output_rate_hz, longest_s, join=method.inside)
        together.setdefault((times, divided), []).append(place)
    for places in together.values():
        places.sort(key=lambda place: tuple(one.name for one in tasks[place].acting))
        for first in range(0, len(places), LANES):
            yield places[first : first + LANES]


@dataclass(frozen=True)
class _Lanes:
    """The tasks of one group, the last repeated to fill the lanes."""

    tasks: list[Task]
    effects: tuple[ActiveEffect, ...]
    extras: Extras | None
    states: int


def _fill(tasks: Sequence[Task]) -> _Lanes:
    filled = [*tasks, *[tasks[-1]] * (LANES - len(tasks))]
    union = {one.name: one for task in filled for one in task.acting if one.effect.acts.in_kernel}
    effects = tuple(union[name] for name in sorted(union))
    on = np.bitwise_or.reduce([switches(task.acting) for task in filled])
    extras = pack(filled[0].machine, effects)
    return _Lanes(filled, effects, extras and extras._replace(on=on), state_count(effects))


def _run(
    tasks: Sequence[Task],
    places: Sequence[int],
    method: Method,
    output_rate_hz: float,
    step_s: float | None,
    announce: Announce | None,
) -> Iterator[tuple[int, Simulation]]:
    """One group."""
    lanes = _fill(tasks)
    first = lanes.tasks[0]
    steps = first.steps(method, output_rate_hz, step_s)
    rows = steps.output_s.size
    inside, inside_weights = rows_inside(method, steps)
    numbers = _numbers(lanes)
    state = _side_by_side([_spread(task, task.initial(steps), lanes) for task in lanes.tasks])
    jump = _side_by_side([_spread(task, task.jump(steps), lanes) for task in lanes.tasks])
    limit = _side_by_side([blow_up_limits(task.machine, lanes.states) for task in lanes.tasks])
    trajectory = np.empty((LANES, rows, lanes.states))
    blown_point = np.full(LANES, -1, dtype=np.int64)
    culprit = np.full(LANES, -1, dtype=np.int64)
    rates = np.empty((method.stage_weights.shape[0], state.size))
    trial, work = np.empty(state.size), np.empty(WORK["end"] * LANES)
    solve = lane_integrator(announce)
    solve_s = 0.0
    for part, drive in _drives(lanes, method, steps):
        began = time.perf_counter()
        last = part.stop == steps.step_s.size
        solve(
            state,
            steps.step_s[part],
            drive,
            steps.jump_point - part.start,
            jump,
            steps.first_row[part.start : part.stop + 2],
            inside,
            inside_weights,
            limit,
            method.stage_weights,
            method.step_weights,
            numbers,
            lanes.extras,
            rates,
            trial,
            work,
            trajectory,
            blown_point,
            culprit,
            part.start,
            last,
        )
        solve_s += time.perf_counter() - began
    cables = np.empty((LANES, 5, rows, CABLES))
    compiled("observe_lanes")(
        trajectory, _drive_at_outputs(lanes, steps), numbers, lanes.extras, trial, work, cables
    )
    for lane, place in enumerate(places):
        end = int(blown_point[lane]) if culprit[lane] >= 0 else steps.point_s.size
        kept = steps.rows_kept(end, int(culprit[lane]))
        taken = min(end, steps.step_s.size)
        path = Trajectory(
            time_s=steps.output_s[:kept],
            states=trajectory[lane, :kept],
            culprit=int(culprit[lane]),
            end_s=float(steps.point_s[min(end, steps.point_s.size - 1)]),
            steps_taken=taken,
            derivatives=steps.evaluations(method, taken),
            solve_s=solve_s / len(places),
        )
        own = cables[lane, :, :kept]
        yield place, as_simulation(lanes.tasks[lane], steps, path, own, method.name)


def _spread(task: Task, state: Array, lanes: _Lanes) -> Array:
    """A task's state where the lanes have it; the states of other lanes' effects start at zero."""
    found = np.append(state[:STATES], np.zeros(lanes.states - STATES))
    if task.extras is not None and lanes.extras is not None:
        for effect, own, there in zip(
            kernel_effects(), task.extras.offset, lanes.extras.offset, strict=True
        ):
            if own:
                count = CABLES * len(effect.states)
                found[there : there + count] = state[own : own + count]
    return found


def _side_by_side(columns: Sequence[Array]) -> Array:
    """Vectors of the lanes as the kernel reads them, shape (s * LANES,)."""
    return np.ascontiguousarray(np.stack(columns, axis=1).reshape(-1))


def _numbers(lanes: _Lanes) -> Array:
    """The machines and the parameters of their effects."""
    cables, platforms = [], []
    for task in lanes.tasks:
        cables.append(cable_numbers(task.machine, task.acting).reshape(-1))
        plant = task.machine.plant()
        platform = np.concatenate(
            [
                [plant.mass, plant.gravity],
                plant.inertia.reshape(-1),
                plant.inverse_inertia.reshape(-1),
                plant.drive_arm,
            ]
        )
        platforms.append(platform[: PLATFORM["end"]])
    return np.concatenate([_side_by_side(cables), _side_by_side(platforms)])


def _drives(lanes: _Lanes, method: Method, steps: Steps) -> Iterator[tuple[slice, Array]]:
    """The drives' tables, part by part: one for all lanes that share it, else each its own."""
    keys = [task.drive_key(method, steps) for task in lanes.tasks]
    different = dict(zip(keys, lanes.tasks, strict=True))
    whole = steps.step_s.size
    if len(different) == 1:
        yield slice(0, whole), lanes.tasks[0].drive_at_stages(method, steps)[..., None]
        return
    places = {key: place for place, key in enumerate(different)}
    drive_of_lane = [places[key] for key in keys]
    for first in range(0, whole, CHUNK_STEPS):
        part = slice(first, min(first + CHUNK_STEPS, whole))
        point_s = steps.point_s[part.start : part.stop + 1]
        tables = [task.drive_of_steps(method, point_s) for task in different.values()]
        yield part, np.stack([tables[place] for place in drive_of_lane], axis=-1)


def _drive_at_outputs(lanes: _Lanes, steps: Steps) -> Array:
    tables = [task.drive_at_outputs(steps) for task in lanes.tasks]
    return np.ascontiguousarray(np.stack(tables, axis=-1))


def jacobian(
    task_of: Callable[[Array], Task],
    point: Array,
    output: Callable[[Simulation], Array],
    step: Array,
    **how: Any,
) -> tuple[Array, Array]:
    """Central differences, all their simulations side by side.

    A fixed-step method is a smooth map of its parameters, and so steps of 1e-6 of a parameter give
    seven digits (notes/solver.md); slack cables and sharp switches cost some of them.

    Parameters
    ----------
    task_of
        Makes a task of parameters, shape (p,).
    point
        Where, shape (p,).
    output
        What is differentiated, shape (m,).
    step
        Half the distance between the two sides, for each parameter, shape (p,).
    how
        As for `simulate_many`.

    Returns
    -------
    value, jacobian
        The output at the point, shape (m,), and its derivatives, shape (m, p).
    """
    point, step = np.asarray(point, dtype=float), np.asarray(step, dtype=float)
    sides = [point + sign * row for row in np.diag(step) for sign in (1.0, -1.0)]
    how.setdefault("step_s", task_of(point).step_s(find_method(how.get("method", "dop853"))))
    value, *ends = simulate_many([task_of(at) for at in (point, *sides)], output, **how)
    pairs = zip(ends[::2], ends[1::2], step, strict=True)
    columns = [(up - down) / (2.0 * half) for up, down, half in pairs]
    return value, np.stack(columns, axis=-1)
