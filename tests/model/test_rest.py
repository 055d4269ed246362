"""A machine that differs from its drive's hangs still before the motion, whatever its cables do."""

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import ActiveEffect, Simulation, Task, simulate_many
from model.kernel import STATES
from model.library.discovery import kernel_effects
from model.simulator import run

QUIET = Excitation(rest_s=0.6, motion_s=0.3, ramp_s=0.1, cable_offset_m=0.0)
TIGHTER = ActiveEffect("pretension", {"pretension_offset_n": (0.0, 1.0, *[0.0] * 6)})
GROWING = ("cable_creep",)
"""What goes on for as long as a load lasts."""

STILL_N = 2e-6


def moved_n(simulation: Simulation) -> float:
    before = simulation.tension_n[simulation.t_s < QUIET.rest_s - 0.01]
    return float(np.abs(before - before[0]).max())


def with_effect(rig: Rig, name: str) -> Task:
    return Task(rig, QUIET, effects=[TIGHTER, ActiveEffect(name)], nominal=rig)


@pytest.mark.parametrize(
    "name", [one.name for one in kernel_effects() if one.name not in ("pretension", *GROWING)]
)
def test_it_hangs_still_with_each_effect(rig: Rig, name: str) -> None:
    alone = run(with_effect(rig, name))
    assert abs(alone.rest_tension_n[1] - rig.cable[1].pretension_n.value) > 0.02
    assert moved_n(alone) < STILL_N


@pytest.mark.parametrize(
    "effect",
    [
        ActiveEffect("anchor_play", {"play_m": 7e-6, "hold_n": 0.5}),
        *(ActiveEffect(one.name) for one in kernel_effects() if one.name != "pretension"),
    ],
    ids=lambda one: one.name,
)
def test_a_machine_that_is_hardly_another_moves_hardly_otherwise(
    rig: Rig, effect: ActiveEffect
) -> None:
    # Differences tell a fit where to go: hooks at their stops, or bristles, must not jump.
    moved = QUIET.model_copy(update={"motion_s": 0.6})
    found = []
    for more_n in (0.0, 1e-9, 1e-6):
        offsets = (0.0, 1.0 + more_n, 0.0, -2.0, 0.0, 0.0, 0.3, 0.0)
        tighter = ActiveEffect("pretension", {"pretension_offset_n": offsets})
        heavier = ActiveEffect("mass", {"mass_share": 0.02})
        task = Task(rig, moved, effects=[effect, tighter, heavier], nominal=rig)
        found.append(run(task).tension_n)
    assert np.abs(found[1] - found[0]).max() < 1e-8
    assert np.abs(found[2] - found[0]).max() < 1e-5


def test_lanes_of_several_effects_hang_still_each(rig: Rig) -> None:
    names = ("cable_structural", "frame_compliance", "umbilical", "cable_relaxation")
    for one in simulate_many([with_effect(rig, name) for name in names], fewest=1):
        assert moved_n(one) < STILL_N


def test_a_dashpot_that_had_not_come_to_rest_would_be_seen(rig: Rig) -> None:
    task = with_effect(rig, "cable_structural")
    before = task._at_rest
    before[STATES:] = 0.0
    assert moved_n(run(task)) > 1e3 * STILL_N


def test_whoever_trimmed_the_platform_left_it_where_the_rig_file_has_it(rig: Rig) -> None:
    off = [
        ActiveEffect("mass", {"mass_share": 0.2}),
        ActiveEffect("centre_of_mass", {"centre_x_m": 0.01}),
    ]
    for trimmed in (0.0, 1.0):
        trim = {"pretension_offset_n": 0.0, "trimmed_share": trimmed}
        alone = run(Task(rig, QUIET, effects=[*off, ActiveEffect("pretension", trim)], nominal=rig))
        # The centre of mass itself is where it is.
        hangs_m = float(np.abs(alone.pose[0, :3]).max())
        assert moved_n(alone) < STILL_N
        assert (hangs_m < 1e-8) == bool(trimmed)
