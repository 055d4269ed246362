"""One cable: tension (Eq. 16) and transverse vibration at mid-span (Eqs. 15 and 17).

Plain arithmetic on floats or arrays, compiled with the kernel and used as it stands by NumPy.
"""

import numpy as np

from model.kinematics import Quantity

PI_SQUARED = np.pi**2


def vibration_extension(mid_span: Quantity, length: Quantity) -> Quantity:
    """delta_i of Eq. 15, pi^2 X_wi^2 / (4 L_i): what vibration adds to the elongation, in m.

    Parameters
    ----------
    mid_span
        X_wi, mid-span amplitude in m.
    length
        L_i in m.
    """
    return PI_SQUARED * mid_span * mid_span / (4.0 * length)


def tension(
    pretension: Quantity,
    stiffness: Quantity,
    elongation: Quantity,
    mid_span: Quantity,
    length: Quantity,
    least: Quantity = 0.0,
) -> Quantity:
    """T_i of Eq. 16, in N.

    Parameters
    ----------
    pretension
        T_0i in N.
    stiffness
        k_wi in N/m.
    elongation
        Delta L_i = L_i - L_0i of Eq. 14, in m.
    mid_span
        X_wi in m.
    length
        L_i in m.
    least
        What it does not fall below, N: 0 of a cable, which cannot push.
    """
    pull = pretension + stiffness * (elongation + vibration_extension(mid_span, length))
    return np.maximum(pull, least)


def transverse_acceleration(
    mid_span: Quantity,
    mid_span_rate: Quantity,
    tension_n: Quantity,
    axial_velocity: Quantity,
    length: Quantity,
    line_density: Quantity,
    damping: Quantity,
) -> Quantity:
    """X_wi'' of Eq. 17, in m/s2: -c X_wi' - (pi/L)^2 (T/(rho A) - v_y^2) X_wi.

    Parameters
    ----------
    mid_span, mid_span_rate
        X_wi in m and X_wi' in m/s.
    tension_n
        T_i in N.
    axial_velocity
        v_yi in m/s.
    length
        L_i in m.
    line_density
        rho_w A in kg/m.
    damping
        c_wi in 1/s.
    """
    wave_number_squared = PI_SQUARED / (length * length)
    restoring = tension_n / line_density - axial_velocity * axial_velocity
    return -damping * mid_span_rate - wave_number_squared * restoring * mid_span


def tone_hz(tension_n: Quantity, line_density: Quantity, length: Quantity) -> Quantity:
    """The cable's own first tone, sqrt(T/(rho A)) / (2 L), in Hz; 0 where it hangs slack."""
    return np.sqrt(np.maximum(tension_n, 0.0) / line_density) / (2.0 * length)
