"""The cell or its filter answers late."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, lag_s: Any, second_share: Any) -> Any:
    """Low-passes in a row, each exact for straight lines between the times, which are even.

    T_1' = (T - T_1) / ((1 - s) tau), T_m' = (T_1 - T_m) / (s tau): s is the share of the second.
    """
    lagged = tension_n.copy()
    step_s, second = np.mean(np.diff(time_s)), np.broadcast_to(second_share, np.shape(lag_s))
    for i in np.flatnonzero(lag_s):
        for share in (1.0 - second[i], second[i]):
            if share > 0.0:
                lagged[:, i] = _low_pass(lagged[:, i], step_s / (share * lag_s[i]))
    return lagged


def _low_pass(values: Any, steps: float) -> Any:
    """A low-pass of first order; steps are in units of its time."""
    from scipy.signal import lfilter

    kept = np.exp(-steps)
    ramp = (1.0 - kept) / steps
    return values[0] + lfilter([1.0 - ramp, ramp - kept], [1.0, -kept], values - values[0])


EFFECT = Effect(
    name="cell_lag",
    title="lag of the cell",
    acts=Acts.CELL,
    equation="T_1' = (T - T_1)/((1 - s) tau), T_m' = (T_1 - T_m)/(s tau)",
    source="amplifier manual of the force cells; design, section 6",
    signature="quadrature in proportion to frequency, of one channel; T lags elongation",
    parameters=(
        Parameter("lag_s", "s", 5e-3, 0.0, 0.2, "tau", magnitude=True),
        Parameter(
            "second_share", "1", 0.0, 0.0, 0.5, "share of the lag in a second pole, s", False
        ),
    ),
    measure=measure,
    order=1,
)
