"""Tables of a run as channels: values, times and noise of each tension, and of the poses."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analysis.diagnosis.ages import SINGLY, Ages, ages
from analysis.diagnosis.noise import (
    ESTIMATED,
    LEAST_REST,
    about_line,
    at_rest,
    instants_s,
    stated_covariance,
    with_instants,
)
from analysis.diagnosis.segments import segments
from analysis.engine.bundle import Bundle
from analysis.noise_floor import noise_floor
from cdpr8.rigfile.excitation import Excitation
from cdpr8.runfolder import POSE_AXES, FrameFlag, Node, Run
from model import Machine
from model.rest import tones_hz

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

MOST_HZ = 250.0
"""Faster tensions are averaged in blocks down to about this; nothing here is faster than 30 Hz."""

LEAST_FRAMES, LEAST_REST_FRAMES = 20, 10
"""Poses that are of use, and those at rest that a noise level needs."""

OF_LINES = 4
"""A median of lines tells as much of the noise as so many times fewer samples at rest."""

LEAST_NOISE_N = 2e-4
"""Below this the resolution of the electronics is the noise."""

LEAST_NOISE_M, LEAST_NOISE_RAD = 1e-6, 1e-6

BASE_SHARE = 1e-4
"""What two good simulators of the same equations differ by, as a share of the variation."""

_DEGREES = np.array([1.0, 1.0, 1.0, *[np.pi / 180.0] * 3])


class Tension(NamedTuple):
    """A cable's tension.

    Attributes
    ----------
    bundle
        Its samples.
    averaged_s2
        The variance of the instants whose values are one sample, s^2.
    offset_s
        How far off all of its instants may be, beside what each is by itself: standard deviation.
    """

    bundle: Bundle
    averaged_s2: float
    offset_s: float


def tension_of(
    run: Run, cable: int, excitation: Excitation, shift_s: float, notes: list[str]
) -> Tension:
    """A cable's tension.

    Parameters
    ----------
    run, cable
        Which run, and cable 1 to 8.
    excitation, shift_s
        What was commanded, and how much later than it says.
    notes
        Takes what a reader must know.
    """
    good = run.cable_tension(cable)
    t_s = good["t_s"].to_numpy(dtype=float)
    value = good["tension_n"].to_numpy(dtype=float)
    keep = np.concatenate([[True], np.diff(t_s) > 0.0])
    t_s, value = t_s[keep], value[keep]
    interval = float(np.median(np.diff(t_s)))
    block = max(int(1.0 / (interval * MOST_HZ)), 1)
    averaged_s2 = 0.0
    if block > 1:
        whole = len(t_s) // block * block
        averaged_s2 = float(np.median(t_s[:whole].reshape(-1, block).var(axis=1)))
        t_s = t_s[:whole].reshape(-1, block).mean(axis=1)
        value = value[:whole].reshape(-1, block).mean(axis=1)
    rest = at_rest(t_s, excitation, shift_s)
    if run.start.motion_start_known and np.count_nonzero(rest) >= LEAST_REST:
        sigma, noise_from = about_line(t_s[rest], value[rest]), int(rest.sum())
    else:
        sigma = noise_floor(t_s, value, excitation, shift_s)
        noise_from = len(value) // OF_LINES
        notes.append(f"cable {cable}: no rest to take the noise from; {sigma:.4f} N is an estimate")
    found = Bundle(
        names=(f"tension {cable}",),
        units=("N",),
        t_s=t_s,
        value=value[:, None],
        covariance=np.array([[max(sigma, LEAST_NOISE_N) ** 2]]),
        segments=segments(excitation, shift_s, float(t_s[0]), float(t_s[-1])),
        record=run.name,
        kind="tension",
        base_share=BASE_SHARE,
        tones_hz=tuple(tones_hz(Machine.from_rig(run.rig))),
        noise_from=noise_from,
    )
    node = next((one for one in run.start.nodes if one.cable == cable), None)
    stated_s = (node and node.sampling_sigma_s) or 0.0
    # What comes unasked was never asked for: its instants are off each for itself.
    age = SINGLY if run.start.sweep == "streaming" else _ages(good, node)
    made = with_instants(
        found,
        stated_s * float(np.sqrt(age.singly / block)),
        together_s=stated_s * float(np.sqrt(age.together)),
    )
    return Tension(made, averaged_s2, stated_s * float(np.sqrt(age.throughout)))


def _ages(good: "pd.DataFrame", node: Node | None) -> Ages:
    """How the ages of a cable's values vary; singly, where no period is stated."""
    if node is None or not node.output_period_s or not node.sampling_sigma_s:
        return SINGLY
    asked_s = good["t_s"].to_numpy(dtype=float)
    if "request_s" in good and good["request_s"].notna().all():
        asked_s = good["request_s"].to_numpy(dtype=float)
    return ages(np.sort(asked_s), node.output_period_s)


def with_instants_of(
    bundles: list[Bundle], excitation: Excitation, shift_s: float, notes: list[str]
) -> list[Bundle]:
    """Bundles of one clock; where the run states nothing of their instants, what they tell.

    Parameters
    ----------
    bundles
        With their noise known.
    excitation, shift_s, notes
        As for `tension_of`.
    """
    if any(one.jitter is not None or one.late is not None for one in bundles):
        return bundles
    found_s = instants_s(bundles, excitation, shift_s)
    if found_s:
        notes.append(
            f"{bundles[0].kind}: instants of samples spread by {1e3 * found_s:.2g} ms, as the "
            "noise of what moves tells; the run states nothing of it, and it is counted as noise"
        )
    return [with_instants(one, found_s, unsure=ESTIMATED) for one in bundles]


def pose_of(
    run: Run, pose: "pd.DataFrame", excitation: Excitation, shift_s: float, notes: list[str]
) -> Bundle | None:
    """The poses; None: too few are of use.

    Parameters
    ----------
    run, excitation, shift_s, notes
        As for `tension_of`.
    pose
        Columns of pose.csv.
    """
    names = [f"{axis}_m" for axis in "xyz"] + [f"{axis}_deg" for axis in ("roll", "pitch", "yaw")]
    flags = pose["flags"].fillna(0).to_numpy(dtype=int)
    good = pose[names].notna().all(axis=1).to_numpy()
    good = good & ((flags & int(FrameFlag.REPEATED | FrameFlag.BLACK | FrameFlag.NO_MARKER)) == 0)
    seen = pose[good].sort_values("t_s", kind="stable")
    if len(seen) < LEAST_FRAMES:
        notes.append(f"{len(seen)} usable poses are too few")
        return None
    t_s = seen["t_s"].to_numpy(dtype=float)
    value = seen[names].to_numpy(dtype=float) * _DEGREES
    # An angle that passes 180 deg comes back at -180.
    value[:, 3:] = np.unwrap(value[:, 3:], axis=0)
    covariance = stated_covariance(seen) * np.outer(_DEGREES, _DEGREES)
    rest = at_rest(t_s, excitation, shift_s)
    if run.start.motion_start_known and np.count_nonzero(rest) >= LEAST_REST_FRAMES:
        spread = np.array([about_line(t_s[rest], column) for column in value[rest].T])
        stated = np.sqrt(np.diag(covariance))
        if not np.isfinite(stated).all() or (stated == 0.0).any():
            covariance = np.diag(spread**2)
        else:
            # What a dozen frames say of their spread is sure to a quarter.
            factor = np.where(spread > 1.5 * stated, spread / stated, 1.0)
            covariance = covariance * np.outer(factor, factor)
            if (factor > 1.0).any():
                wide = [POSE_AXES[i] for i in np.flatnonzero(factor > 1.0)]
                notes.append(
                    f"poses at rest spread more than pose.csv states ({', '.join(wide)}): the "
                    "spread is taken"
                )
    elif not np.isfinite(covariance).all():
        spread = np.array([noise_floor(t_s, one, excitation, shift_s) for one in value.T])
        covariance = np.diag(spread**2)
        notes.append("pose.csv states no sigma and there was no rest: the noise is an estimate")
    floor = np.array([LEAST_NOISE_M] * 3 + [LEAST_NOISE_RAD] * 3)
    covariance = covariance + np.diag(floor**2)
    return Bundle(
        names=tuple(POSE_AXES),
        units=("m", "m", "m", "rad", "rad", "rad"),
        t_s=t_s,
        value=value,
        covariance=covariance,
        segments=segments(excitation, shift_s, float(t_s[0]), float(t_s[-1])),
        record=run.name,
        kind="pose",
        base_share=BASE_SHARE,
        tones_hz=tuple(tones_hz(Machine.from_rig(run.rig))),
    )
