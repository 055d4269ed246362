"""Sine and cosine for loops over lanes: no branches, and nothing of the C library."""

from typing import Any

import numpy as np

TWO_OVER_PI = 0.6366197723675814
HALF_PI_HIGH = 1.5707963267948966
HALF_PI_LOW = 6.123233995736766e-17
"""pi / 2 in two parts: angles of a platform are a few rad at most."""


def sine_cosine(x: Any) -> Any:
    """Sine and cosine without branches; Moshier's polynomials (Cephes), error 1e-16."""
    turns = np.floor(x * TWO_OVER_PI + 0.5)
    r = (x - turns * HALF_PI_HIGH) - turns * HALF_PI_LOW
    z = r * r
    sine = r + r * z * (
        -1.66666666666666307295e-1
        + z
        * (
            8.33333333332211858878e-3
            + z
            * (
                -1.98412698295895385996e-4
                + z
                * (
                    2.75573136213857245213e-6
                    + z * (-2.50507477628578072866e-8 + z * 1.58962301576546568060e-10)
                )
            )
        )
    )
    cosine = (
        1.0
        - 0.5 * z
        + z
        * z
        * (
            4.16666666666665929218e-2
            + z
            * (
                -1.38888888888730564116e-3
                + z
                * (
                    2.48015872888517045348e-5
                    + z
                    * (
                        -2.75573141792967388112e-7
                        + z * (2.08757008419747316778e-9 - z * 1.13585365213876817300e-11)
                    )
                )
            )
        )
    )
    odd = turns - 2.0 * np.floor(0.5 * turns)
    half = 0.5 * (turns - odd)
    flip = 1.0 - 2.0 * (half - 2.0 * np.floor(0.5 * half))
    even = 1.0 - odd
    return flip * (even * sine + odd * cosine), flip * (even * cosine - odd * sine)
