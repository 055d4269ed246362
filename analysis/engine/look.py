"""The system at its likeliest parameters."""

from typing import NamedTuple

from analysis.engine.array import Array
from analysis.engine.calibrate import Calibrated, calibrate
from analysis.engine.finder import Tell
from analysis.engine.lens import Lens
from analysis.engine.system import System


class Look(NamedTuple):
    """The system at its likeliest parameters."""

    lens: Lens
    data: Array
    calibrated: Calibrated


def look(system: System, tell: Tell | None = None) -> Look:
    """Fit the parameters."""
    lens = Lens(list(system.bundles))
    data = lens.of_data()

    def parameters(done: int, total: int) -> None:
        if tell is not None:
            tell("fitting parameters", done, total)

    return Look(lens, data, calibrate(system, lens, data, parameters))
