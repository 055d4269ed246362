"""The force that a cable's law misses, block by block of the steady motion, and how sure it is.

It is what a tension has beyond k Delta L at the *measured* pose. Against a simulated tension a
friction would show only by its part that cancels on the platform: the drive, not the friction, says
what the others sum to. Cameras know few harmonics of a motion, so force and state are both seen as
the drive's harmonics up to there, fitted to each block of a cycle or more on its own.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from analysis.diagnosis.nuisances import (
    CAMERA_AXIS_DEG,
    CAMERA_SHARE,
    CELL_SHARE,
    LATENCY_S,
    SAMPLE_S,
)
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.state_terms import State, values
from analysis.steady import BAND, harmonic_basis, lengths
from model import Machine

Array = NDArray[np.float64]

MOST_HARMONICS, TENSION_HARMONICS, PHASES = 5, 10, 128

LEAST_BLOCKS = 6
"""Fewer tell neither the noise nor what holds on cycles that were not used."""

POSES_EACH, FEWEST_EACH = 1.8, 1.5
"""Poses in a block for each number that is fitted to them, and where frames were lost."""

FOLDED_HARMONICS = 7
"""Of the drive: higher ones move the platform too little."""


@dataclass(frozen=True)
class Missing:
    """The missing force of one cable over the blocks of all runs, one number after the other.

    Attributes
    ----------
    cable
        1 to 8.
    block
        Which block each number is of, shape (n,).
    force
        Mean, cosines and sines of the drive's harmonics, N, shape (n,).
    variance
        Of its noise, N^2, shape (n,).
    known
        What each number of the rig file, clock and scale makes of it when moved by its sigma, N,
        shape (n, k).
    terms
        What one unit of each of `state_terms.TERMS` makes of it, shape (n, terms).
    level
        Mean force of each run, which may be anything: a pretension, a cell's zero; shape (n, runs).
    """

    cable: int
    block: NDArray[np.int64]
    force: Array
    variance: Array
    known: Array
    terms: Array
    level: Array


def missing_forces(
    recordings: Sequence[Recording], explained: Sequence[Recording] | None = None
) -> list[Missing]:
    """Of each cable that was measured in a steady motion that the camera follows.

    Parameters
    ----------
    recordings
        Runs of one machine; those without poses or six blocks are passed over.
    explained
        The same runs as the named causes make them: what is in these is not missing.
    """
    parts: dict[int, list[Missing]] = {}
    blocks = 0
    for recording, made in zip(recordings, explained or recordings, strict=True):
        plan = _plan(recording)
        if plan is None:
            continue
        for place, cable in enumerate(recording.cables):
            one = _of_cable(recording, place, plan)
            if one is None:
                continue
            if explained is not None:
                caused = _forces(made, place, plan)
                assert caused is not None
                one = replace(one, force=one.force - caused.ravel())
            parts.setdefault(cable, []).append(replace(one, block=one.block + blocks))
        blocks += len(plan.edges) - 1
    return [_joined(parts[cable]) for cable in sorted(parts)]


@dataclass(frozen=True)
class _Plan:
    """Edges of the blocks, s, and harmonics that are seen in each."""

    edges: Array
    harmonics: int


def _plan(recording: Recording) -> _Plan | None:
    """How a run is cut; None: it has too few blocks, or the camera is too slow for them."""
    hertz = recording.excitation.frequency_hz
    steady = [s for s in recording.bundles[-1].segments if s.fundamental_hz is not None]
    if not recording.has_pose or not steady:
        return None
    start_s, end_s = min(s.start_s for s in steady), max(s.end_s for s in steady)
    t_s = recording.bundles[-1].t_s
    t_s = t_s[(t_s >= start_s) & (t_s < end_s)]
    if len(t_s) < 2:
        return None
    fps = 1.0 / float(np.median(np.diff(t_s)))
    whole_s = end_s - start_s
    for harmonics in range(min(MOST_HARMONICS, int(BAND * fps / hertz)), 0, -1):
        if _folded(hertz, fps, harmonics, whole_s):
            continue
        numbers = 1 + 2 * harmonics
        count = int(whole_s / max(1.0 / hertz, POSES_EACH * numbers / fps) + 1e-6)
        edges = np.linspace(start_s, end_s, count + 1)
        if count >= LEAST_BLOCKS and np.histogram(t_s, edges)[0].min() >= FEWEST_EACH * numbers:
            return _Plan(edges, harmonics)
    return None


def _folded(hertz: float, fps: float, harmonics: int, whole_s: float) -> bool:
    """Whether the camera shows a higher harmonic where it looks for a lower one."""
    higher = hertz * np.arange(harmonics + 1, FOLDED_HARMONICS + 1)
    shown = np.abs(higher - np.round(higher / fps) * fps)
    lines = hertz * np.arange(harmonics + 1)
    return bool((np.abs(shown[:, None] - lines) < 1.0 / whole_s).any())


def _of_cable(recording: Recording, place: int, plan: _Plan) -> Missing | None:
    """A run's missing force in one of its cables; None: too few tensions."""
    forces = _forces(recording, place, plan)
    if forces is None:
        return None
    machine, i = Machine.from_rig(recording.rig), recording.cables[place] - 1
    hertz, poses = recording.excitation.frequency_hz, recording.bundles[-1]
    edges, count = plan.edges, 1 + 2 * plan.harmonics
    phase_s = _phases(plan, hertz)
    # The state is that of the whole run's poses: a block's own noise is in its force, and in the
    # state as well it would make the two go together.
    moving = (poses.t_s >= edges[0]) & (poses.t_s < edges[-1])
    pose = _fitted(poses.t_s[moving], poses.value[moving], hertz, plan.harmonics)
    state = _state(machine, i, pose, phase_s, hertz, recording.excitation.axis)
    known = np.column_stack(_known(recording, machine, i, pose, phase_s, hertz))
    terms = [
        _fitted(phase_s, values(replace(state, t_s=np.full(PHASES, start_s - edges[0]))), hertz,
                plan.harmonics)
        for start_s in edges[:-1]
    ]  # fmt: skip
    bundle, blocks = recording.bundles[place], len(forces)
    each = np.count_nonzero((bundle.t_s >= edges[0]) & (bundle.t_s < edges[-1])) / blocks
    white = 2.0 * bundle.covariance[0, 0] / each
    return Missing(
        i + 1,
        np.repeat(np.arange(blocks), count),
        forces.ravel(),
        np.tile(np.maximum(_scatter(forces), white), blocks),
        np.tile(_fitted(phase_s, known, hertz, plan.harmonics), (blocks, 1)),
        np.array(terms).reshape(blocks * count, -1),
        np.tile(np.eye(count)[0], blocks)[:, None],
    )


def _forces(recording: Recording, place: int, plan: _Plan) -> Array | None:
    """Tension beyond k Delta L, shape (blocks, 1 + 2 h); None: too few samples in a block."""
    machine, i = Machine.from_rig(recording.rig), recording.cables[place] - 1
    bundle, poses = recording.bundles[place], recording.bundles[-1]
    hertz, count = recording.excitation.frequency_hz, 1 + 2 * plan.harmonics
    phase_s = _phases(plan, hertz)
    found = []
    for start_s, end_s in pairwise(plan.edges):
        inside = (bundle.t_s >= start_s) & (bundle.t_s < end_s)
        seen = (poses.t_s >= start_s) & (poses.t_s < end_s)
        used = min(TENSION_HARMONICS, (int(inside.sum()) - 2) // 4)
        if used < plan.harmonics:
            return None
        pulled = _fitted(bundle.t_s[inside], bundle.value[inside, 0], hertz, used)[:count]
        pose = _fitted(poses.t_s[seen], poses.value[seen], hertz, plan.harmonics)
        moved = harmonic_basis(phase_s, hertz, plan.harmonics) @ pose
        stretch = lengths(moved, machine.base[i], machine.anchor[i]) - machine.rest_length[i]
        found.append(
            pulled - machine.stiffness[i] * _fitted(phase_s, stretch, hertz, plan.harmonics)
        )
    return np.array(found)


def _phases(plan: _Plan, hertz: float) -> Array:
    """Times of one cycle, shape (PHASES,), s."""
    return np.asarray(plan.edges[0] + np.arange(PHASES) / (PHASES * hertz))


def _state(machine: Machine, i: int, pose: Array, at_s: Array, hertz: float, axis: str) -> State:
    """The cable's state over a cycle of a block."""
    harmonics = (len(pose) - 1) // 2
    seen = harmonic_basis(at_s, hertz, harmonics) @ pose
    long = lengths(seen, machine.base[i], machine.anchor[i])
    angle = seen[:, 3 + ("roll", "pitch", "yaw").index(axis)]
    return State(
        long - machine.rest_length[i],
        _slope(long, hertz),
        machine.pretension[i] + machine.stiffness[i] * (long - machine.rest_length[i]),
        angle - angle.mean(),
        np.zeros(PHASES),
    )


def _known(
    recording: Recording, machine: Machine, i: int, pose: Array, at_s: Array, hertz: float
) -> list[Array]:
    """What each known number moves the force by, with its sigma: series over a cycle."""
    rig = recording.rig.cable[i]
    stiffness, base, anchor = machine.stiffness[i], machine.base[i], machine.anchor[i]
    seen = harmonic_basis(at_s, hertz, (len(pose) - 1) // 2) @ pose
    long = lengths(seen, base, anchor)
    spring = stiffness * (long - long.mean())
    share = np.sqrt(
        (rig.stiffness_n_per_m.sigma / stiffness) ** 2 + CELL_SHARE**2 + CAMERA_SHARE**2
    )
    found = [share * spring, np.hypot(LATENCY_S, SAMPLE_S) * stiffness * _slope(long, hertz)]
    for axis in np.eye(3):
        found.append(stiffness * (lengths(seen, base + rig.base_m.sigma * axis, anchor) - long))
        found.append(stiffness * (lengths(seen, base, anchor + rig.anchor_m.sigma * axis) - long))
        turn = np.deg2rad(CAMERA_AXIS_DEG) * axis
        turned = seen + np.hstack([np.cross(turn, seen[:, :3]), np.cross(turn, seen[:, 3:])])
        found.append(stiffness * (lengths(turned, base, anchor) - long))
    return [one - one.mean() for one in found]


def _fitted(t_s: Array, value: Array, hertz: float, count: int) -> Array:
    """Coefficients of the harmonics of columns."""
    return np.asarray(np.linalg.lstsq(harmonic_basis(t_s, hertz, count), value, rcond=None)[0])


def _slope(values: Array, hertz: float) -> Array:
    """Rate of a series over one cycle."""
    lines = np.fft.rfft(values) * 2j * np.pi * hertz * np.arange(PHASES // 2 + 1)
    return np.asarray(np.fft.irfft(lines, PHASES))


def _scatter(force: Array) -> Array:
    """Variance of one block's numbers about their line over the blocks; one for each harmonic."""
    blocks, count = force.shape
    line = np.vander(np.arange(blocks), 2).astype(float)
    rest = force - line @ np.linalg.lstsq(line, force, rcond=None)[0]
    own = (rest**2).sum(axis=0) / (blocks - 2)
    pairs = own[1:].reshape(-1, 2).mean(axis=1)
    return np.concatenate([own[:1], np.repeat(pairs, 2)])[:count]


def _joined(parts: Sequence[Missing]) -> Missing:
    """Runs of one cable: numbers of the rig file are common to them, the mean force is not."""
    return Missing(
        parts[0].cable,
        np.concatenate([one.block for one in parts]),
        np.concatenate([one.force for one in parts]),
        np.concatenate([one.variance for one in parts]),
        np.vstack([one.known for one in parts]),
        np.vstack([one.terms for one in parts]),
        block_diag(*(one.level for one in parts)),
    )
