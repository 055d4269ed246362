"""The plant: a true machine with its hidden physics, moved by a frozen drive."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.drive import SOUND, DriveFault, angle, frozen_wrench
from analysis.challenge.outsider.integrate import follow
from analysis.challenge.outsider.machine import Machine, Offset
from analysis.challenge.outsider.rigid_body import GRAVITY
from cdpr8.rigfile import Excitation, Rig

Array = NDArray[np.float64]

STEP_S = 5e-5
"""Of the integration of what is recorded, s; half of it changes no tension by 1e-6 N."""

OUTPUT_S = 5e-4
"""Between two rows of what is kept, s."""

POST_OF = (0, 1, 2, 3, 0, 3, 2, 1)
"""The post of each cable: 1 and 5, 2 and 8, 3 and 7, 4 and 6 share one."""

MORE_MOMENTS = 3
"""The drive is known for this many half steps beyond the end."""


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
    weight_share
        Transverse weight of each cable that sags, relative, shape (8,).
    bristles
        How far the bristles are bent at rest, in shares of full slip, shape (8,).
    """

    cables: dict[int, Array] = field(default_factory=dict)
    platform: dict[int, float] = field(default_factory=dict)
    drive: DriveFault = SOUND
    weight_share: Array = field(default_factory=lambda: np.zeros(8))
    bristles: Array = field(default_factory=lambda: np.zeros(8))

    def joined(self, other: "Hidden") -> "Hidden":
        """Both together; where both set the same number, the other's."""
        cables = dict(self.cables)
        for place, values in other.cables.items():
            mine = cables.get(place)
            cables[place] = values if mine is None else np.where(values, values, mine)
        faults = {k: v for k, v in vars(other.drive).items() if v != getattr(SOUND, k)}
        return Hidden(
            cables,
            self.platform | other.platform,
            replace(self.drive, **faults),
            np.where(other.weight_share, other.weight_share, self.weight_share),
            np.where(other.bristles, other.bristles, self.bristles),
        )


NOTHING = Hidden()


@dataclass(frozen=True)
class Course:
    """What happened.

    Parameters
    ----------
    t_s
        Shape (n,), s.
    tension_n
        Between platform and pulley, shape (n, 8), N.
    pose
        X, Y, Z of the rig file's centre of mass in m, roll, pitch, yaw in rad; shape (n, 6).

    From where a machine came apart both are not-a-number.
    """

    t_s: Array
    tension_n: Array
    pose: Array


def rest_wrench(nominal: Machine, excitation: Excitation) -> Array:
    """What the frozen drive applies at rest, shape (6,), N and N m."""
    return np.asarray(frozen_wrench(nominal, excitation, np.zeros(3), 1.0)[0])


def simulate(rig: Rig, offset: Offset, hidden: Hidden = NOTHING, step_s: float = STEP_S) -> Course:
    """Drive the true machine, from rest.

    Parameters
    ----------
    rig
        As written down, its excitation included: the drive is made for it.
    offset
        True machine less the rig file.
    hidden
        Further physics.
    step_s
        Of the integration, s; a whole part of `OUTPUT_S`, or a multiple of it.
    """
    nominal, excitation = Machine.from_rig(rig), rig.excitation
    true = offset.applied(nominal, rest_wrench(nominal, excitation))
    every = max(1, round(OUTPUT_S / step_s))
    steps = round(excitation.duration_s / step_s) // every * every
    half_s = step_s / 2.0
    moments = np.asarray(np.arange(2 * steps + MORE_MOMENTS) * half_s)
    motion = angle(excitation, hidden.drive, moments)
    cables, platform = cable_numbers(true, hidden), platform_numbers(true, hidden)
    rows = steps // every + 1
    states, tensions = np.full((rows, 7), np.nan), np.full((rows, 8), np.nan)
    follow(
        _at_rest(true, cables, hidden),
        frozen_wrench(nominal, excitation, motion, half_s),
        cables,
        platform,
        true.inertia,
        np.linalg.inv(true.inertia),
        _directions(true),
        step_s,
        steps,
        every,
        round(excitation.start_s / step_s),
        np.array(excitation.platform_offset_m),
        excitation.cable_offset_m,
        states,
        tensions,
    )
    return Course(moments[0 : 2 * steps + 1 : 2 * every], tensions, _pose(states))


def cable_numbers(true: Machine, hidden: Hidden) -> Array:
    """The cables as the compiled laws read them, shape (8, CABLE_NUMBERS)."""
    length, direction = true.lines
    cables = np.zeros((8, at_.CABLE_NUMBERS))
    cables[:, at_.STIFFNESS] = true.stiffness
    cables[:, at_.PRETENSION] = true.pretension
    cables[:, at_.DENSITY] = true.line_density
    cables[:, at_.STRING_LOSS] = true.string_loss
    cables[:, at_.BASE : at_.BASE + 3] = true.base
    cables[:, at_.ANCHOR : at_.ANCHOR + 3] = true.anchor - true.centre
    cables[:, at_.REST_LENGTH] = length
    cables[:, at_.MODES] = cables[:, at_.PLANES] = 1.0
    cables[:, at_.POST] = POST_OF
    for place, values in hidden.cables.items():
        cables[:, place] = np.where(values, values, cables[:, place])
    level = np.hypot(direction[:, 0], direction[:, 1])
    cables[:, at_.WEIGHT] = cables[:, at_.DENSITY] * GRAVITY * level * hidden.weight_share
    cables[:, at_.FRICTION_AT_REST] = cables[:, at_.BRISTLE] * _bent(cables, hidden)
    return cables


def _bent(cables: Array, hidden: Hidden) -> Array:
    """How far the bristles are bent at rest, shape (8,), m."""
    slips = cables[:, at_.COULOMB] + cables[:, at_.CAPSTAN] * cables[:, at_.PRETENSION]
    stiff = cables[:, at_.BRISTLE]
    return hidden.bristles * slips / np.where(stiff > 0.0, stiff, np.inf)


def platform_numbers(true: Machine, hidden: Hidden) -> Array:
    """Platform and frame as the compiled laws read them, shape (PLATFORM_NUMBERS,)."""
    platform = np.zeros(at_.PLATFORM_NUMBERS)
    platform[at_.MASS] = true.mass
    platform[at_.TRACKED : at_.TRACKED + 3] = -true.centre
    for place, value in hidden.platform.items():
        platform[place] = value
    hose_at = platform[at_.HOSE_AT : at_.HOSE_AT + 3]
    platform[at_.HOSE_FROM : at_.HOSE_FROM + 3] = true.centre + hose_at
    return platform


def _at_rest(true: Machine, cables: Array, hidden: Hidden) -> Array:
    """The state before the motion: zero pose, bristles bent, all else at rest."""
    state = np.zeros(at_.STATES)
    state[at_.PLACE : at_.PLACE + 3] = true.centre
    state[at_.ATTITUDE] = 1.0
    state[at_.CABLES :].reshape(8, at_.CABLE_STATES)[:, at_.BENT] = _bent(cables, hidden)
    return state


def _directions(true: Machine) -> Array:
    """Of each cable across it in the vertical plane, across it level, and along, (8, 3, 3)."""
    _, along = true.lines
    level = np.cross(along, [0.0, 0.0, 1.0])
    level /= np.linalg.norm(level, axis=1)[:, None]
    return np.stack([np.cross(along, level), level, along], axis=1)


def _pose(states: Array) -> Array:
    """Places and attitudes as X, Y, Z, roll, pitch, yaw, R = Rz Ry Rx; shape (n, 6), m and rad."""
    w, x, y, z = states[:, 3:].T
    roll = np.arctan2(2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(-2.0 * (x * z - w * y))
    yaw = np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))
    return np.column_stack([states[:, :3], roll, pitch, yaw])
