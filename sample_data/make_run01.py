"""Makes run01 again, to the byte: ``python -m sample_data.make_run01``.

The paper's recordings are not public, so run01 is a reconstruction: the packaged CDPR-8 moved with
the friction of `rig.simulated.plant.PULLEY_FRICTION_N` at its pulleys, its tensions read as bytes
over the bus and its pitch as pixels, by the recorder of `rig record` on a virtual clock.

``--solve`` looks for the friction that makes the *measured* amplitudes those the paper measured and
prints it; it is then written into `rig.simulated.plant` by hand. Whenever the packaged rig file or
the simulated rig changes, solve again and make run01 again.
"""

import argparse
import shutil
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from cdpr8.clock import VirtualClock
from cdpr8.rigfile import load_rig, packaged_rig_path
from cdpr8.runfolder import load_run, sample_data_folder
from cdpr8.terminal import say
from rig.recorder import Recording, record
from rig.simulated import open_rig
from rig.simulated.plant import PULLEY_FRICTION_N

SEED = 20230728
EPOCH = datetime(2026, 1, 1, tzinfo=UTC)

RECONSTRUCTION = (
    "not a measurement: the simulated CDPR-8 with friction at its pulleys, chosen so that the "
    "measured amplitudes are those of Peng et al. 2023, Section 5; it shows what friction of this "
    "size would do, not that it was there"
)

MEASURED_IN_THE_PAPER = {"pitch": 1.916, "tension 1": 7.460, "tension 7": 6.110}
"""Section 5: 1.92 deg, 7.46 N, 6.11 N. The pitch has one digit more, from the printed 5.73 %."""

TOLERANCE = {"pitch": 0.002, "tension 1": 0.002, "tension 7": 0.002}

PAIRS = ((1, 2), (3, 4, 5, 8), (6, 7))
"""Cables that share one friction: left and right alike; those the paper does not show together."""


def make(folder: Path, friction_n: NDArray[np.float64] | None = None) -> Recording:
    """Record run01 into an empty or absent folder.

    Parameters
    ----------
    folder
        Where.
    friction_n
        Coulomb friction of each pulley, shape (8,), N; None takes the simulated rig's own.
    """
    path = packaged_rig_path()
    rig = load_rig(path)
    clock = VirtualClock(EPOCH)
    machine = open_rig(rig, rig.excitation, clock, seed=SEED, friction_n=friction_n)
    return record(
        rig,
        path.read_text(encoding="utf-8"),
        folder,
        clock=clock,
        seed=SEED,
        machine=machine,
        reconstruction=RECONSTRUCTION,
    )


def solve() -> NDArray[np.float64]:
    """Friction of the three groups of cables that gives the paper's measured amplitudes, in N."""
    target = np.array(list(MEASURED_IN_THE_PAPER.values()))
    scale = np.array(list(TOLERANCE.values()))
    start = np.array([PULLEY_FRICTION_N[group[0] - 1] for group in PAIRS])
    found = least_squares(
        lambda groups: (_measured_amplitudes(groups) - target) / scale,
        start,
        bounds=(0.02, 1.0),
        diff_step=0.05,
        xtol=1e-4,
        max_nfev=12,
    )
    return np.asarray(found.x)


def _measured_amplitudes(groups: NDArray[np.float64]) -> NDArray[np.float64]:
    from analysis.compare import compare
    from vision import track_run

    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / "run01"
        make(folder, _by_cable(groups))
        run = load_run(folder)
        comparison = compare(run, track_run(run))
    measured = {q.measured.name: q.measured_amplitude for q in comparison.quantities}
    amplitudes = np.array([measured[name] for name in MEASURED_IN_THE_PAPER])
    say(f"friction {np.round(groups, 4)} N: measured {np.round(amplitudes, 4)}")
    return amplitudes


def _by_cable(groups: NDArray[np.float64]) -> NDArray[np.float64]:
    friction = np.zeros(8)
    for group, value in zip(PAIRS, groups, strict=True):
        for cable in group:
            friction[cable - 1] = value
    return friction


def main() -> None:
    """Make run01 in place, or solve for its friction."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--solve", action="store_true", help="look for the friction, print it")
    if parser.parse_args().solve:
        say(f"PULLEY_FRICTION_N = {tuple(float(x) for x in np.round(_by_cable(solve()), 3))}")
        return
    folder = sample_data_folder() / "run01"
    shutil.rmtree(folder, ignore_errors=True)
    make(folder)
    say(f"made {folder}")


if __name__ == "__main__":
    main()
