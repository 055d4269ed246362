"""How far a machine is from the published figures, and from a machine one would build.

A misfit is a sum of terms none of which is negative, the cheap ones first: a search that already
knows better stops it early.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from cdpr8 import STANDARD_GRAVITY_M_PER_S2
from cdpr8.errors import RigFileError
from cdpr8.rigfile.schema import Rig
from model.library.lanes import LANES
from model.machine import Machine
from model.reconstruct.layout import Layout, reach
from model.reconstruct.published import (
    EXACT,
    LARGE_CABLE_5_MM,
    LOW_HZ,
    PEAKS_HZ,
    QUIET_LIMITS,
    SMALL_LIMITS,
    STIFFNESS_N_PER_M,
    VIOLENT,
    Figure,
    Quantity,
)
from model.reconstruct.quick import EXACT_OUTPUT_HZ, Amplitudes, Case, run
from model.sweep.paper import EXCITATION

Array = NDArray[np.float64]

BAR = float(np.log(1.10))
"""10 %: a violent figure this far off costs 1."""

SMALL_HZ = (17.0, 20.0, 18.5, 19.25, 17.75)
"""Where the vibration is small again."""

QUIET_HZ = (
    *(8.0, 7.0, 5.0, 6.0, 7.5, 5.5, 6.5, 4.5, 5.25, 5.75, 7.25, 6.75, 6.25, 7.75),
    *(4.75, 4.25, 4.0, 3.5, 3.0, 2.5),
)
"""Where nothing may vibrate, the likeliest to fail first: a cable's own tone is a tongue too, and a
narrow one, so the steps are those of the sweep."""

STILL_HZ = (*SMALL_HZ, *QUIET_HZ)

BETWEEN_HZ: dict[float, tuple[float, ...]] = {
    12.0: PEAKS_HZ,
    11.0: PEAKS_HZ[:1],
    13.0: PEAKS_HZ[1:],
    9.0: PEAKS_HZ[:1],
    15.0: PEAKS_HZ[1:],
    16.0: PEAKS_HZ[1:],
}
"""Frequencies in the violent band, with the peaks they must stay below."""

PRINT_MARGIN = 0.003
"""Deg or N: a value this close to its figure prints like it, whatever else moves a little."""

RECORDED = EXCITATION.model_copy(
    update={"rest_s": 1.0, "motion_start_s": None, "motion_s": 12.0, "ramp_s": 0.5}
)
"""The kind of motion a rig records, from rest and with ramps: its figures are to be the same."""

LEAST_TENSION_N = 1.0
"""In the 2.06 Hz test: every cable stays taut (Section 3.2)."""

CABLES_PER_PLATFORM = 0.25
"""Mass of the eight cables as a share of the platform's that is still light."""

SAG_LIMIT = 1.0
"""Irvine's lambda^2, (rho g L / T)^2 k L / T: beyond about 1 sag softens a cable noticeably."""

REFUSED = 1e4
"""Cost of what is no machine at all."""

START_SPREAD = 0.1
"""Each offset of a repetition is changed by up to this share: what chaos makes of it is counted."""


@dataclass
class Misfit:
    """A machine judged.

    Parameters
    ----------
    layout
        The machine, its anchors placed.
    cost
        The sum of the terms counted so far.
    terms
        What each cost.
    figures
        Median of each published quantity over the repetitions, by frequency.
    complete
        False where counting stopped early.
    """

    layout: Layout
    cost: float = 0.0
    terms: dict[str, float] = field(default_factory=dict)
    figures: dict[float, dict[str, float]] = field(default_factory=dict)
    complete: bool = False


@dataclass(frozen=True)
class Judge:
    """What a machine is judged by.

    Parameters
    ----------
    pattern
        A rig with the published stiffnesses; all else that is mechanical is replaced.
    repetitions
        Runs at each peak; the first has the paper's offsets, the others changed ones.
    seed
        Of the changes.
    """

    pattern: Rig
    repetitions: int = 3
    seed: int = 0

    def __post_init__(self) -> None:
        found = tuple(cable.stiffness_n_per_m.value for cable in self.pattern.cable)
        if found != STIFFNESS_N_PER_M:
            raise RigFileError(
                f"the rig {self.pattern.name!r} has stiffnesses {found} N/m",
                allowed=f"the published ones, {STIFFNESS_N_PER_M}",
            )

    def judge(self, layout: Layout, enough: float = np.inf) -> Misfit:
        """Count the terms until they are more than enough."""
        misfit = Misfit(layout)
        for name, cost in self._terms(misfit):
            misfit.cost += cost
            misfit.terms[name] = misfit.terms.get(name, 0.0) + cost
            if misfit.cost > enough or misfit.cost >= REFUSED:
                return misfit
        misfit.complete = True
        return misfit

    def _terms(self, misfit: Misfit) -> Iterator[tuple[str, float]]:
        placed = self._placed(misfit.layout)
        if placed is None:
            yield "no machine", REFUSED
            return
        misfit.layout, low = placed
        rig = misfit.layout.rig(self.pattern)
        yield from _weak_points(Machine.from_rig(rig))
        yield from _low_frequency(low)
        misfit.figures[LOW_HZ] = _values(low)
        for frequency in PEAKS_HZ:
            first = run(rig, [Case(frequency)])[0]
            rough = _violent(frequency, _values(first))
            # A first look, a third of the weight: most candidates end here.
            yield f"{frequency:g} Hz, first", sum(rough.values()) / 3.0
        starts = [self._change(repetition) for repetition in range(self.repetitions)]
        peaks = [Case(frequency, change) for frequency in PEAKS_HZ for change in starts]
        found = run(rig, [*peaks, *(Case(frequency) for frequency in BETWEEN_HZ)])
        for number, frequency in enumerate(PEAKS_HZ):
            several = found[number * len(starts) : (number + 1) * len(starts)]
            values = _median([_values(one) for one in several])
            misfit.figures[frequency] = values
            for name, cost in _violent(frequency, values).items():
                yield f"{frequency:g} Hz, {name}", cost
            shortfall = _beyond(LARGE_CABLE_5_MM, values["cable_5_mm"])
            yield f"{frequency:g} Hz, cable_5_mm", 0.5 * shortfall
        yield from self._beside_the_peaks(misfit, BETWEEN_HZ, found[len(peaks) :])
        for some in (STILL_HZ[:LANES], STILL_HZ[LANES:]):
            found = run(rig, [Case(frequency) for frequency in some])
            yield from self._beside_the_peaks(misfit, some, found)
        recorded = run(rig, [Case(LOW_HZ, excitation=RECORDED)], EXACT_OUTPUT_HZ)[0]
        yield "2.06 Hz, recorded kind", _off_print(recorded)

    def _beside_the_peaks(
        self, misfit: Misfit, frequencies: Iterable[float], found: Sequence[Amplitudes]
    ) -> Iterator[tuple[str, float]]:
        for frequency, amplitudes in zip(frequencies, found, strict=True):
            values = _values(amplitudes)
            misfit.figures[frequency] = values
            for name, limit in self._limits(misfit, frequency).items():
                yield f"{frequency:g} Hz, {name}", _beyond(values[name], limit)

    def _limits(self, misfit: Misfit, frequency: float) -> dict[Quantity, float]:
        """What the amplitudes away from the peaks must stay below."""
        if frequency in SMALL_HZ:
            return SMALL_LIMITS
        if frequency not in BETWEEN_HZ:
            return QUIET_LIMITS
        peaks = [misfit.figures[peak] for peak in BETWEEN_HZ[frequency]]
        return {name: 0.95 * min(peak[name] for peak in peaks) for name in QUIET_LIMITS}

    def _placed(self, layout: Layout) -> tuple[Layout, Amplitudes] | None:
        """The layout with its anchors where they give the published tension variations."""
        pitch, first, seventh = (figure.value for figure in EXACT)
        wanted = np.array([first, seventh])
        aim = wanted.copy()
        low = None
        for _ in range(3):
            angle = float(np.deg2rad(pitch))
            front = reach(layout, 0, STIFFNESS_N_PER_M[0], angle, float(aim[0]))
            rear = reach(layout, 6, STIFFNESS_N_PER_M[6], angle, float(aim[1]))
            layout = replace(layout, front_x=front, rear_x=rear)
            if not (np.isfinite(front) and np.isfinite(rear) and layout.pretension.min() > 0.5):
                return None
            low = run(layout.rig(self.pattern), [Case(LOW_HZ)], EXACT_OUTPUT_HZ)[0]
            found = np.array([low.tension_1_n, low.tension_7_n])
            if not low.sound or np.abs(np.log(found / wanted)).max() > 0.5:
                return None
            if np.abs(found - wanted).max() < 0.002:
                break
            aim *= wanted / found
        assert low is not None
        return layout, low

    def _change(self, repetition: int) -> Array | float:
        """By what share the offsets of a repetition differ: those of the first do not."""
        if repetition == 0:
            return 0.0
        seed = np.random.SeedSequence(self.seed, spawn_key=(repetition,))
        return np.random.default_rng(seed).uniform(-START_SPREAD, START_SPREAD, 9)


def _median(several: Sequence[dict[str, float]]) -> dict[str, float]:
    """Of each quantity."""
    return {name: float(np.median([one[name] for one in several])) for name in several[0]}


def _values(amplitudes: Amplitudes) -> dict[str, float]:
    """The published quantities."""
    return {name: float(getattr(amplitudes, name)) for name in get_args(Quantity)}


def _weak_points(machine: Machine) -> Iterator[tuple[str, float]]:
    """What a machine should not be, though it could."""
    length = machine.rest_length
    share = float(machine.line_density @ length) / machine.mass
    yield "heavy cables", 5.0 * max(0.0, float(np.log(share / CABLES_PER_PLATFORM)))
    weight = machine.line_density * STANDARD_GRAVITY_M_PER_S2 * length
    sag = (weight / machine.pretension) ** 2 * machine.stiffness * length / machine.pretension
    yield "sag", 2.0 * max(0.0, float(np.log(sag.max() / SAG_LIMIT)))


def _low_frequency(low: Amplitudes) -> Iterator[tuple[str, float]]:
    yield "2.06 Hz, exact figures", _off_print(low)
    yield "2.06 Hz, least tension", 2.0 * max(0.0, LEAST_TENSION_N - low.min_tension_n)
    for name, limit in QUIET_LIMITS.items():
        yield f"2.06 Hz, {name}", _beyond(getattr(low, name), limit)


def _off_print(low: Amplitudes) -> float:
    """Cost of figures that would not print as published."""
    cost = 0.0
    for figure in EXACT:
        off = max(0.0, abs(getattr(low, figure.quantity) - figure.value) - PRINT_MARGIN)
        cost += (1e3 * off) ** 2 if off < 1e-2 else 100.0 + off
    return cost


def _violent(frequency_hz: float, values: dict[str, float]) -> dict[str, float]:
    """Cost of each published figure at a peak: squares near it, growing slower far off."""
    return {
        figure.quantity: _cost(figure, values[figure.quantity])
        for figure in VIOLENT
        if figure.frequency_hz == frequency_hz
    }


def _beyond(value: float, limit: float) -> float:
    """Cost of being above a limit."""
    return 8.0 * max(0.0, float(np.log(value / limit)))


def _cost(figure: Figure, value: float) -> float:
    off = abs(float(np.log(max(value, 1e-9) / figure.value))) / BAR
    return off**2 if off < 5.0 else 10.0 * off - 25.0
