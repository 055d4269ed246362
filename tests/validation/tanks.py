"""Cascaded tanks: a pump fills a tank that empties into another, whose level is read.

Both are first taken to empty in proportion to their level, as a linear model has it. Levels are in
volts of the sensor, and both tanks are equally wide.

Data: Schoukens, Mattsson, Wigren, Noel, "Cascaded tanks benchmark combining soft and hard
nonlinearities", Nonlinear System Identification Benchmarks, 2016.
"""

from functools import cache, partial

import numba
import numpy as np

from analysis.engine import Bundle, Nuisance, Point, Segment, Shape
from analysis.engine.array import Array
from analysis.engine.system import Prediction
from tests.validation.shared import Described, candidate, folder, series

PERIOD_S, STEPS = 4.0, 2  # of a sample, over which the pump's voltage is held
NOISE_V = 0.2
"""What tanks, hoses and a pump can be trusted to at any time: a tenth of the level's variation. The
sensor's own noise, from second differences of the train record, is a tenth of it."""
REPEATED = 0.5  # how surely it is foretold whether a reading repeats the one before
REFERENCE_V = 5.0  # level at which the laws of outflow agree
OUT_1, OUT_2, PUMP, DEAD_V, START_1_V = 0.0170, 0.0073, 0.0311, -1.51, 2.0
"""Least squares of the linear model on the train record: what is to be improved. Outflow in shares
of the level a second, the pump's inflow [V/s] a volt above its dead zone, and the upper level."""
FACTOR = np.log(2.0)  # one sigma of a rate, of which the law is not known either
RECORDS = {"train": ("uEst", "yEst"), "test": ("uVal", "yVal")}


@cache
def record(name: str) -> tuple[Array, Array]:
    """Pump and level sensor [V]."""
    path = folder("cascaded_tanks") / "dataBenchmark.csv"
    data = np.genfromtxt(path, delimiter=",", names=True, usecols=range(4))
    return np.asarray(data[RECORDS[name][0]]), np.asarray(data[RECORDS[name][1]])


def repeated(y: Array) -> Array:
    """Whether each reading is the one before to the last digit, as no level is: 1, else 0."""
    return np.asarray(np.diff(y, prepend=np.nan) == 0.0, dtype=float)


@numba.njit(cache=True)
def outflow(x, rate, root, loss):  # type: ignore[no-untyped-def]
    """Of a tank [V/s]."""
    full = max(x, 0.0)
    return rate * (np.sqrt(REFERENCE_V * full) if root else full) + loss * x


@numba.njit(cache=True)
def run(u, x1, x2, p):  # type: ignore[no-untyped-def]
    """Level of the lower tank at each sample [V]; p as `Tanks.predict` has it."""
    h = PERIOD_S / STEPS
    found = np.empty(len(u))
    for i in range(len(u)):
        found[i] = x2
        inflow = p[2] * max(u[i] - p[8] * u[i] * u[i] + p[3], 0.0)
        for _ in range(STEPS):  # the middle of a step stands for all of it
            out_1 = outflow(x1, p[0], p[4], p[5])
            out_2 = outflow(x2, p[1], p[4], p[5])
            m1 = x1 + 0.5 * h * (inflow - out_1)
            m2 = x2 + 0.5 * h * (out_1 - out_2)
            out_1 = outflow(m1, p[0], p[4], p[5])
            out_2 = outflow(m2, p[1], p[4], p[5])
            x1 += h * (inflow - out_1)
            x2 += h * (out_1 - out_2)
            if x1 > p[6]:
                x2 += p[7] * (x1 - p[6])
                x1 = p[6]
            x2 = min(x2, p[9])
    return found


# A brim as the pump's voltage that just keeps the upper tank full, whatever its outflow.
BRIM = Shape("brim_v", "V", 4.5, 2.0, 8.0, grid=(3.5, 4.0, 4.5, 5.0))
CAUGHT = Shape("caught", "1", 0.5, 0.0, 1.0, grid=(0.2, 0.5, 0.8), logarithmic=False)
LOWER = Shape("brim_v", "V", 10.0, 8.0, 12.0, grid=(9.5, 10.0, 10.5))
FORM = 0.02  # a law that is there moves levels by volts, most of which the rates take back
cause = partial(candidate, form_share=FORM)
CANDIDATES = (
    cause("torricelli", "outflow with the root of the level", "1", 0.0, 1.0, 1.0, fixed=True),
    cause("overflow", "the upper tank runs over, in part into the lower", "1", 0.0, 1.0, 1.0,
              (BRIM, CAUGHT), fixed=True),
    cause("overflow_lower", "the lower tank runs over", "1", 0.0, 1.0, 1.0, (LOWER,),
              fixed=True),
    cause("clipped", "the sensor ends", "1", 0.0, 1.0, 1.0, fixed=True, side="cell"),
    cause("loss", "a further outflow in proportion to level, such as a leak", "1/s", 0.0, 0.05,
              0.002, least=-0.05),
    cause("pump_bent", "a pump that saturates", "1/V", 0.0, 0.1, 0.01, side="drive"),
    cause("delay", "the level is read late", "s", 0.0, 30.0, 2.0, side="clock"),
    cause("sensor_bent", "a sensor that is not straight", "1/V", -0.01, 0.01, 0.002,
              side="cell"),
)  # fmt: skip


class Tanks(Described):
    """The tanks; the test record is kept for the proof. Both records start at one state."""

    name = "cascaded tanks"
    candidates = CANDIDATES
    nuisances = (
        *(Nuisance(rate, FACTOR, "1", step=0.02) for rate in ("out_1", "out_2", "pump")),
        Nuisance("dead", 0.5, "V", step=0.05),
        Nuisance("start_1", 5.0, "V", step=0.05),
        Nuisance("start_2", 0.3, "V", step=0.05),
    )

    def __init__(self, records: tuple[str, ...] = ("train", "test")) -> None:
        self.records = records
        self.end_v = float(record("train")[1].max())  # if the sensor ends, then there
        self.bundles = tuple(bundle for one in records for bundle in self._bundles(one))

    def _bundles(self, name: str) -> tuple[Bundle, ...]:
        y = record(name)[1]
        t_s = np.arange(len(y)) * PERIOD_S
        stretch = Segment(0.0, t_s[-1] + PERIOD_S, sealed=name == "test", name=name)
        seen = ("level", "V", y, NOISE_V), ("repeated", "1", repeated(y), REPEATED)
        return tuple(
            series(name, channel, unit, t_s, value, noise, kind=channel, segments=(stretch,))
            for channel, unit, value, noise in seen
        )

    def predict(self, point: Point) -> Prediction:
        """The level that is read."""
        end = "overflow_lower" in point.effects
        p = np.array([
            OUT_1 * np.exp(self.number(point, "out_1")),
            OUT_2 * np.exp(self.number(point, "out_2")),
            PUMP * np.exp(self.number(point, "pump")), DEAD_V + self.number(point, "dead"),
            self.value(point, "torricelli"), self.value(point, "loss"), np.inf,
            self.value(point, "overflow", "caught"), self.value(point, "pump_bent"),
            self.value(point, "overflow_lower", "brim_v") if end else np.inf,
        ])  # fmt: skip
        if "overflow" in point.effects:
            inflow = p[2] * (self.value(point, "overflow", "brim_v") + p[3])
            level = inflow / p[0]
            p[6] = level**2 / REFERENCE_V if p[4] else level
        return [seen for name in self.records for seen in self._seen(point, p, *record(name))]

    def _seen(self, point: Point, p: Array, u: Array, y: Array) -> Prediction:
        level = run(u, START_1_V + self.number(point, "start_1"),
                    y[0] + self.number(point, "start_2"), p)  # fmt: skip
        t_s = np.arange(len(level)) * PERIOD_S
        level = np.interp(t_s - self.value(point, "delay"), t_s, level)
        level = level + self.value(point, "sensor_bent") * (level - REFERENCE_V) ** 2
        end_v = self.end_v if "clipped" in point.effects else np.inf
        again = (level >= end_v) & (np.roll(level, 1) >= end_v)
        return [np.minimum(level, end_v)[:, None], again.astype(float)[:, None]]
