"""The whole machine's rates, and the classical Runge-Kutta method that follows them."""

from math import sqrt

import numpy as np
from numpy.typing import NDArray

from analysis.challenge.outsider import layout as at_
from analysis.challenge.outsider.cables import tension
from analysis.challenge.outsider.compiled import law
from analysis.challenge.outsider.frame import post_at, pull_post, swing_posts
from analysis.challenge.outsider.path import straight
from analysis.challenge.outsider.rigid_body import (
    accelerate,
    air,
    dampers,
    hose,
    load_at,
    move,
    weight_and_drive,
    write_turn,
)
from analysis.challenge.outsider.strings import disturb, end_reaction, vibrate
from analysis.challenge.outsider.vectors import at, cross, dot, gained, minus, plus, times, turned

Array = NDArray[np.float64]

LOST_M = 5.0
"""A platform farther away than this has come apart."""

TENSION, LENGTH, GROWTH, ARM = 0, 1, 2, 3
"""What is kept of each cable from one pass to the next: N, m, m/s, and the anchor's arm, m."""
KEPT = 6


@law
def cable_states(state: Array, cable: int) -> Array:
    """The states of one cable, a view."""
    start = at_.CABLES + cable * at_.CABLE_STATES
    return state[start : start + at_.CABLE_STATES]


@law
def hang(
    time_s: float,
    state: Array,
    change: Array,
    number: int,
    cables: Array,
    platform: Array,
    directions: Array,
    turn: Array,
    load: Array,
    kept: Array,
) -> None:
    """Tension of one cable and its pull on platform and frame.

    Parameters
    ----------
    time_s
        Of the run, s.
    state, change
        Shape (STATES,).
    number
        Of the cable, from 0.
    cables, platform, directions
        Numbers of the machine; shapes (8, CABLE_NUMBERS), (PLATFORM_NUMBERS,) and (8, 3, 3).
    turn
        Rotation matrix of the platform.
    load
        Gains the pull, shape (6,).
    kept
        Gets a row for this cable, shape (8, KEPT).
    """
    cable = cables[number]
    own, rates = cable_states(state, number), cable_states(change, number)
    arm = turned(turn, at(cable, at_.ANCHOR))
    base, base_speed = at(cable, at_.BASE), (0.0, 0.0, 0.0)
    compliant = platform[at_.POST_STIFFNESS] > 0.0
    if compliant:
        base = plus(base, at(state, post_at(cable)))
        base_speed = at(state, post_at(cable) + 3)
    anchor = plus(at(state, at_.PLACE), arm)
    rest = at(directions[number, 2], 0)
    length, direction = straight(anchor, base)
    anchor_speed = plus(at(state, at_.SPEED), cross(at(state, at_.SPIN), arm))
    growth = -dot(direction, minus(anchor_speed, base_speed))
    pulls = tension(cable, own, rates, time_s, length, growth)
    force = times(pulls, direction)
    kept[number, TENSION] = pulls
    kept[number, LENGTH] = length
    kept[number, GROWTH] = growth
    for j in range(3):
        kept[number, ARM + j] = arm[j]
    if compliant:
        pull_post(change, cable, platform, rest, force)
    if cable[at_.SHAKEN] > 0.0:
        force = end_reaction(cable, own, directions[number], length, pulls, force)
    load_at(load, arm, force)


@law
def rates_of(
    time_s: float,
    state: Array,
    change: Array,
    wrench: Array,
    cables: Array,
    platform: Array,
    inertia: Array,
    inverse: Array,
    directions: Array,
    turn: Array,
    load: Array,
    kept: Array,
) -> None:
    """Rates of the whole state; `turn`, `load` and `kept` are written over."""
    change[:] = 0.0
    load[:] = 0.0
    write_turn(state, turn)
    move(state, change)
    weight_and_drive(load, wrench, platform, turn)
    dampers(load, state, platform)
    if platform[at_.DRAG] > 0.0:
        air(load, state, platform, turn)
    if platform[at_.HOSE] > 0.0 or platform[at_.HOSE_LOSS] > 0.0:
        hose(load, state, platform, turn)
    for number in range(len(cables)):
        hang(time_s, state, change, number, cables, platform, directions, turn, load, kept)
    if platform[at_.POST_STIFFNESS] > 0.0:
        swing_posts(state, change, platform)
    accelerate(change, state, load, platform[at_.MASS], inertia, inverse, turn)
    spin, turning, pushed = at(state, at_.SPIN), at(change, at_.SPIN), at(change, at_.SPEED)
    for number in range(len(cables)):
        arm = at(kept[number], ARM)
        whirled = cross(spin, cross(spin, arm))
        shaken = plus(plus(pushed, cross(turning, arm)), whirled)
        own, rates = cable_states(state, number), cable_states(change, number)
        length, growth = kept[number, LENGTH], kept[number, GROWTH]
        pulls = kept[number, TENSION]
        cable = cables[number]
        vibrate(cable, own, rates, directions[number], length, growth, pulls, shaken)


@law
def set_off(state: Array, cables: Array, offset_m: Array, string_m: float) -> None:
    """The disturbances that act as the motion starts: X_p0 and X_w0."""
    gained(state, at_.PLACE, at(offset_m, 0))
    for number in range(len(cables)):
        disturb(cables[number], cable_states(state, number), string_m)


@law
def keep_unit(state: Array) -> None:
    """The attitude's quaternion is brought back to length one."""
    square = 0.0
    for j in range(4):
        square += state[at_.ATTITUDE + j] ** 2
    for j in range(4):
        state[at_.ATTITUDE + j] /= sqrt(square)


@law
def follow(
    state: Array,
    wrenches: Array,
    cables: Array,
    platform: Array,
    inertia: Array,
    inverse: Array,
    directions: Array,
    step_s: float,
    steps: int,
    every: int,
    start: int,
    offset_m: Array,
    string_m: float,
    states: Array,
    tensions: Array,
) -> None:
    """Integrate from a state, by the classical method of Runge and Kutta (fourth order).

    Parameters
    ----------
    state
        Shape (STATES,); is written over.
    wrenches
        Of the drive at every half step, shape (2 steps + 1 or more, 6), N and N m.
    cables, platform, inertia, inverse, directions
        The machine.
    step_s, steps, every
        Of the integration, s; how many; every how many a row is kept.
    start, offset_m, string_m
        At which step the disturbances X_p0, shape (3,), and X_w0 act, m.
    states, tensions
        What is kept, shapes (rows, 7) and (rows, 8): place of the rig file's centre of mass and
        attitude, and tensions. Rows after a machine came apart stay as they are.
    """
    k = np.zeros((4, at_.STATES))
    tried = np.zeros(at_.STATES)
    turn, load, kept = np.zeros((3, 3)), np.zeros(6), np.zeros((len(cables), KEPT))
    for step in range(steps + 1):
        time_s = step * step_s
        if step == start:
            set_off(state, cables, offset_m, string_m)
        for stage in range(4):
            share = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            half_steps = (stage + 1) // 2
            for j in range(at_.STATES):
                tried[j] = state[j] if stage == 0 else state[j] + share * step_s * k[stage - 1, j]
            rates_of(
                time_s + share * step_s, tried, k[stage], wrenches[2 * step + half_steps],
                cables, platform, inertia, inverse, directions, turn, load, kept,
            )  # fmt: skip
            if stage == 0 and step % every == 0:
                row = step // every
                tracked = turned(turn, at(platform, at_.TRACKED))
                for j in range(3):
                    states[row, j] = state[at_.PLACE + j] + tracked[j]
                for j in range(4):
                    states[row, 3 + j] = state[at_.ATTITUDE + j]
                tensions[row] = kept[:, TENSION]
            if step == steps:
                return
        for j in range(at_.STATES):
            state[j] += step_s / 6.0 * (k[0, j] + 2.0 * k[1, j] + 2.0 * k[2, j] + k[3, j])
        keep_unit(state)
        if not abs(state[at_.PLACE]) < LOST_M:
            return
