"""The result of a simulation as a value: outputs over time, how it ended and what it came from."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from model.library.selection import ActiveEffect
from model.status import Outcome

if TYPE_CHECKING:
    import pandas as pd

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Stats:
    """How the numbers were made and what that took.

    Parameters
    ----------
    method
        Name of the integration method.
    longest_step_s
        The longest of its steps.
    steps, derivatives
        Steps taken and evaluations of the right-hand side.
    solve_s
        Wall time of the integration alone.
    """

    method: str
    longest_step_s: float
    steps: int
    derivatives: int
    solve_s: float


@dataclass(frozen=True)
class Simulation:
    """Outputs over time. Metres, newtons and radians; after a blow-up, up to there.

    Parameters
    ----------
    t_s
        Times, shape (n,).
    pose, pose_rate
        X_p, Y_p, Z_p, roll, pitch, yaw and their derivatives, shape (n, 6).
    commanded_pose
        X*, shape (n, 6).
    tension_n
        T_i where the cell of each cable sits, shape (n, 8); Eq. 16 where nothing was left out.
    anchor_tension_n
        The tension at the anchor, shape (n, 8): it differs where a pulley stands before the cell.
    elongation_m
        Delta L_i of Eq. 14, less what a winch has paid out, shape (n, 8).
    axial_velocity_m_per_s
        v_yi = dL_i/dt, shape (n, 8).
    cable_offset_m, cable_offset_rate_m_per_s
        X_w, mid-span amplitudes, and X_w', shape (n, 8).
    rest_tension_n
        T_0i, the mean over rest (where there is no rest, the pretension), shape (8,).
    steady_window_s
        Where amplitudes are taken.
    outcome
        ok, slack or blow_up, with which cable and when.
    stats
        How the numbers were made.
    provenance
        What they came from: rig, excitation, effects, versions.
    effects
        The left-out effects that were on, those of the measurement included.
    """

    t_s: Array
    pose: Array
    pose_rate: Array
    commanded_pose: Array
    tension_n: Array
    anchor_tension_n: Array
    elongation_m: Array
    axial_velocity_m_per_s: Array
    cable_offset_m: Array
    cable_offset_rate_m_per_s: Array
    rest_tension_n: Array
    steady_window_s: tuple[float, float]
    outcome: Outcome
    stats: Stats
    provenance: Mapping[str, object]
    effects: tuple[ActiveEffect, ...] = ()

    @property
    def tension_variation_n(self) -> Array:
        """Delta T_i = T_i - T_0i (Section 5 of the paper), shape (n, 8)."""
        return self.tension_n - self.rest_tension_n

    @property
    def steady(self) -> NDArray[np.bool_]:
        """Which rows lie in the steady window, its ends included, shape (n,)."""
        # Half an output period would do; rounding of k / rate is all that has to be bridged.
        slack = 1e-9
        first, last = self.steady_window_s
        return (self.t_s >= first - slack) & (self.t_s <= last + slack)

    def to_frame(self) -> "pd.DataFrame":
        """The outputs as a table, angles in degrees.

        Returns
        -------
        pandas.DataFrame
            Columns t_s, x_m, y_m, z_m, roll_deg, pitch_deg, yaw_deg, tension_1_n ... tension_8_n,
            elongation_1_m ... elongation_8_m, cable_1_m ... cable_8_m.
        """
        import pandas as pd

        columns = {"t_s": self.t_s}
        columns |= dict(zip(("x_m", "y_m", "z_m"), self.pose[:, :3].T, strict=True))
        angles = np.rad2deg(self.pose[:, 3:]).T
        columns |= dict(zip(("roll_deg", "pitch_deg", "yaw_deg"), angles, strict=True))
        for name, unit, values in (
            ("tension", "n", self.tension_n),
            ("elongation", "m", self.elongation_m),
            ("cable", "m", self.cable_offset_m),
        ):
            for i in range(values.shape[1]):
                columns[f"{name}_{i + 1}_{unit}"] = values[:, i]
        return pd.DataFrame(columns)
