"""The plant: a true machine with its hidden physics, moved by a frozen drive."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.plant import layout as at
from analysis.challenge.plant.drive import AXES, SOUND, DriveFault, course, frozen_wrench
from analysis.challenge.plant.engine import Body, compiled_loop, free_body
from analysis.challenge.plant.machine import Machine, Offset
from analysis.challenge.plant.pulley import wrapped
from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]

STEP_S = 1.25e-4
"""Step of the integration, s: a tone of 20 Hz is out of phase by 0.0013 rad after a second."""

FINE_STEP_S = STEP_S / 4.0
"""What is recorded is integrated by this: its ring may be a thousand times the noise, and with four
times this step parameters have to make up for 0.8 of it, rms."""

SETTLING = 18.0
"""How many times the softest tone's radian the platform is given to find its rest."""


NO_JUMP = np.zeros(10)


@dataclass(frozen=True)
class Hidden:
    """Physics of the plant beyond the paper's.

    Parameters
    ----------
    cables
        Rows of numbers to set, by their place in `layout`: place -> eight values.
    platform
        Numbers of platform and frame to set: place -> value.
    drive
        What the drive does to the motion.
    """

    cables: dict[int, Array] = field(default_factory=dict)
    platform: dict[int, float] = field(default_factory=dict)
    drive: DriveFault = SOUND

    def joined(self, other: "Hidden") -> "Hidden":
        """Both together; of one drive's faults those that are set."""
        faults = {
            name: value
            for name, value in vars(other.drive).items()
            if value != getattr(SOUND, name)
        }
        return Hidden(
            self.cables | other.cables,
            self.platform | other.platform,
            replace(self.drive, **faults),
        )


NOTHING = Hidden()


@dataclass(frozen=True)
class Course:
    """What happened, at every step.

    Parameters
    ----------
    t_s
        Shape (n,), s.
    tension_n
        At the cells, shape (n, 8), N.
    pose
        X, Y, Z of the centre of mass (the rig file's) in m, roll, pitch, yaw in rad; shape (n, 6).

    From where a machine came apart both are not-a-number.
    """

    t_s: Array
    tension_n: Array
    pose: Array


def simulate(
    rig: Rig,
    excitation: Excitation,
    offset: Offset | None = None,
    hidden: Hidden = NOTHING,
    step_s: float = STEP_S,
) -> Course:
    """Let the true machine hang at rest, then drive it.

    Parameters
    ----------
    rig
        As written down: the drive is made for it.
    excitation
        The motion asked for, and the disturbances that act when it starts.
    offset
        True machine less the rig file.
    hidden
        Further physics.
    step_s
        Step, s; rest and motion are whole multiples of it.
    """
    nominal = Machine.from_rig(rig)
    offset = Offset.none() if offset is None else offset
    true = offset.applied(nominal)
    time_s = np.asarray(np.arange(round(excitation.duration_s / step_s) + 1) * step_s, dtype=float)
    drive = frozen_wrench(nominal, excitation, course(excitation, hidden.drive, time_s))
    cables, platform = _numbers(true, hidden)
    plant = _Plant(
        free_body(true.mass, true.inertia, true.gravity, step_s),
        cables,
        np.zeros((len(cables), at.CABLE_STATES)),
        platform,
        np.zeros((at.POSTS, 6)),
        true.post_of,
        step_s,
    )
    _settle(plant, true, drive[0])
    pose, cell = plant.moved(drive, *_jump(excitation, hidden.drive, step_s))
    return Course(time_s, cell, _as_tracked(pose, offset.centre_m))


@dataclass(frozen=True)
class _Plant:
    """The body and the arrays that the compiled laws read and write.

    `posts` is the give of each post of the frame and its rate, shape (4, 6), m and m/s.
    """

    body: Body
    cables: Array
    states: Array
    platform: Array
    posts: Array
    post_of: NDArray[np.int64]
    step_s: float

    def moved(self, drive: Array, jump_at: int, jump: Array) -> tuple[Array, Array]:
        """Step through a drive; returns poses and tensions at the cells, at each step."""
        pose, cell = np.empty((len(drive), 6)), np.empty((len(drive), len(self.cables)))
        data = self.body.data
        model, inside = self.body.addresses
        compiled_loop()(
            model,
            inside,
            data.qpos,
            data.qvel,
            data.xfrc_applied[1],
            self.cables,
            self.states,
            self.platform,
            self.post_of,
            self.posts,
            drive,
            jump_at,
            jump,
            self.step_s,
            pose,
            cell,
        )
        return pose, cell


def _numbers(true: Machine, hidden: Hidden) -> tuple[Array, Array]:
    """The machine and its hidden physics as the compiled laws read them."""
    length, direction = true.lines
    cables = np.zeros((len(length), at.CABLE_NUMBERS))
    cables[:, at.BASE : at.BASE + 3] = true.base
    cables[:, at.ANCHOR : at.ANCHOR + 3] = true.anchor
    cables[:, at.REST_PATH] = length
    cables[:, at.STIFFNESS] = true.stiffness
    cables[:, at.PRETENSION] = true.pretension
    cables[:, at.DENSITY] = true.line_density
    cables[:, at.STRING_LOSS] = true.string_loss
    cables[:, at.REST_DIRECTION : at.REST_DIRECTION + 3] = direction
    cables[:, at.BEHIND] = true.cell_behind
    for place, values in hidden.cables.items():
        cables[:, place] = values
    for row in cables:
        if row[at.RADIUS] > 0.0:
            start, end = row[at.ANCHOR : at.ANCHOR + 3], row[at.BASE : at.BASE + 3]
            row[at.REST_PATH] = wrapped(start, end, row[at.RADIUS])[0]
    platform = np.zeros(at.PLATFORM_NUMBERS)
    platform[at.MASS], platform[at.GRAVITY] = true.mass, true.gravity
    for place, value in hidden.platform.items():
        platform[place] = value
    return cables, platform


LOSSY = (
    at.VISCOUS, at.RELAX, at.RELAX + 1, at.LOSS_FACTOR, at.LOOP, at.CREEP, at.PLAY, at.RIM,
    at.COULOMB, at.CAPSTAN, at.MODES, at.SHAKEN,
)  # fmt: skip
"""What takes no part while the platform finds its rest."""


def _settle(plant: _Plant, true: Machine, drive: Array) -> None:
    """Hang still: heavy dampers take the platform to rest, then its speed is set to zero."""
    calm, damped = plant.cables.copy(), plant.platform.copy()
    calm[:, LOSSY] = 0.0
    softest, stiffest = true.softest_and_stiffest_rad_per_s
    pace = np.sqrt(softest * stiffest)
    damped[at.DRAG_LINEAR] = 1.4 * pace * true.mass
    damped[at.DRAG_TURNING] = 1.4 * pace * np.linalg.eigvalsh(true.inertia)[1]
    damped[at.FRAME_LOSS] = 1.0
    steps = int(SETTLING / softest * max(1.0, pace / softest) / plant.step_s)
    replace(plant, cables=calm, platform=damped).moved(np.tile(drive, (steps, 1)), -1, NO_JUMP)
    plant.body.data.qvel[:] = 0.0
    plant.posts[:, 3:] = 0.0


def _jump(excitation: Excitation, fault: DriveFault, step_s: float) -> tuple[int, Array]:
    """At which step the motion starts, and what the state gains then."""
    jump = NO_JUMP.copy()
    jump[:3] = excitation.platform_offset_m
    jump[9] = excitation.cable_offset_m
    start = round((excitation.start_s + fault.late_s) / step_s)
    if excitation.ramp_s == 0.0:
        ahead = np.asarray(start * step_s + 2e-4 * np.arange(15) + 1e-9)
        angle = course(excitation, fault, ahead)
        axis = AXES.index(excitation.axis)
        jump[6 + axis] = angle[1][1] - (ahead[1] - ahead[0]) * angle[2][1]
    return start, jump


def _as_tracked(pose: Array, centre_m: Array) -> Array:
    """The pose of the point that the rig file takes for the centre of mass."""
    if not np.any(centre_m):
        return pose
    sine, cosine = np.sin(pose[:, 3:]).T, np.cos(pose[:, 3:]).T
    x, y, z = centre_m
    y, z = cosine[0] * y - sine[0] * z, sine[0] * y + cosine[0] * z
    x, z = cosine[1] * x + sine[1] * z, cosine[1] * z - sine[1] * x
    x, y = cosine[2] * x - sine[2] * y, sine[2] * x + cosine[2] * y
    tracked = pose.copy()
    tracked[:, :3] += centre_m - np.stack([x, y, z], axis=1)
    return tracked
