"""The cell or its filter answers late."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, lag_s: Any) -> Any:
    """T_m' = (T - T_m) / tau, solved exactly for straight lines between samples."""
    from scipy.signal import lfilter

    lagged = tension_n.copy()
    for i in np.flatnonzero(lag_s):
        steps = np.mean(np.diff(time_s)) / lag_s[i]
        kept = np.exp(-steps)
        ramp = (1.0 - kept) / steps
        change = tension_n[:, i] - tension_n[0, i]
        taken = lfilter([1.0 - ramp, ramp - kept], [1.0, -kept], change)
        lagged[:, i] = tension_n[0, i] + taken
    return lagged


EFFECT = Effect(
    name="cell_lag",
    title="lag of the cell",
    acts=Acts.CELL,
    equation="T_m' = (T - T_m)/tau",
    source="amplifier manual of the force cells; design, section 6",
    signature="quadrature in proportion to frequency, of one channel; T lags elongation",
    parameters=(Parameter("lag_s", "s", 5e-3, 0.0, 0.2, "tau", magnitude=True),),
    measure=measure,
    order=1,
)
