"""The cell or its filter answers late."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter


def measure(time_s: Any, tension_n: Any, lag_s: Any, second_order: Any) -> Any:
    """A low-pass of second order, exact for straight lines between the times, which are even.

    It is two of first order in a row, of the times (1 - s) tau and s tau with s (1 - s) = q, which
    are conjugate where it overshoots.
    """
    lagged = tension_n.copy()
    step_s, order = np.mean(np.diff(time_s)), np.broadcast_to(second_order, np.shape(lag_s))
    for i in np.flatnonzero(lag_s):
        late = tension_n[:, i]
        second = 0.5 - 0.5 * np.emath.sqrt(1.0 - 4.0 * order[i])
        for share in (1.0 - second, second):
            if share != 0.0:
                late = _low_pass(late, step_s / (share * lag_s[i]))
        lagged[:, i] = late.real
    return lagged


def _low_pass(values: Any, steps: Any) -> Any:
    """A low-pass of first order; steps are in units of its time, which may be complex."""
    from scipy.signal import lfilter

    kept = np.exp(-steps)
    ramp = (1.0 - kept) / steps
    return values[0] + lfilter([1.0 - ramp, ramp - kept], [1.0, -kept], values - values[0])


EFFECT = Effect(
    name="cell_lag",
    title="lag of the cell",
    acts=Acts.CELL,
    equation="T_m + tau T_m' + q tau^2 T_m'' = T",
    source="amplifier manual of the force cells; design, section 6",
    signature="quadrature in proportion to frequency, of one channel; T lags elongation",
    parameters=(
        Parameter("lag_s", "s", 5e-3, 0.0, 0.2, "tau", magnitude=True),
        Parameter(
            "second_order",
            "1",
            0.0,
            0.0,
            0.7,
            "q: 0 one pole; 1/4 two alike; of filters Bessel's 1/3, Butterworth's 1/2",
            False,
        ),
    ),
    measure=measure,
    order=1,
)
