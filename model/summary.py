"""The few numbers people ask of a simulation, by the paper's definitions."""

from dataclasses import asdict, dataclass

import numpy as np

from model.simulation import Simulation


@dataclass(frozen=True)
class Summary:
    """Amplitudes over the steady window; degrees, newtons and millimetres.

    Parameters
    ----------
    max_roll_deg, max_pitch_deg, max_yaw_deg
        max |phi|, max |theta|, max |psi|.
    tension_variation_n
        max |T_i - T_0i| of each cable.
    cable_amplitude_mm
        max |X_wi| of each cable.
    displacement_mm
        Largest distance of the centre of mass from X*.
    rotation_deg
        Largest deviation of any angle from X*.
    min_tension_n, min_tension_cable
        The lowest tension and its cable, over the whole run.
    """

    max_roll_deg: float
    max_pitch_deg: float
    max_yaw_deg: float
    tension_variation_n: tuple[float, ...]
    cable_amplitude_mm: tuple[float, ...]
    displacement_mm: float
    rotation_deg: float
    min_tension_n: float
    min_tension_cable: int

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


def summarise(simulation: Simulation) -> Summary | None:
    """Amplitudes of a simulation.

    Parameters
    ----------
    simulation
        The result.

    Returns
    -------
    Summary or None
        None where a blow-up came before the steady window.
    """
    steady = simulation.steady
    if not steady.any():
        return None
    pose = simulation.pose[steady]
    deviation = pose - simulation.commanded_pose[steady]
    angles = np.rad2deg(np.abs(pose[:, 3:]).max(axis=0))
    lowest = simulation.tension_n.min(axis=0)
    return Summary(
        max_roll_deg=float(angles[0]),
        max_pitch_deg=float(angles[1]),
        max_yaw_deg=float(angles[2]),
        tension_variation_n=_largest(simulation.tension_variation_n[steady]),
        cable_amplitude_mm=_largest(1e3 * simulation.cable_offset_m[steady]),
        displacement_mm=float(1e3 * np.linalg.norm(deviation[:, :3], axis=1).max()),
        rotation_deg=float(np.rad2deg(np.abs(deviation[:, 3:]).max())),
        min_tension_n=float(lowest.min()),
        min_tension_cable=int(lowest.argmin()) + 1,
    )


def _largest(values: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> tuple[float, ...]:
    """Largest magnitude in each column."""
    return tuple(float(value) for value in np.abs(values).max(axis=0))
