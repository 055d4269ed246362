"""A comparison in words and numbers: the table for people, the dictionary for machines."""

from typing import TYPE_CHECKING, Any

from analysis.compare import SHOWN_CABLES, Comparison, Quantity
from analysis.noise import COVERAGE
from analysis.sine_fit import SineFit
from analysis.spectrum import Line
from cdpr8.provenance import versions

if TYPE_CHECKING:
    from rich.table import Table

LINES_SHOWN = 4
"""Spectral lines in the table; all that were found are in the dictionary."""


def table(comparison: Comparison) -> "Table":
    """The paper's Section 5 as a table."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    shown = Table(
        title=f"{comparison.run.name}: amplitudes, simulated against measured",
        title_justify="left",
        box=SIMPLE_HEAD,
    )
    shown.add_column("quantity", no_wrap=True)
    for column in (
        "simulated",
        "measured",
        "difference",
        "relative\nerror",
        "noise\nallows",
        "sine fit,\nsimulated",
        "sine fit,\nmeasured",
    ):
        shown.add_column(column, justify="right", no_wrap=True)
    first = _shown(comparison)
    for quantity in first:
        shown.add_row(*_row(quantity), end_section=quantity is first[-1])
    for quantity in comparison.quantities:
        if quantity not in first:
            shown.add_row(*_row(quantity))
    return shown


def frequency_table(comparison: Comparison) -> "Table":
    """Frequencies: the drive's as fitted, the delay, and the strongest lines above the noise."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    shown = Table(title="frequencies", title_justify="left", box=SIMPLE_HEAD)
    shown.add_column("quantity", no_wrap=True)
    shown.add_column("drive, measured", justify="right", no_wrap=True)
    shown.add_column("recording\nlags by", justify="right", no_wrap=True)
    shown.add_column("lines (Hz: amplitude)", no_wrap=True)
    for quantity in _shown(comparison):
        sine = quantity.measured_sine
        shown.add_row(
            quantity.measured.name,
            f"{sine.frequency_hz:.5f} ± {sine.sigma_frequency_hz:.5f} Hz",
            f"{1e3 * quantity.delay_s:+.2f} ± {1e3 * quantity.sigma_delay_s:.2f} ms",
            f"simulated  {_spelled_lines(quantity.simulated_lines)}\n"
            f"measured   {_spelled_lines(quantity.measured_lines)}",
        )
    return shown


def _shown(comparison: Comparison) -> list[Quantity]:
    """The angle and the cables the paper shows; where those are dead, the angle alone."""
    cables = [comparison.tensions[c] for c in SHOWN_CABLES if c in comparison.tensions]
    return [comparison.angle, *cables]


def verdict(comparison: Comparison) -> str:
    """One line: whether any difference exceeds what the noise allows."""
    beyond = [q.measured.name for q in comparison.quantities if q.exceeds_noise]
    if not beyond:
        return (
            "No difference exceeds what noise and sampling allow "
            f"({COVERAGE:.0%} interval): simulation and recording agree."
        )
    within = [q.measured.name for q in comparison.quantities if not q.exceeds_noise]
    if not within:
        return (
            f"Every difference exceeds what noise and sampling allow ({COVERAGE:.0%} interval): "
            "the rig file's numbers, the clocks or left-out physics must answer for them."
        )
    return (
        f"Beyond what noise and sampling allow ({COVERAGE:.0%} interval): {', '.join(beyond)}. "
        f"Within: {', '.join(within)}."
    )


def as_dictionary(comparison: Comparison) -> dict[str, Any]:
    """The same for machines; relative errors are fractions, angles deg, tensions N."""
    run = comparison.run
    return {
        "run": run.name,
        "run_id": run.start.id,
        "simulated_run": run.start.simulated,
        "reconstruction": run.start.reconstruction,
        "rig": comparison.rig_name,
        "excitation": run.start.excitation.model_dump(mode="json"),
        "steady_window_s": comparison.window_s,
        "start_shift_s": comparison.start_shift_s,
        "simulation": comparison.outcome,
        "noise_interval": COVERAGE,
        "angle": _quantity_dictionary(comparison.angle),
        "tension": {str(c): _quantity_dictionary(q) for c, q in comparison.tensions.items()},
        "verdict": verdict(comparison),
        "warnings": comparison.warnings,
        "versions": versions(),
    }


def _row(quantity: Quantity) -> tuple[str, ...]:
    unit = quantity.measured.unit
    return (
        quantity.measured.name,
        f"{quantity.simulated_amplitude:.2f} {unit}",
        f"{quantity.measured_amplitude:.2f} {unit}",
        f"{quantity.difference:+.2f} {unit}",
        f"{quantity.relative_error:.2%}",
        f"{quantity.noise_low:.3f} to {quantity.noise_high:.3f}",
        f"{quantity.simulated_sine.amplitude:.3f}",
        f"{quantity.measured_sine.amplitude:.3f} ± {quantity.measured_sine.sigma_amplitude:.3f}",
    )


def _spelled_lines(lines: tuple[Line, ...]) -> str:
    strongest = lines[:LINES_SHOWN]
    spelled = (f"{line.frequency_hz:.2f}: {line.amplitude:.3f}" for line in strongest)
    return "  ".join(spelled) or "none"


def _quantity_dictionary(quantity: Quantity) -> dict[str, Any]:
    return {
        "name": quantity.measured.name,
        "unit": quantity.measured.unit,
        "simulated": quantity.simulated_amplitude,
        "measured": quantity.measured_amplitude,
        "difference": quantity.difference,
        "relative_error": quantity.relative_error,
        "relative_error_percent": 100.0 * quantity.relative_error,
        "noise_interval": [quantity.noise_low, quantity.noise_high],
        "exceeds_noise": quantity.exceeds_noise,
        "noise_of_a_sample": quantity.measured.noise,
        "noise_from_rest": quantity.measured.noise_known,
        "delay_s": quantity.delay_s,
        "sigma_delay_s": quantity.sigma_delay_s,
        "sine": {
            "simulated": _sine_dictionary(quantity.simulated_sine),
            "measured": _sine_dictionary(quantity.measured_sine),
        },
        "lines": {
            "simulated": [_line_dictionary(line) for line in quantity.simulated_lines],
            "measured": [_line_dictionary(line) for line in quantity.measured_lines],
        },
    }


def _line_dictionary(line: Line) -> dict[str, float]:
    return {"frequency_hz": line.frequency_hz, "amplitude": line.amplitude}


def _sine_dictionary(sine: SineFit) -> dict[str, float]:
    return {
        "amplitude": sine.amplitude,
        "sigma_amplitude": sine.sigma_amplitude,
        "frequency_hz": sine.frequency_hz,
        "sigma_frequency_hz": sine.sigma_frequency_hz,
        "residual": sine.residual,
    }
