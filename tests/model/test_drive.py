"""The ideal drive: the nominal platform follows X*, whatever the axis and the rig file's rest."""

import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import Machine, simulate
from model.drive import required_drive
from model.effects import ActiveEffect

QUIET = {"platform_offset_m": (0.0, 0.0, 0.0), "cable_offset_m": 0.0}


def motion(**changes: object) -> Excitation:
    values = {"rest_s": 0.2, "motion_s": 2.0, "ramp_s": 0.3, **QUIET, **changes}
    return Excitation.model_validate(values)


@pytest.mark.parametrize("axis", ["roll", "pitch", "yaw"])
@pytest.mark.parametrize("ramp_s", [0.0, 0.3])
def test_the_nominal_platform_follows_the_command_to_rounding(
    rig: Rig, axis: str, ramp_s: float
) -> None:
    # Without a fall of the amplitude X* stops dead at the end, and no platform follows that.
    course = motion(axis=axis, ramp_s=ramp_s, amplitude_deg=8.0, frequency_hz=3.0)
    run = simulate(rig, course, step_s=1e-3)
    followed = run.t_s <= run.steady_window_s[1]
    assert np.abs(run.commanded_pose).max() > np.deg2rad(7.5)
    assert np.abs(run.pose - run.commanded_pose)[followed].max() < 1e-10


def test_large_motion_that_slackens_a_cable_is_still_followed(rig: Rig) -> None:
    # The nominal cables of the drive cannot push either.
    run = simulate(rig, motion(amplitude_deg=12.0, frequency_hz=1.0))
    assert run.outcome.status == "slack"
    assert np.abs(run.pose - run.commanded_pose).max() < 1e-7


def test_a_drive_that_reckons_with_cables_that_push_sets_its_platform_ringing(rig: Rig) -> None:
    course = motion(amplitude_deg=12.0, frequency_hz=1.0)
    reckons = ActiveEffect("cable_slack", {"slack_m": 1e-9, "drive_pushes": 1.0})
    knows = ActiveEffect("cable_slack", {"slack_m": 1e-9, "drive_pushes": 0.0})
    rings, follows = (simulate(rig, course, effects=(one,)) for one in (reckons, knows))
    before = np.cumsum(rings.tension_n.min(axis=1) < 1e-3) == 0
    off = np.abs(rings.pose - rings.commanded_pose).max(axis=1)
    assert off[before].max() < 1e-7, "until a cable is slack both drives ask for the same"
    assert off.max() > 1e-3
    assert np.abs(follows.pose - follows.commanded_pose).max() < 0.01 * off.max()


def test_the_drive_absorbs_what_the_rig_file_leaves_of_static_equilibrium(rig: Rig) -> None:
    cable = rig.cable[0]
    tighter = cable.pretension_n.model_copy(update={"value": cable.pretension_n.value + 0.2})
    off_balance = rig.model_copy(
        update={"cable": (cable.model_copy(update={"pretension_n": tighter}), *rig.cable[1:])}
    )
    still = np.zeros((1, 6))
    wrench = required_drive(Machine.from_rig(off_balance), still, still, still)
    assert np.linalg.norm(wrench[0, :3]) == pytest.approx(0.2, rel=0.02)
    run = simulate(off_balance, motion(amplitude_deg=0.0))
    assert np.abs(run.pose).max() < 1e-13
    assert run.rest_tension_n[0] == pytest.approx(cable.pretension_n.value + 0.2, abs=1e-9)


def test_a_plant_that_differs_from_the_nominal_machine_leaves_the_command(rig: Rig) -> None:
    mass = rig.platform.mass_kg
    heavier = rig.model_copy(
        update={
            "platform": rig.platform.model_copy(
                update={"mass_kg": mass.model_copy(update={"value": 1.02 * mass.value})}
            )
        }
    )
    same = simulate(heavier, motion())
    frozen = simulate(heavier, motion(), nominal=rig)
    assert np.abs(same.pose - same.commanded_pose).max() < 1e-11
    assert frozen.pose[:, 2].min() < -1e-5, "the drive was not made for the added weight"
