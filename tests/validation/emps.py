"""EMPS: a motor and a ball-screw, of which mass and viscous friction are known to be there.

What is predicted is the drive's force from the measured position: the machine integrates twice, so
that its position drifts with any force that is missed, and ranks models wrongly.

Data and published model: Janot, Gautier, Brunot, "Data Set and Reference Models of EMPS",
Nonlinear System Identification Benchmarks, 2019.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.io import loadmat
from scipy.signal import butter, filtfilt

from analysis.engine import Bundle, Candidate, Nuisance, Point, Segment, Shape, Term
from analysis.engine.array import Array
from analysis.engine.system import Prediction
from tests.validation.shared import Described, candidate, folder, series

RATE_HZ = 1000.0
POSITION_HZ, FORCE_HZ, DECIMATION = 100.0, 50.0, 10
"""Zero-phase Butterworth filters, 4th order: of the position, and of both sides of the balance."""
EDGE_S = 0.05  # both ends, where the filters have one side only, are left out
NOISE_N = 0.75
"""Of a filtered force sample: what varies within 0.1 s at constant speed, in the train record."""
MASS_KG, VISCOUS_N_S_M = 95.2, 410.9
"""Least squares of these alone on the train record: what is to be improved."""
MIDDLE_M = 0.125
RECORDS = {"train": "DATA_EMPS.mat", "test": "DATA_EMPS_PULSES.mat"}


class Motion(NamedTuple):
    """Filtered position, speed and acceleration [m, m/s, m/s^2] and the drive's force [N]."""

    q: Array
    v: Array
    a: Array
    force: Array


def smooth(force: Array) -> Array:
    """Both sides of the balance are seen through one filter, every tenth sample."""
    return np.asarray(filtfilt(*butter(4, FORCE_HZ / (0.5 * RATE_HZ)), force, axis=0))[::DECIMATION]


@cache
def motion(record: str) -> Motion:
    """A record's motion at its full rate."""
    data = loadmat(folder("emps") / RECORDS[record])
    q = filtfilt(*butter(4, POSITION_HZ / (0.5 * RATE_HZ)), data["qm"].ravel())
    v = np.gradient(q, 1.0 / RATE_HZ)
    force = float(data["gtau"].ravel()[0]) * data["vir"].ravel()
    return Motion(q, v, np.gradient(v, 1.0 / RATE_HZ), force)


def presliding(m: Motion, reach_m: float) -> Array:
    """Dahl's friction of size one: it builds up over a reach after each reversal."""
    z, found = 0.0, np.empty_like(m.q)
    decay = np.exp(-np.abs(np.diff(m.q, prepend=m.q[0])) / reach_m)
    toward = np.sign(np.diff(m.q, prepend=m.q[0]))
    for i, (keep, sign) in enumerate(zip(decay.tolist(), toward.tolist(), strict=True)):
        z = sign + (z - sign) * keep
        found[i] = z
    return found


PITCH = Shape("pitch_m", "m", 0.01, 0.002, 0.05, grid=(0.002, 0.005, 0.01, 0.02, 0.04))
COGGING = Candidate(
    "cogging", "a force that repeats with the position of the screw", "plant",
    (Term("sine", "sine_n", "N", "", -20.0, 20.0, 1.0),
     Term("cosine", "cosine_n", "N", "", -20.0, 20.0, 1.0)),
    (PITCH,), together=True,
)  # fmt: skip
SPEED = Shape("speed_m_s", "m/s", 0.01, 0.001, 0.05, grid=(0.005, 0.02))
THIN = Shape("bend_m_s", "m/s", 0.05, 0.01, 0.2, grid=(0.02, 0.1))
REACH = Shape("reach_m", "m", 3e-4, 3e-5, 3e-3, grid=(1e-4, 1e-3))
CANDIDATES = (
    candidate("coulomb", "Coulomb friction", "N", 0.0, 100.0, 5.0, family="friction"),
    candidate("offset", "a constant force: amplifier offset, or friction that differs by "
              "direction", "N", -50.0, 50.0, 2.0, form_share=0.02),
    candidate("presliding", "friction that builds up over a reach", "N", 0.0, 100.0, 5.0, (REACH,),
              family="friction"),
    candidate("drag", "a force with the square of speed", "N s^2/m^2", 0.0, 5e3, 300.0),
    candidate("one_sided", "viscous friction that differs by direction", "N s/m", -200.0, 200.0,
              20.0),
    candidate("stribeck", "friction that falls with speed", "N", 0.0, 50.0, 3.0, (SPEED,)),
    candidate("thinning", "a lubricant that thins with speed", "N", 0.0, 100.0, 5.0, (THIN,)),
    candidate("spring", "a force with position, such as a cable's", "N/m", -500.0, 500.0, 20.0),
    candidate("uneven", "friction that varies along the screw", "N/m", -500.0, 500.0, 20.0),
    candidate("loaded", "friction that grows with the force through the screw", "1", 0.0, 0.3,
              0.03),
    candidate("lag", "the force comes late", "s", 0.0, 0.01, 5e-4, side="drive", form_share=0.02),
    COGGING,
)  # fmt: skip


class Emps(Described):
    """The axis; the record with pulses is kept for the proof."""

    name = "EMPS"
    candidates = CANDIDATES
    nuisances = (
        Nuisance("mass", 10.0, "kg"),
        Nuisance("viscous", 0.5 * VISCOUS_N_S_M, "N s/m"),
    )

    def __init__(self) -> None:
        self.motions = {record: motion(record) for record in RECORDS}
        self.bundles = tuple(self._bundle(record) for record in RECORDS)

    def _bundle(self, record: str) -> Bundle:
        force = smooth(self.motions[record].force)
        t_s = np.arange(len(force)) * DECIMATION / RATE_HZ
        stretch = Segment(EDGE_S, t_s[-1] - EDGE_S, sealed=record == "test", name=record)
        return series(record, "force", "N", t_s, force, NOISE_N, segments=(stretch,), kind="force")

    def predict(self, point: Point) -> Prediction:
        """The force that the measured motion takes."""
        return [smooth(self._force(point, m)) for m in self.motions.values()]

    def _force(self, point: Point, m: Motion) -> Array:
        mass = MASS_KG + self.number(point, "mass")
        viscous = VISCOUS_N_S_M + self.number(point, "viscous")
        sign, speed = np.sign(m.v), np.abs(m.v)
        bend_m_s = self.value(point, "thinning", "bend_m_s")
        falls_m_s = self.value(point, "stribeck", "speed_m_s")
        law = {
            "coulomb": lambda: sign,
            "offset": lambda: np.ones_like(sign),
            "presliding": lambda: presliding(m, self.value(point, "presliding", "reach_m")),
            "drag": lambda: m.v * speed,
            "one_sided": lambda: speed,
            "stribeck": lambda: sign * np.exp(-((speed / falls_m_s) ** 2)),
            "thinning": lambda: sign * -np.expm1(-speed / bend_m_s),
            "spring": lambda: m.q - MIDDLE_M,
            "uneven": lambda: sign * (m.q - MIDDLE_M),
            "loaded": lambda: sign * np.abs(mass * m.a),
        }
        on = [name for name in point.effects if name in law]
        total = mass * m.a + viscous * m.v
        total = total + sum(self.value(point, name) * law[name]() for name in on)
        if "cogging" in point.effects:
            angle = 2.0 * np.pi * m.q / self.value(point, "cogging", "pitch_m")
            total = total + self.value(point, "cogging", "sine") * np.sin(angle)
            total = total + self.value(point, "cogging", "cosine") * np.cos(angle)
        if "lag" in point.effects:
            t = np.arange(len(total)) / RATE_HZ
            total = np.interp(t - self.value(point, "lag"), t, total)
        return np.asarray(total)[:, None]
