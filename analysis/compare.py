"""The paper's Section 5: a run against the simulation of its own excitation."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analysis.align import find_start_shift
from analysis.noise import amplitude_interval
from analysis.series import Series, measured_angle, measured_cables, measured_tension
from analysis.sine_fit import SineFit, fit_sine, phase_at
from analysis.spectrum import Line, SampleTimes
from cdpr8.errors import DataError
from cdpr8.rigfile import Rig
from cdpr8.runfolder import Run

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]

SHOWN_CABLES = (1, 7)
"""The cables the paper takes as examples; the others follow after them."""

MIN_PERIODS = 2.0
"""A steady window shorter than this has no amplitude to speak of."""


@dataclass(frozen=True)
class Quantity:
    """One quantity, simulated and measured, over the steady window.

    Attributes
    ----------
    measured
        The recorded series over the whole run.
    simulated_t_s, simulated
        The simulated series over the whole run, on the recording's time, shape (m,).
    simulated_amplitude, measured_amplitude
        The paper's amplitude: max of the absolute variation about rest; the simulated one over
        the 1 kHz grid, the measured one over its samples.
    simulated_sine, measured_sine
        Sine fits; the simulated one at the measured sample times.
    noise_low, noise_high
        Where the measured amplitude would lie if the simulation were the truth.
    delay_s, sigma_delay_s
        By how much the recording lags the simulation at the drive's frequency.
    simulated_lines, measured_lines
        Spectral lines at the measured sample times, so that aliases are alike.
    """

    measured: Series
    simulated_t_s: Array
    simulated: Array
    simulated_amplitude: float
    measured_amplitude: float
    simulated_sine: SineFit
    measured_sine: SineFit
    noise_low: float
    noise_high: float
    delay_s: float
    sigma_delay_s: float
    simulated_lines: tuple[Line, ...]
    measured_lines: tuple[Line, ...]

    @property
    def difference(self) -> float:
        """Simulated less measured amplitude."""
        return self.simulated_amplitude - self.measured_amplitude

    @property
    def relative_error(self) -> float:
        """The paper's |simulated - measured| / measured."""
        return abs(self.difference) / self.measured_amplitude

    @property
    def exceeds_noise(self) -> bool:
        """Whether noise and sampling alone cannot make the measured amplitude."""
        return not self.noise_low <= self.measured_amplitude <= self.noise_high


@dataclass(frozen=True)
class Comparison:
    """A run against its simulation.

    Attributes
    ----------
    run
        The recording.
    rig_name
        Which rig file was simulated.
    angle
        The moved angle.
    tensions
        Cable number -> its tension.
    window_s
        The steady window, in which amplitudes are taken.
    start_shift_s
        By how much the simulation was moved; 0 where the run knows when its motion started.
    outcome
        How the simulation ended, in words.
    warnings
        What a reader of the numbers must know.
    """

    run: Run
    rig_name: str
    angle: Quantity
    tensions: dict[int, Quantity]
    window_s: tuple[float, float]
    start_shift_s: float
    outcome: str
    warnings: tuple[str, ...]

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """All of them, the angle first."""
        return (self.angle, *self.tensions.values())


def compare(
    run: Run,
    pose: "pd.DataFrame",
    rig: Rig | None = None,
    *,
    rig_name: str = "rig.toml of the run",
    notes: Sequence[str] = (),
    seed: int = 0,
) -> Comparison:
    """Simulate a run's excitation and compare, by the definitions of the paper's Section 5.

    Parameters
    ----------
    run
        The recording.
    pose
        Columns of pose.csv.
    rig
        The machine to simulate; None takes the run's own. The drive is always made for the run's
        own rig file (design, section 4).
    rig_name
        What to call `rig`.
    notes
        What was noticed on the way to `pose`; joins the warnings.
    seed
        Of the draws that tell what noise allows.

    Raises
    ------
    DataError
        The run has no motion, too short a motion, or nothing measured in it.
    """
    from analysis.diagnosis.onset import as_it_moved
    from model import simulate

    if run.start.excitation.amplitude_deg == 0.0:
        raise DataError(
            "the run has no motion: its amplitude is 0 deg",
            where=str(run.folder / "start.json"),
            remedy="compare a run that was excited",
        )
    run, moved = as_it_moved(run, pose) if run.start.motion_start_known else (run, [])
    excitation = run.start.excitation
    warnings = [*run.notes, *notes, *_warnings(run, rig), *moved]
    simulation = simulate(rig or run.rig, excitation, nominal=run.rig)
    angle = measured_angle(run, pose, excitation.axis)
    cables = measured_cables(run)
    if not cables:
        raise DataError("no cable has usable tension samples", where=str(run.folder))
    tensions = {cable: measured_tension(run, cable) for cable in cables}
    restless = [one.name for one in (angle, *tensions.values()) if not one.noise_known]
    if restless:
        warnings.append(
            "no rest was recorded, too little of it, or it is not known when it ended "
            f"({', '.join(restless)}): values are about the middle of the motion, and the noise "
            "is an estimate"
        )
    shift = 0.0
    if not run.start.motion_start_known:
        largest = max(tensions, key=lambda c: float(tensions[c].value.std()))
        shift = find_start_shift(
            simulation.t_s, simulation.tension_variation_n[:, largest - 1], tensions[largest]
        )
        warnings.append(
            f"the run does not say when its motion started: {excitation.start_s + shift:.3f} s was "
            f"found from cable {largest}"
        )
    window = _steady_window(run, shift, [angle, *tensions.values()])
    generator = np.random.default_rng(seed)
    axis = ("roll", "pitch", "yaw").index(excitation.axis)
    compared = [
        _quantity(
            series, simulation.t_s + shift, simulated, window, excitation.frequency_hz, generator
        )
        for series, simulated in [
            (angle, np.rad2deg(simulation.pose[:, 3 + axis])),
            *((tensions[c], simulation.tension_variation_n[:, c - 1]) for c in cables),
        ]
    ]
    return Comparison(
        run=run,
        rig_name=rig_name if rig is not None else "rig.toml of the run",
        angle=compared[0],
        tensions=dict(zip(cables, compared[1:], strict=True)),
        window_s=window,
        start_shift_s=shift,
        outcome=simulation.outcome.sentence(),
        warnings=tuple(warnings),
    )


def _quantity(
    series: Series,
    simulated_t_s: Array,
    simulated: Array,
    window_s: tuple[float, float],
    frequency_hz: float,
    generator: np.random.Generator,
) -> Quantity:
    steady = series.within(window_s)
    inside = (simulated_t_s >= window_s[0]) & (simulated_t_s <= window_s[1])
    at_samples = np.interp(steady.t_s, simulated_t_s, simulated)
    measured_sine = fit_sine(steady.t_s, steady.value, frequency_hz)
    simulated_sine = fit_sine(steady.t_s, at_samples, frequency_hz)
    measured_phase, sigma = phase_at(steady.t_s, steady.value, frequency_hz)
    simulated_phase, _ = phase_at(steady.t_s, at_samples, frequency_hz)
    lag = float(np.angle(np.exp(1j * (simulated_phase - measured_phase))))
    circular = 2.0 * np.pi * frequency_hz
    low, high = amplitude_interval(simulated_t_s, simulated, steady.t_s, series.noise, generator)
    times = SampleTimes(steady.t_s)
    return Quantity(
        measured=series,
        simulated_t_s=simulated_t_s,
        simulated=simulated,
        simulated_amplitude=float(np.abs(simulated[inside]).max()),
        measured_amplitude=float(np.abs(steady.value).max()),
        simulated_sine=simulated_sine,
        measured_sine=measured_sine,
        noise_low=low,
        noise_high=high,
        delay_s=lag / circular,
        sigma_delay_s=sigma / circular,
        simulated_lines=times.lines(at_samples, series.noise),
        measured_lines=times.lines(steady.value, series.noise),
    )


def _steady_window(run: Run, shift: float, series: list[Series]) -> tuple[float, float]:
    """The steady window of the motion, as far as everything was recorded."""
    excitation = run.start.excitation
    first, last = (t + shift for t in excitation.steady_window_s)
    recorded = min(float(one.t_s[-1]) for one in series)
    last = min(last, recorded)
    periods = (last - first) * excitation.frequency_hz
    if periods < MIN_PERIODS:
        raise DataError(
            f"{max(periods, 0.0):.1f} periods of steady motion were recorded "
            f"({first:.2f} s to {last:.2f} s)",
            where=str(run.folder),
            allowed=f"at least {MIN_PERIODS:g} periods",
            remedy="record longer; an interrupted run is used as far as it goes",
        )
    return first, last


def _warnings(run: Run, rig: Rig | None) -> list[str]:
    found = []
    if run.start.reconstruction:
        found.append(f"reconstruction: {run.start.reconstruction}")
    machine = rig or run.rig
    same = [
        str(i + 1)
        for i, cable in enumerate(machine.cable)
        if run.start.id in cable.stiffness_n_per_m.source
        or run.name in Path(cable.stiffness_n_per_m.source).parts
    ]
    if same:
        found.append(
            f"the stiffness of cable {', '.join(same)} was fitted to this same run: its tensions "
            "agree by construction"
        )
    return found
