"""One mass on a spring that is driven or let go, of which anything may be left out: no recording.

It has no tones stated, so that the engine takes it for a system that does not ring. What is
recorded comes from finer steps and from a friction that turns over more sharply than the
description's.
"""

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np

from analysis.engine import Bundle, Nuisance, Point, Segment, Shape
from analysis.engine.array import Array
from analysis.engine.system import Prediction
from tests.validation.shared import Described, candidate

RATE_HZ, COUNT = 20.0, 600
T_S = np.arange(COUNT) / RATE_HZ
STEPS, FINE = 4, 40  # of Runge and Kutta's fourth order, a sample: described, and recorded
SHARP, SHARPER = 0.02, 0.008  # m/s, at which friction turns over
STIFF, DAMPED = (2.0 * np.pi * 0.9) ** 2, 0.8
LAWS = ("cubic", "coulomb", "drag", "dead_zone", "hysteresis", "damper_displaced")


@numba.njit(cache=True)
def rates(y, v, z, u, p):  # type: ignore[no-untyped-def]
    """Of speed and of the hysteretic displacement; p as `numbers` has it."""
    if p[6] > 0.0:
        u = np.sign(u) * max(abs(u) - p[6], 0.0)
    force = p[2] * u - p[0] * y - p[1] * v - p[3] * y**3 - p[5] * v * abs(v) - p[9] * y * y * v
    force -= p[4] * v / np.sqrt(v * v + p[10] * p[10]) + p[7] * (z - y)
    return force, v - 0.5 * p[8] * (abs(v) * z + v * abs(z))


@numba.njit(cache=True)
def run(u, y, v, p, steps):  # type: ignore[no-untyped-def]
    """Position at each sample; the input is straight between samples."""
    h, z = 1.0 / (RATE_HZ * steps), 0.0
    found = np.empty(len(u))
    for i in range(len(u)):
        found[i] = y
        if i == len(u) - 1:
            break
        for s in range(steps):
            a = u[i] + (u[i + 1] - u[i]) * s / steps
            c = u[i] + (u[i + 1] - u[i]) * (s + 1) / steps
            b = 0.5 * (a + c)
            a1, z1 = rates(y, v, z, a, p)
            v2 = v + 0.5 * h * a1
            a2, z2 = rates(y + 0.5 * h * v, v2, z + 0.5 * h * z1, b, p)
            v3 = v + 0.5 * h * a2
            a3, z3 = rates(y + 0.5 * h * v2, v3, z + 0.5 * h * z2, b, p)
            v4 = v + h * a3
            a4, z4 = rates(y + h * v3, v4, z + h * z3, c, p)
            y += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
            v += h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
            z += h * (z1 + 2.0 * z2 + 2.0 * z3 + z4) / 6.0
    return found


def numbers(
    sharp: float, stiff: float = 0.0, damped: float = 0.0, gain: float = 0.0, **on: float
) -> Array:
    """Parameters as shares of what they are thought to be, and laws."""
    laws = [on.get(name, 0.0) for name in LAWS[:5]]
    return np.array(
        [STIFF * (1.0 + stiff), DAMPED * (1.0 + damped), 1.0 + gain, *laws, on.get("beta", 20.0),
         on.get("damper_displaced", 0.0), sharp]
    )  # fmt: skip


def multisine() -> Array:
    """Thirty tones of 0.1 to 3 Hz."""
    draw = np.random.default_rng(3)
    return sum(
        0.8 * np.sin(2.0 * np.pi * (0.1 * k * T_S + draw.uniform())) for k in range(1, 31)
    ) * np.ones(COUNT)


def two_levels() -> Array:
    """A force of one size that changes its sign now and then."""
    draw = np.random.default_rng(5).choice([-4.0, 4.0], COUNT // 8 + 1)
    return np.repeat(draw, 8)[:COUNT]


Start = tuple[float, float]


class Oscillator(Described):
    """The mass, of one record or of several, each with its force and where it starts.

    Parameters
    ----------
    hidden
        Laws and parameters of what is recorded.
    noise_db
        Of the signal over the noise.
    left_out
        Laws that the list has not.
    forces, starts
        Of each record; where it starts is known where it is at rest.
    late_s
        By which it is recorded late.
    """

    name = "oscillator"

    def __init__(
        self,
        hidden: dict[str, float],
        noise_db: float = 40.0,
        left_out: Sequence[str] = (),
        forces: Sequence[Array] = (),
        starts: Sequence[Start] = ((0.0, 0.0),),
    ) -> None:
        self.forces, self.starts = tuple(forces) or (multisine(),) * len(starts), tuple(starts)
        self.nuisances = (
            Nuisance("stiff", 0.03, "1", step=0.1),
            Nuisance("damped", 0.3, "1", step=0.1),
            Nuisance("gain", 0.02, "1", step=0.1),
            *self._starting(),
        )
        self.candidates = tuple(one for one in CANDIDATES if one.name not in left_out)
        draw = np.random.default_rng(len(hidden))
        bundles = []
        for i, (force, (y, v)) in enumerate(zip(self.forces, self.starts, strict=True)):
            off = draw.normal(size=2) * (0.01, 0.05) * bool(y or v)
            seen = run(force, y + off[0], v + off[1], numbers(SHARPER, **hidden), FINE)
            noise = float(np.std(seen)) * 10.0 ** (-noise_db / 20.0)
            seen = seen + noise * draw.normal(size=COUNT)
            stretch = Segment(0.0, COUNT / RATE_HZ, name=f"record {i}")
            bundles.append(
                Bundle(("x",), ("m",), T_S, seen[:, None], np.array([[noise**2]]), (stretch,),
                       record=f"r{i}")
            )  # fmt: skip
        self.bundles = tuple(bundles)

    def _starting(self) -> list[Nuisance]:
        return [
            Nuisance(f"{what}{i}", sigma, unit, step=0.1, record=f"r{i}")
            for i, start in enumerate(self.starts)
            if any(start)
            for what, sigma, unit in (("y", 0.01, "m"), ("v", 0.05, "m/s"))
        ]

    def predict(self, point: Point) -> Prediction:
        """Positions of each record."""
        known: dict[str, Any] = {
            one: self.number(point, one) for one in ("stiff", "damped", "gain")
        }
        listed = {one.name for one in self.candidates}
        known |= {name: self.value(point, name) for name in LAWS if name in listed}
        if "hysteresis" in listed:
            known["beta"] = self.value(point, "hysteresis", "beta")
        p = numbers(SHARP, **known)
        names = {one.name for one in self.nuisances}
        found = []
        for i, (force, (y, v)) in enumerate(zip(self.forces, self.starts, strict=True)):
            own = f"y{i}" in names
            off = [self.number(point, f"{one}{i}") if own else 0.0 for one in "yv"]
            x = run(force, y + off[0], v + off[1], p, STEPS)
            late_s = self.value(point, "delay")
            x = np.interp(T_S - late_s, T_S, x) if late_s else x
            with np.errstate(all="ignore"):  # far out a softening spring lets go
                found.append((x + self.value(point, "sensor_cubic") * x**3)[:, None])
        return found


BETA = Shape("beta", "1/m", 20.0, 2.0, 100.0, grid=(10.0, 40.0))
CANDIDATES = (
    candidate("cubic", "a spring that hardens", "1/m^2 s^2", -200.0, 200.0, 2.0),
    candidate("coulomb", "Coulomb friction", "m/s^2", 0.0, 5.0, 0.1, family="friction"),
    candidate("drag", "drag", "1/m", 0.0, 5.0, 0.1, family="friction"),
    candidate("dead_zone", "a drive that does not answer to little", "m/s^2", 0.0, 3.0, 0.2,
              side="drive"),
    candidate("hysteresis", "a spring that slides", "1/s^2", 0.0, 50.0, 2.0, (BETA,)),
    candidate("damper_displaced", "damping that grows with displacement", "1/m^2 s", 0.0, 50.0,
              1.0, family="friction"),
    candidate("delay", "read late", "s", 0.0, 0.1, 0.004, side="clock", form_share=0.02),
    candidate("sensor_cubic", "a sensor that bends", "1/m^2", -2.0, 2.0, 0.05, side="cell",
              form_share=0.02),
)  # fmt: skip
