"""Sines: one, or many with random phases."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from model.motion import Command
from model.motions.pose import Pose
from model.motions.windowed import Times, Windowed

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Multisine(Windowed):
    """A sum of sines along one direction of the six; with one of them, a sine.

    Parameters
    ----------
    direction
        What the sum is multiplied by: m and rad.
    frequencies_hz, weights, phases_rad
        Of each sine.
    """

    direction: Pose
    frequencies_hz: tuple[float, ...]
    weights: tuple[float, ...]
    phases_rad: tuple[float, ...]

    def __post_init__(self) -> None:
        counts = {len(self.frequencies_hz), len(self.weights), len(self.phases_rad)}
        if len(counts) > 1 or not self.frequencies_hz or min(self.frequencies_hz) <= 0:
            raise UsageError(
                f"sines at {self.frequencies_hz} Hz with {len(self.weights)} weights and "
                f"{len(self.phases_rad)} phases",
                allowed="at least one frequency, all above 0, with a weight and a phase each",
            )

    @classmethod
    def sine(
        cls,
        direction: Pose,
        frequency_hz: float,
        phase_rad: float = 0.0,
        times: Times | None = None,
    ) -> Self:
        """One sine about any axis or along any direction."""
        return cls(direction, (frequency_hz,), (1.0,), (phase_rad,), times=times or Times())

    @classmethod
    def odd_random_phase(
        cls,
        direction: Pose,
        base_hz: float,
        highest_hz: float,
        generator: np.random.Generator,
        times: Times | None = None,
    ) -> Self:
        """Odd harmonics of a base frequency, equally strong, with random phases.

        Only odd lines are driven, so that what answers at even ones is an even nonlinearity
        (Pintelon and Schoukens, System Identification, 2012, Section 4.3). The largest value over
        a period is that of `direction`.
        """
        if not 0 < base_hz <= highest_hz:
            raise UsageError(
                f"base {base_hz:g} Hz, highest {highest_hz:g} Hz", allowed="0 < base <= highest"
            )
        harmonics = np.arange(1, int(highest_hz / base_hz + 1e-9) + 1, 2)
        phases = generator.uniform(0.0, 2.0 * np.pi, harmonics.size)
        period = np.linspace(0.0, 2.0 * np.pi, 64 * int(harmonics[-1]), endpoint=False)
        largest = np.abs(np.sin(np.outer(period, harmonics) + phases).sum(axis=1)).max()
        return cls(
            direction,
            tuple(float(base_hz * harmonic) for harmonic in harmonics),
            (float(1.0 / largest),) * harmonics.size,
            tuple(map(float, phases)),
            times=times or Times(),
        )

    def shape(self, tau: Array) -> Command:
        """The sum and its derivatives."""
        value, rate, acceleration = np.zeros((3, *tau.shape))
        for frequency, weight, phase in zip(
            self.frequencies_hz, self.weights, self.phases_rad, strict=True
        ):
            circular = 2.0 * np.pi * frequency
            sine, cosine = np.sin(circular * tau + phase), np.cos(circular * tau + phase)
            value += weight * sine
            rate += weight * circular * cosine
            acceleration -= weight * circular**2 * sine
        towards = np.array(self.direction)
        return (
            value[..., None] * towards,
            rate[..., None] * towards,
            acceleration[..., None] * towards,
        )
