"""In which units the systems behind OpenCV count an exposure."""

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class ExposureUnits:
    """How one of OpenCV's systems spells an exposure.

    Attributes
    ----------
    manual
        What CAP_PROP_AUTO_EXPOSURE takes for "by hand".
    spell
        From s to what CAP_PROP_EXPOSURE takes.
    read_s
        The inverse; None for an answer that is no exposure.
    """

    manual: float
    spell: Callable[[float], float]
    read_s: Callable[[float], float | None]


EXPOSURE_UNITS = {
    # V4L2_CID_EXPOSURE_ABSOLUTE counts 100 microseconds; V4L2_EXPOSURE_MANUAL is 1.
    "V4L2": ExposureUnits(1.0, lambda s: s * 1e4, lambda v: v * 1e-4 if v > 0.0 else None),
    # DirectShow and Media Foundation take the binary logarithm of seconds, whole numbers.
    "DSHOW": ExposureUnits(0.25, lambda s: round(math.log2(s)), lambda v: 2.0**v if v else None),
    "MSMF": ExposureUnits(0.25, lambda s: round(math.log2(s)), lambda v: 2.0**v if v else None),
}
"""By OpenCV's name of the system; others are left as they are."""
