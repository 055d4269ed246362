"""Agreement with another engine: MuJoCo's rigid platform on eight spatial tendons.

It is driven by the same wrench and carries no cable vibration, and so neither do we.
"""

import mujoco
import numpy as np
import pytest

from cdpr8.rigfile import Excitation, Rig
from model import Machine, Simulation, simulate
from model.method import find_method
from model.task import Task

STEP_S = 1e-3


def written(numbers) -> str:
    return " ".join(repr(float(number)) for number in numbers)


def tendon_model(machine: Machine, step_s: float = STEP_S) -> mujoco.MjModel:
    """The platform with eight tendons as springs whose force at rest is the pretension."""
    inertia = machine.inertia
    full = [
        inertia[0, 0],
        inertia[1, 1],
        inertia[2, 2],
        inertia[0, 1],
        inertia[0, 2],
        inertia[1, 2],
    ]
    sites, anchors, tendons = [], [], []
    for i in range(machine.cables):
        base, anchor = written(machine.base[i]), written(machine.anchor[i])
        sites.append(f'<site name="b{i}" pos="{base}"/>')
        anchors.append(f'<site name="a{i}" pos="{anchor}"/>')
        unstretched = machine.rest_length[i] - machine.pretension[i] / machine.stiffness[i]
        tendons.append(
            f'<spatial stiffness="{float(machine.stiffness[i])!r}"'
            f' springlength="0 {float(unstretched)!r}">'
            f'<site site="b{i}"/><site site="a{i}"/></spatial>'
        )
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco>
        <option timestep="{step_s}" integrator="RK4" gravity="0 0 {-machine.gravity!r}"/>
        <worldbody>{"".join(sites)}
          <body name="platform"><freejoint/>
            <inertial pos="0 0 0" mass="{machine.mass!r}" fullinertia="{written(full)}"/>
            {"".join(anchors)}
          </body>
        </worldbody>
        <tendon>{"".join(tendons)}</tendon>
        </mujoco>"""
    )


def angles_of(quaternion: np.ndarray) -> np.ndarray:
    """Roll, pitch and yaw of Rz Ry Rx."""
    w, x, y, z = quaternion
    return np.array(
        [
            np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
            np.arcsin(2 * (w * y - z * x)),
            np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        ]
    )


def tendon_run(
    machine: Machine,
    wrench: np.ndarray,
    pose: np.ndarray,
    rate: np.ndarray,
    step_s: float = STEP_S,
) -> tuple[np.ndarray, np.ndarray]:
    """Poses and tensions at every step; the wrench is held over a step, at its middle's value."""
    model = tendon_model(machine, step_s)
    data = mujoco.MjData(model)
    data.qpos[:3], data.qpos[3:] = pose[:3], [1.0, 0.0, 0.0, 0.0]
    roll, pitch, yaw = pose[3:]
    mujoco.mju_euler2Quat(data.qpos[3:], np.array([yaw, pitch, roll]), "ZYX".lower())
    data.qvel[:3] = rate[:3]
    # MuJoCo turns in the body's frame: E of Euler's equations.
    to_body = np.array(
        [
            [1, 0, -np.sin(pitch)],
            [0, np.cos(roll), np.sin(roll) * np.cos(pitch)],
            [0, -np.sin(roll), np.cos(roll) * np.cos(pitch)],
        ]
    )
    data.qvel[3:] = to_body @ rate[3:]
    poses, tensions = [], []
    for row in range(len(wrench) + 1):
        mujoco.mj_forward(model, data)
        poses.append(np.concatenate([data.qpos[:3], angles_of(data.qpos[3:])]))
        stretch = data.ten_length - model.tendon_lengthspring[:, 1]
        tensions.append(machine.stiffness * np.maximum(stretch, 0.0))
        if row < len(wrench):
            data.xfrc_applied[1] = wrench[row]
            mujoco.mj_step(model, data)
    return np.array(poses), np.array(tensions)


def agree(ours: Simulation, poses: np.ndarray, tensions: np.ndarray, rows: slice) -> None:
    """To 1e-4 of the largest movement, of angles, positions and tension variations."""
    for mine, theirs in (
        (ours.pose[rows, 3:], poses[:, 3:]),
        (ours.tension_n[rows], tensions),
    ):
        size = np.abs(mine - mine.mean(axis=0)).max()
        assert np.abs(mine - theirs).max() < 1e-4 * size
    size = max(np.abs(ours.pose[rows, :3]).max(), 1e-3)
    assert np.abs(ours.pose[rows, :3] - poses[:, :3]).max() < 1e-4 * size


def middle_wrench(rig: Rig, excitation: Excitation, step_s: float) -> np.ndarray:
    """The drive in the middle of MuJoCo's steps."""
    task = Task(rig, excitation, effects=())
    steps = task.steps(find_method("rk4"), 1.0 / step_s, step_s)
    return task.drive_at(steps.middle_s, steps.middle_s)[:, 0]


def test_the_paper_case_without_vibration(rig: Rig, paper: Excitation) -> None:
    excitation = paper.model_copy(update={"motion_s": 3.0})
    ours = simulate(rig, excitation, excitation_effect=False, effects=())
    step_s = 2.5e-4
    wrench = middle_wrench(rig, excitation, step_s)
    poses, tensions = tendon_run(
        Machine.from_rig(rig), wrench, ours.pose[0], ours.pose_rate[0], step_s
    )
    agree(ours, poses[::4], tensions[::4], slice(None))
    assert np.rad2deg(np.abs(poses[:, 4]).max()) == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize(
    ("pose", "rate"),
    [
        ([3e-3, -2e-3, 2e-3, 0.01, 0.015, -0.01], [0, 0, 0, 0, 0, 0]),
        ([2e-3, 1e-3, -1e-3, 0.008, -0.008, 0.01], [0.1, -0.1, 0.1, 0.3, 0.4, -0.3]),
    ],
    ids=["free decay", "large motion of all six axes"],
)
def test_a_released_platform(rig: Rig, pose: list[float], rate: list[float]) -> None:
    from model.extras import pack
    from model.trajectory import integrate

    machine = Machine.from_rig(rig)
    still = Excitation(amplitude_deg=0.0, rest_s=0.0, motion_s=2.0, ramp_s=0.0)
    task, method = Task(rig, still, effects=(), excitation_effect=False), find_method("dop853")
    steps = task.steps(method, 1000.0, 1e-3)
    state = np.zeros(28)
    state[:6], state[6:12] = pose, rate
    path = integrate(
        machine,
        method,
        steps,
        task.drive_at_stages(method, steps),
        state,
        np.zeros(28),
        pack(machine, ()),
    )
    step_s = 2.5e-4
    wrench = np.repeat(task.drive_at_stages(method, steps)[:1, 0], 8000, axis=0)
    poses, tensions = tendon_run(
        machine, wrench, np.array(pose, float), np.array(rate, float), step_s
    )
    assert tensions.min() > 0.5, "a cable that goes slack is a kink to either engine"
    difference = np.abs(path.states[:, :6] - poses[::4])
    for axes in (slice(0, 3), slice(3, 6)):
        assert difference[:, axes].max() < 1e-4 * np.abs(poses[:, axes]).max()
