"""Nodes that fail in mid-run: the others keep their rate, and none is trusted before it is set."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import (
    WavePlatform,
    all_true,
    at_origin,
    motion,
    rig_text,
    virtual_clock,
    with_bus,
)

from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run, load_run
from rig.ending import Recording
from rig.quarantine import Quarantine
from rig.recorder import record
from rig.simulated.node import RESTART_S, SimulatedNode
from rig.simulated.rig import assemble

SWEEPS_PER_S = {"polled": 131.0, "broadcast": 107.0}
"""Of eight amplifiers at 115200 baud, 6 bytes a value (protocol note, section 9)."""


@pytest.fixture(params=SWEEPS_PER_S)
def rig(rig: Rig, request: pytest.FixtureRequest) -> Rig:
    """Both kinds of sweep."""
    return with_bus(rig, sweep=request.param)


Trouble = Callable[[SimulatedNode, float], None]


def record_with_trouble(
    rig: Rig, tmp_path: Path, trouble: Trouble, duration_s: float = 10.0
) -> tuple[Recording, Run]:
    """A recording during which `trouble(node, t_s)` is asked before each request."""
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    far_end = machine.transport._far_end
    origin: list[float] = []
    hear = far_end.hear

    def hear_with_trouble(data: bytes, start_s: float) -> None:
        if origin:
            for node in far_end.nodes:
                trouble(node, start_s - origin[0])
        hear(data, start_s)

    at_origin(machine, origin.append)
    far_end.hear = hear_with_trouble
    folder = tmp_path / "run"
    recording = record(
        rig, rig_text(), folder, excitation=motion(duration_s), clock=clock, machine=machine
    )
    return recording, load_run(folder)


def test_a_dead_node_leaves_the_others_their_rate(rig: Rig, tmp_path: Path) -> None:
    def die(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 3 and t_s > 1.0:
            node.powered = False

    recording, run = record_with_trouble(rig, tmp_path, die)
    for cable in (1, 2, 4, 5, 6, 7, 8):
        times = run.cable_tension(cable)["t_s"]
        after = times[times > 1.0]
        assert len(after) / 9.0 >= 0.9 * SWEEPS_PER_S[rig.bus.sweep]
    assert run.cable_tension(3)["t_s"].max() < 1.01
    lost = run.events[run.events["kind"] == "node_lost"]
    assert lost["cable"].tolist() == [3]
    assert 1.0 < lost["t_s"].iloc[0] < 1.3
    assert recording.stop.lost["node_lost"] == 1


def test_a_node_that_comes_back_is_recorded_again(rig: Rig, tmp_path: Path) -> None:
    def nap(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 5:
            node.powered = not 1.0 < t_s < 2.5

    _, run = record_with_trouble(rig, tmp_path, nap, 6.0)
    assert run.events["kind"].tolist().count("node_back") == 1
    gap = run.events[run.events["kind"] == "gap"].iloc[0]
    times = run.cable_tension(5)["t_s"].to_numpy()
    assert np.diff(times).max() == pytest.approx(gap["t_s"] - 1.0, abs=0.05)
    assert times.max() > 5.9
    assert all_true(run)


def test_a_node_reset_in_mid_run_is_set_up_again_before_it_is_trusted(
    rig: Rig, tmp_path: Path
) -> None:
    done = []

    def reset(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 2 and t_s > 1.0 and not done:
            done.append(t_s)
            node.settings["TAV"] = 123456
            node.power_on(0.0)
            node.settings["TAS"] = 0
            node.settings["TAV"] = 123456

    _, run = record_with_trouble(rig, tmp_path, reset, 5.0)
    assert {"node_lost", "node_back", "gap"} <= set(run.events["kind"])
    assert run.cable_tension(2)["t_s"].max() > 4.9
    assert all_true(run)


def test_a_node_fallen_back_to_factory_settings_is_lost_and_never_misread(
    rig: Rig, tmp_path: Path
) -> None:
    done = []

    def brown_out(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 6 and t_s > 1.0 and not done:
            done.append(t_s)
            node.brown_out(t_s)

    _, run = record_with_trouble(rig, tmp_path, brown_out, 4.0)
    assert run.events["kind"].tolist().count("node_lost") == 1
    assert run.cable_tension(6)["t_s"].max() < 1.02
    assert run.cable_tension(7)["t_s"].max() > 3.9
    assert all_true(run)


def test_a_node_restarted_with_other_settings_in_the_same_format_is_set_before_it_is_trusted(
    rig: Rig, tmp_path: Path
) -> None:
    # Its EEPROM has the run's format, and a filter and a net output that are not the run's.
    done = []

    def restart(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 4 and t_s > 1.0 and not done:
            done.append(t_s)
            node._eeprom = node.settings | {"ASF": 5, "TAS": 0, "TAV": 123456}
            node.power_on(node.signal._origin_s + t_s + RESTART_S)

    _, run = record_with_trouble(rig, tmp_path, restart, 6.0)
    assert run.events["kind"].tolist().count("node_back") == 1
    assert run.cable_tension(4)["t_s"].max() > 5.9
    assert all_true(run)


def test_one_restarted_with_a_curve_of_its_own_stays_lost(rig: Rig, tmp_path: Path) -> None:
    done = []

    def restart(node: SimulatedNode, t_s: float) -> None:
        if node.settings["ADR"] == 4 and t_s > 1.0 and not done:
            done.append(t_s)
            node._eeprom = node.settings | {"LWT": 500_000}
            node.power_on(node.signal._origin_s + t_s + RESTART_S)

    _, run = record_with_trouble(rig, tmp_path, restart, 6.0)
    assert "node_back" not in set(run.events["kind"])
    assert run.cable_tension(4)["t_s"].max() < 1.1
    assert all_true(run)


def test_lost_nodes_are_tried_less_and_less_often() -> None:
    quarantine = Quarantine()
    assert [quarantine.failed(3, 10.0) for _ in range(3)] == [False, False, True]
    tries, now_s = [], 10.0
    while now_s < 45.0:
        if quarantine.due(3, now_s):
            tries.append(round(now_s, 2))
            quarantine.still_lost(3, now_s)
        now_s += 0.01
    assert np.diff([10.0, *tries]) == pytest.approx([1.0, 2.0, 5.0, 10.0, 10.0], abs=0.02)
    assert quarantine.back(3) == 10.0
    assert not quarantine.holds(3)


def test_an_answer_forgives_failures() -> None:
    quarantine = Quarantine()
    for _ in range(5):
        assert not quarantine.failed(1, 0.0)
        assert not quarantine.failed(1, 0.0)
        quarantine.answered(1)
