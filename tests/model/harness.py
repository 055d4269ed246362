"""The laws of one effect under a prescribed motion of its cable or platform."""

import math
from functools import cache
from inspect import signature

import numpy as np

from model.library.effect import Effect

STIFFNESS = 1410.0
PRETENSION = 11.0
STEPS = 1600
"""In a cycle."""


class Response:
    """One cycle of an effect's force, in phase with x and in quadrature (with x')."""

    def __init__(self, force: np.ndarray, rate: np.ndarray, circular: float) -> None:
        self.force, self.rate = force, rate
        line = np.fft.rfft(force) / force.size
        self.mean = line[0].real
        # x = A sin: the sine part is in phase, the cosine part goes with the velocity.
        self.in_phase, self.quadrature = -2.0 * line.imag, 2.0 * line.real
        self.size = 2.0 * np.abs(line)
        self.work = float(np.mean(force * rate) * 2.0 * np.pi / circular)

    def share(self, harmonic: int) -> float:
        """A harmonic against the first."""
        return float(self.size[harmonic] / self.size[1])


@cache
def arguments(law) -> tuple[str, ...]:
    return tuple(signature(law).parameters)


def call(law, known: dict):
    return law(**{name: known[name] for name in arguments(law)})


def cable_response(
    effect: Effect,
    values: dict | None = None,
    amplitude_m: float = 5e-3,
    frequency_hz: float = 2.0,
    cycles: int = 3,
    hook: str = "pull",
    pretension: float = PRETENSION,
) -> Response:
    """The last of some cycles of x = A sin(2 pi f t), the states followed by Heun's rule."""
    numbers = {one.name: one.default for one in effect.parameters} | (values or {})
    circular = 2.0 * np.pi * frequency_hz
    names = [state.name for state in effect.states]
    state = np.zeros(len(names))
    dt = 1.0 / (frequency_hz * STEPS)
    force, rate = np.zeros((2, STEPS))
    along, across = (0.6, 0.0, 0.8), (-0.8, 0.0, 0.6)

    def known(time_s: float, state: np.ndarray) -> dict:
        x = amplitude_m * math.sin(circular * time_s)
        v = amplitude_m * circular * math.cos(circular * time_s)
        elastic = max(pretension + STIFFNESS * x, 0.0)
        anchor = [(side - line) * v for side, line in zip(across, along, strict=True)]
        base = {
            "length": 2.0 + x,
            "rest_length": 2.0,
            "elongation": x,
            "elongation_rate": v,
            "axial_velocity": v,
            "direction_x": along[0],
            "direction_y": along[1],
            "direction_z": along[2] + 5.0 * x,
            "rest_direction_x": along[0],
            "rest_direction_y": along[1],
            "rest_direction_z": along[2],
            "anchor_velocity_x": anchor[0],
            "anchor_velocity_y": anchor[1],
            "anchor_velocity_z": anchor[2],
            "elastic": elastic,
            "before_pulley": elastic,
            "stiffness": STIFFNESS,
            "pretension": pretension,
            "line_density": 9e-3,
            "damping": 4.0,
            "gravity": 9.8,
            "post_share": 1.0,
        }
        base |= numbers | dict(zip(names, state, strict=True))
        added = call(effect.pull, base) if effect.pull else 0.0
        return base | {"tension": max(elastic + added, 0.0)}

    def rates(time_s: float, state: np.ndarray) -> np.ndarray:
        if effect.rates is None:
            return np.zeros(0)
        return np.atleast_1d(np.array(call(effect.rates, known(time_s, state)), dtype=float))

    for n in range(cycles * STEPS):
        time_s = n * dt
        if n >= (cycles - 1) * STEPS:
            now = known(time_s, state)
            row = n - (cycles - 1) * STEPS
            force[row], rate[row] = call(getattr(effect, hook), now), now["axial_velocity"]
        first = rates(time_s, state)
        state = state + 0.5 * dt * (first + rates(time_s + dt, state + dt * first))
    return Response(force, rate, circular)


def platform_response(effect: Effect, amplitude: float = 0.02, frequency_hz: float = 2.0):
    """The moment about Y under pitch = A sin(2 pi f t), with the force along X under x the same."""
    numbers = {one.name: one.default for one in effect.parameters}
    circular = 2.0 * np.pi * frequency_hz
    phase = 2.0 * np.pi * np.arange(STEPS) / STEPS
    x, v = amplitude * np.sin(phase), amplitude * circular * np.cos(phase)
    names = ("x", "y", "z", "roll", "pitch", "yaw")
    known = dict.fromkeys(names, 0.0 * x) | {"x": x, "pitch": x}
    for vector in ("velocity", "omega"):
        known |= {f"{vector}_{axis}": 0.0 * v for axis in "xyz"}
    known |= {"velocity_x": v, "omega_y": v}
    wrench = call(effect.wrench, known | numbers)
    return Response(wrench[0], v, circular), Response(wrench[4], v, circular)
