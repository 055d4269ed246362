"""What is reported of a system that does not ring is where it fits best, all numbers together.

Data come of SciPy's solver; what is fitted is simulated by Heun's rule.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from analysis.engine import Bundle, Candidate, Nuisance, Point, Segment, Shape, Term, diagnose
from analysis.engine.diagnosis import Diagnosis
from analysis.engine.system import Prediction

Array = NDArray[np.float64]

T_S = np.arange(0.0, 7200.0, 20.0)
TURNED_S = np.arange(0.0, 60.0, 0.1)
MOMENTS_S = tuple(np.arange(5.0, 56.0, 5.0))
STEPS = 5
"""Of the simulator, between two samples."""

NOISE_K = 0.05
SWITCHED_S = np.array([0.0, 400.0, 1500.0, 2100.0, 3000.0, 3400.0, 4200.0, 4800.0, 5600.0, 6300.0])
POWER_W = np.array([0.0, 60.0, 20.0, 80.0, 40.0, 0.0, 70.0, 30.0, 90.0, 10.0])
CAPACITY_J_K, LOSS_W_K, ENDS_K = 800.0, 0.8, 70.0


def power(time_s: Array) -> Array:
    return np.asarray(POWER_W[np.searchsorted(SWITCHED_S, time_s + 1e-9, side="right") - 1])


HEAT_W = power(np.arange(len(T_S) * STEPS) * (T_S[1] / STEPS))


def cause(name: str, side: Any, high: float, step: float, **more: Any) -> Candidate:
    return Candidate(name, name, side, (Term(name, name, "1", "", 0.0, high, step),), **more)


class Simulated(ABC):
    """Samples by a function of the numbers, by name."""

    nuisances: tuple[Nuisance, ...]
    candidates: tuple[Candidate, ...]
    bundles: tuple[Bundle, ...]

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        return [reduce([self.samples(self._numbers(one))[:, None]]) for one in points]

    @abstractmethod
    def samples(self, numbers: dict[str, float]) -> Array:
        """What is recorded without noise, shape (n,), by name of number."""

    def _numbers(self, point: Point) -> dict[str, float]:
        pairs = zip(self.nuisances, point.nuisance, strict=True)
        found = {one.name: one.sigma * float(x) for one, x in pairs}
        for name, setting in point.effects.items():
            found |= {name: setting.values[name], **setting.shapes}
        return found

    def record(self, t_s: Array, value: Array, noise: float) -> None:
        ends = 0.67 * t_s[-1], float(t_s[-1])
        parts = (
            Segment(0.0, ends[0], name="first"),
            Segment(*ends, held_out=True, name="last"),
        )
        self.bundles = (Bundle(("x",), ("1",), t_s, value[:, None], np.array([[noise**2]]), parts),)


class Heated(Simulated):
    """A heated body. Power, capacity and losses, all larger by one share, change nothing."""

    name = "heated body"
    nuisances = (
        Nuisance("capacity", 0.05, "1"),
        Nuisance("loss", 0.1, "1"),
        Nuisance("power", 0.02, "1"),
        Nuisance("ambient", 0.5, "K"),
    )
    candidates = (
        cause("convection", "plant", 0.5, 0.02, form_share=0.05),
        cause(
            "ends", "cell", 1.0, 1.0, fixed=True, form_share=0.05,
            shapes=(Shape("at_k", "K", 80.0, 50.0, 95.0, (60.0, 70.0, 80.0, 90.0), False),),
        ),
    )  # fmt: skip

    def __init__(self) -> None:
        def rate(t_s: float, x: Array) -> Array:
            above = float(x[0]) - 20.2
            lost = 0.76 * above + 0.06 * np.sign(above) * abs(above) ** 1.27
            return np.array([(0.99 * power(np.array([t_s]))[0] - lost) / 820.0])

        found = solve_ivp(rate, (0.0, T_S[-1]), [20.2], t_eval=T_S, rtol=1e-9, max_step=20.0)
        noise = np.random.default_rng(3).normal(0.0, NOISE_K, len(T_S))
        self.record(T_S, np.minimum(found.y[0], ENDS_K) + noise, NOISE_K)

    def samples(self, numbers: dict[str, float]) -> Array:
        found = body(
            HEAT_W * (1.0 + numbers["power"]),
            LOSS_W_K * (1.0 + numbers["loss"]),
            CAPACITY_J_K * (1.0 + numbers["capacity"]),
            20.0 + numbers["ambient"],
            numbers.get("convection", 0.0),
        )
        return np.minimum(found, numbers["at_k"] if "ends" in numbers else np.inf)


@numba.njit
def body(heat, loss, capacity, ambient, convection):  # type: ignore[no-untyped-def]
    """Temperature of each sample [K over freezing]; heat in W, of each step."""
    h, found, x = 20.0 / STEPS, np.empty(len(heat) // STEPS), ambient
    for i in range(len(heat)):
        if i % STEPS == 0:
            found[i // STEPS] = x
        rate = np.zeros(2)
        for k in range(2):
            y = x + h * rate[0] * k
            above = y - ambient
            lost = loss * above + convection * np.copysign(np.abs(above) ** 1.25, above)
            rate[k] = (heat[i] - lost) / capacity
        x += 0.5 * h * (rate[0] + rate[1])
    return found


class Loaded(Simulated):
    """A flywheel, its friction, and a load from a moment on that the grid does not hold."""

    name = "flywheel"
    nuisances = (Nuisance("inertia", 0.02, "1"), Nuisance("damper", 0.05, "1"))
    candidates = (
        cause("coulomb", "plant", 0.5, 0.02, form_share=0.02),
        cause(
            "load", "plant", 0.5, 0.02, form_share=0.02,
            shapes=(Shape("from_s", "s", 30.0, 2.0, 58.0, MOMENTS_S, False),),
        ),
    )  # fmt: skip

    def __init__(self) -> None:
        def rate(t_s: float, v: Array) -> Array:
            held = 0.1 * np.tanh(v / 0.02) + 0.1 * (t_s > 31.7)
            return np.asarray((torque(t_s) - 0.97 * v - held) / 1.01)

        found = solve_ivp(rate, (0.0, 60.0), [0.0], t_eval=TURNED_S, rtol=1e-9, max_step=0.02)
        noise = np.random.default_rng(4).normal(0.0, 1e-3, len(TURNED_S))
        self.record(TURNED_S, found.y[0] + noise, 1e-3)

    def samples(self, numbers: dict[str, float]) -> Array:
        return np.asarray(
            flywheel(
                1.0 + numbers["inertia"],
                1.0 + numbers["damper"],
                numbers.get("coulomb", 0.0),
                numbers.get("load", 0.0),
                numbers.get("from_s", 1e9),
            )
        )


class Heavier(Loaded):
    """The flywheel with inertia to spare, which may be a cause as well."""

    nuisances = (
        Nuisance("inertia", 0.02, "1", cause="added", term="added"),
        Nuisance("damper", 0.05, "1"),
    )
    candidates = (
        *Loaded.candidates,
        cause("added", "parameter", 0.5, 0.02, form_share=0.02),
    )

    def __init__(self, added: float, coulomb: float) -> None:
        def rate(t_s: float, v: Array) -> Array:
            held = coulomb * np.tanh(v / 0.01)
            return np.asarray((torque(t_s) - 0.97 * v - held) / (1.01 + added))

        found = solve_ivp(rate, (0.0, 60.0), [0.0], t_eval=TURNED_S, rtol=1e-9, max_step=0.02)
        noise = np.random.default_rng(5).normal(0.0, 1e-4, len(TURNED_S))
        self.record(TURNED_S, found.y[0] + noise, 1e-4)

    def samples(self, numbers: dict[str, float]) -> Array:
        inertia = numbers["inertia"] + numbers.get("added", 0.0)
        return super().samples({**numbers, "inertia": inertia})


@numba.njit
def torque(t_s):  # type: ignore[no-untyped-def]
    """What drives the flywheel [N m]."""
    return 1.0 + 0.8 * np.sin(0.9 * t_s) + 0.5 * np.sin(0.23 * t_s)


@numba.njit
def flywheel(inertia, damper, coulomb, load, since):  # type: ignore[no-untyped-def]
    """Speed of each sample [rad/s]; a step that the load begins in has its share of it."""
    h, v, found = 0.1 / STEPS, 0.0, np.empty(600)
    for i in range(600 * STEPS):
        if i % STEPS == 0:
            found[i // STEPS] = v
        share = min(max(((i + 1) * h - since) / h, 0.0), 1.0)
        rate = np.zeros(2)
        for k in range(2):
            w = v + h * rate[0] * k
            held = coulomb * np.tanh(w / 0.01) + load * share
            rate[k] = (torque((i + k) * h) - damper * w - held) / inertia
        v += 0.5 * h * (rate[0] + rate[1])
    return found


@pytest.fixture(scope="module")
def heated() -> Diagnosis:
    return diagnose(Heated())


def test_what_a_dominant_law_hides_is_led_to_where_it_fits(heated: Diagnosis) -> None:
    assert heated.judgement is not None
    causes = {one.name: one for one in heated.judgement.causes}
    assert heated.verdict == "explained"
    assert set(causes) == {"ends", "convection"}
    assert causes["ends"].shapes["at_k"] == pytest.approx(ENDS_K, abs=0.1)
    assert heated.remains is not None
    assert heated.remains.misfit < 1.15


def test_parameters_that_nothing_tells_stay_where_they_are_likeliest(heated: Diagnosis) -> None:
    assert heated.judgement is not None
    assert np.abs(heated.judgement.chosen.point.nuisance).max() < 1.5


def test_a_moment_that_was_screened_at_a_wrong_one_is_found_beside_another_law() -> None:
    found = diagnose(Loaded())
    assert found.judgement is not None
    causes = {one.name: one for one in found.judgement.causes}
    assert found.verdict == "explained"
    assert set(causes) == {"coulomb", "load"}
    assert causes["load"].shapes["from_s"] == pytest.approx(31.7, abs=0.1)
    for one in causes.values():
        assert one.values[one.name] == pytest.approx(0.1, abs=4.0 * one.sigmas[one.name])


@pytest.mark.parametrize("coulomb", [0.0, 0.1])
def test_a_number_that_moved_seven_sigmas_is_a_cause_alone_and_beside_another(
    coulomb: float,
) -> None:
    """To first order inertia does all that is recorded: an error of form of it would hide all."""
    found = diagnose(Heavier(0.13, coulomb))
    assert found.judgement is not None
    causes = {one.name: one for one in found.judgement.causes}
    assert set(causes) == ({"added", "coulomb"} if coulomb else {"added"})
    assert found.verdict == ("explained" if coulomb else "parameter")
    # What is known of the nuisance is what is known of the cause.
    assert causes["added"].sigmas["added"] == pytest.approx(0.02, rel=0.05)
    assert causes["added"].values["added"] == pytest.approx(0.14, abs=2e-3)
    assert found.judgement.chosen.point.nuisance[0] == pytest.approx(0.0, abs=0.1)
