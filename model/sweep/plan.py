"""What a sweep runs: frequencies, and at each several starts that differ a little.

Where vibration is large it is chaotic, and a number from one run is a number from one run. So each
frequency is run again with every initial offset changed a little and with half the step: median and
range over these is what the model says.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cdpr8.errors import UsageError
from cdpr8.rigfile.excitation import Excitation

MOST_RUNS = 1_000_000


@dataclass(frozen=True)
class Plan:
    """A sweep.

    Parameters
    ----------
    excitation
        The motion; its frequency is replaced.
    frequencies_hz
        At which.
    repetitions
        Runs at each frequency. The first is the excitation's own; of the others each offset
        (X_p0, and X_w0 of every cable) is multiplied by 1 + a draw within `spread`, and every
        second one takes half the step.
    spread
        Largest change of an offset, as a share of it.
    seed
        Of the draws.
    method, step_s
        As for `model.simulate`.
    """

    excitation: Excitation
    frequencies_hz: tuple[float, ...]
    repetitions: int = 1
    spread: float = 0.1
    seed: int = 0
    method: str = "dop853"
    step_s: float | None = None

    def __post_init__(self) -> None:
        runs = len(self.frequencies_hz) * self.repetitions
        if not 1 <= runs <= MOST_RUNS:
            raise UsageError(
                f"{len(self.frequencies_hz)} frequencies with {self.repetitions} runs each",
                allowed=f"1 to {MOST_RUNS} runs in all",
            )
        if min(self.frequencies_hz) <= 0 or not 0 <= self.spread < 1:
            raise UsageError(
                f"frequencies from {min(self.frequencies_hz)} Hz, spread {self.spread}",
                allowed="frequencies above 0, a spread of at least 0 and below 1",
            )

    def jobs(self) -> list[dict[str, Any]]:
        """One entry a run; runs of one step stand together, so that a block of them is alike."""
        return [
            {"frequency_hz": frequency, "repetition": repetition}
            for halved in (False, True)
            for frequency in self.frequencies_hz
            for repetition in range(self.repetitions)
            if takes_half_step(repetition) is halved
        ]

    def identity(self) -> dict[str, Any]:
        """What decides the rows, beside the rig."""
        return {
            "excitation": self.excitation.model_dump(mode="json", exclude={"frequency_hz"}),
            "frequencies_hz": list(self.frequencies_hz),
            "repetitions": self.repetitions,
            "spread": self.spread,
            "method": self.method,
            "step_s": self.step_s,
        }


def takes_half_step(repetition: int) -> bool:
    """Every second run: a result that hangs on the step shows in the range."""
    return repetition % 2 == 1


def grid(first_hz: float, last_hz: float, points: int) -> tuple[float, ...]:
    """Evenly spaced frequencies, ends included.

    Raises
    ------
    UsageError
        The ends are not in order, or there are too few points.
    """
    if not 0 < first_hz <= last_hz or points < 1 or (points == 1 and first_hz != last_hz):
        raise UsageError(
            f"{points} points from {first_hz} to {last_hz} Hz",
            allowed="0 < first <= last, and at least 2 points where they differ",
        )
    return tuple(float(f"{value:.6g}") for value in np.linspace(first_hz, last_hz, points))
