"""The platform behind the simulated rig: the model's machine, and friction that the model lacks."""

import time
from functools import partial

import numpy as np
import pytest

from cdpr8.errors import UsageError
from cdpr8.rigfile import Excitation, Rig, load_rig, packaged_rig_path
from model import simulate
from rig.simulated import ahead
from rig.simulated.plant import PlatformSimulation, PlatformTrajectory, simulate_platform

MOTION = Excitation(motion_s=3.0, rest_s=0.5)
FRICTION_N = 0.3


@pytest.fixture(scope="module")
def rig() -> Rig:
    return load_rig(packaged_rig_path())


@pytest.fixture(scope="module")
def rubbing(rig: Rig) -> PlatformTrajectory:
    return simulate_platform(rig, MOTION, np.full(8, FRICTION_N))


def test_without_friction_it_is_the_models_machine(rig: Rig) -> None:
    own = simulate_platform(rig, MOTION, np.zeros(8))
    model = simulate(rig, MOTION, method="rk4")  # the same method: rounding is all that is left
    assert np.abs(own.pose - model.pose).max() < 1e-12
    assert np.abs(own.tension_n - model.tension_n).max() < 1e-9


def test_friction_stands_between_the_elastic_and_the_measured_tension(
    rig: Rig, rubbing: PlatformTrajectory
) -> None:
    base = np.array([cable.base_m.value for cable in rig.cable])
    anchor = np.array([cable.anchor_m.value for cable in rig.cable])
    pitch, position = rubbing.pose[:, 4], rubbing.pose[:, :3]
    turned = np.stack(
        [
            np.cos(pitch)[:, None] * anchor[:, 0] + np.sin(pitch)[:, None] * anchor[:, 2],
            np.broadcast_to(anchor[:, 1], (len(pitch), 8)),
            -np.sin(pitch)[:, None] * anchor[:, 0] + np.cos(pitch)[:, None] * anchor[:, 2],
        ],
        axis=-1,
    )
    length = np.linalg.norm(base - position[:, None] - turned, axis=-1)
    stiffness = np.array([cable.stiffness_n_per_m.value for cable in rig.cable])
    pretension = np.array([cable.pretension_n.value for cable in rig.cable])
    rest = np.linalg.norm(base - anchor, axis=1)
    friction = rubbing.tension_n - pretension - stiffness * (length - rest)
    rate = np.gradient(length[:, 0], rubbing.t_s)
    # Past the start, where the initial disturbance moves the platform and not the bristles.
    moving = (np.abs(rate) > 0.02) & (rubbing.t_s > MOTION.start_s + 0.1)
    # Bristle damping is a hundredth of the friction at these rates.
    assert np.allclose(friction[moving, 0], FRICTION_N * np.sign(rate[moving]), atol=0.03)


def test_friction_lowers_the_amplitude(rig: Rig, rubbing: PlatformTrajectory) -> None:
    free = simulate_platform(rig, MOTION, np.zeros(8))
    assert np.abs(rubbing.pose[:, 4]).max() < 0.97 * np.abs(free.pose[:, 4]).max()


def test_left_and_right_cables_of_a_symmetric_machine_move_alike(
    rubbing: PlatformTrajectory,
) -> None:
    for left, right in ((1, 2), (4, 3), (5, 8), (6, 7)):
        assert np.allclose(
            rubbing.tension_n[:, left - 1], rubbing.tension_n[:, right - 1], atol=1e-9
        )


def test_a_motion_out_of_the_workspace_is_refused(rig: Rig) -> None:
    wild = Excitation(platform_offset_m=(0.6, 0.0, 0.0), motion_s=3.0)
    with pytest.raises(UsageError, match="leaves its workspace"):
        simulate_platform(rig, wild, np.zeros(8))


def test_a_long_run_is_simulated_as_it_goes_on(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, seconds in (("FIRST_S", 0.2), ("AHEAD_S", 0.3), ("KEPT_S", 0.4)):
        monkeypatch.setattr(ahead, name, seconds)
    whole = simulate_platform(rig, MOTION)
    simulation = PlatformSimulation(rig, MOTION)
    monkeypatch.setattr(simulation, "advance", partial(simulation.advance, 0.1))
    platform = ahead.AheadPlatform(simulation)
    assert not simulation.over
    for t_s in np.arange(0.0, MOTION.duration_s + 0.5, 0.05):
        times = np.array([max(0.0, t_s - 0.3), t_s])
        assert np.abs(platform.pose_at(times) - whole.pose_at(times)).max() < 1e-12
        tension = platform.tension_at(3, times)
        assert np.abs(tension - whole.tension_at(3, times)).max() < 1e-9
    assert simulation.over
    with pytest.raises(ValueError, match="is forgotten"):
        platform.tension_at(3, np.array([0.1]))


def test_what_lies_behind_is_kept_however_long_the_next_question_takes(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, seconds in (("FIRST_S", 0.2), ("AHEAD_S", 0.3), ("KEPT_S", 0.1)):
        monkeypatch.setattr(ahead, name, seconds)
    simulation = PlatformSimulation(rig, MOTION)
    monkeypatch.setattr(simulation, "advance", partial(simulation.advance, 0.1))
    platform = ahead.AheadPlatform(simulation)
    for t_s in (0.15, 0.21, 0.25):  # each wakes the thread, which has time to go on
        platform.pose_at(np.array([t_s]))
        time.sleep(0.2)
    platform.pose_at(np.array([0.15, 0.25]))
    assert not simulation.over


def test_a_platform_that_is_thrown_out_late_stays_where_it_was(rig: Rig) -> None:
    class Lost:
        over, pieces = False, 0

        def advance(self) -> PlatformTrajectory:
            self.pieces += 1
            if self.pieces > 1:
                raise UsageError("leaves its workspace")
            ones = np.ones(2)
            return PlatformTrajectory(
                np.array([0.0, ahead.FIRST_S]), np.outer(ones, np.ones(6)), np.ones((2, 8))
            )

    platform = ahead.AheadPlatform(Lost())
    assert platform.tension_at(1, np.array([ahead.FIRST_S + 5.0])) == 1.0
