"""The simulated camera: pictures of the plate on a platform that moves."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cdpr8.rigfile.schema import Camera, Plate
from rig.simulated.render import Appearance, PlateRenderer

Array = NDArray[np.float64]
PoseAt = Callable[[Array], Array]
"""Times in s, shape (n,), to poses of the centre of mass, shape (n, 6), in m and rad."""

PROBES = 9
"""Instants at which the motion during an exposure is looked at."""

MOST_INSTANTS = 40
"""An exposure is averaged over no more instants than this."""


class SimulatedCamera:
    """A camera that stands still and sees the plate move.

    Parameters
    ----------
    camera, plate
        As the rig file has them; `camera.pose` must be given.
    pose_at
        The platform's motion.
    generator
        Draws the sensor noise.
    appearance
        Brightness, blur and noise.
    centre_of_mass_m
        The centre of mass in the platform frame.

    Attributes
    ----------
    width_px, height_px, fps, exposure_s, source
        As the recorder writes them into start.json.
    """

    def __init__(
        self,
        camera: Camera,
        plate: Plate,
        pose_at: PoseAt,
        generator: np.random.Generator,
        *,
        appearance: Appearance | None = None,
        centre_of_mass_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        self._renderer = PlateRenderer(camera, plate, appearance, centre_of_mass_m)
        self._pose_at = pose_at
        self._generator = generator
        self.width_px = self._renderer.width_px
        self.height_px = self._renderer.height_px
        self.fps = camera.fps
        self.exposure_s = camera.exposure_s
        self.source = camera.source

    def prepare(self) -> None:
        """Make a picture for nobody: the first takes ten times as long as all others."""
        at_rest, once = np.zeros((1, 6)), np.ones(1)
        self._renderer.expose(at_rest, once, np.random.default_rng(0))

    def expose(self, t_mid_s: float) -> NDArray[np.uint8]:
        """The picture of one exposure.

        Parameters
        ----------
        t_mid_s
            The middle of the exposure.

        Returns
        -------
        NDArray[np.uint8]
            Grey levels, shape (height_px, width_px).
        """
        half = self.exposure_s / 2.0
        probes = self._pose_at(t_mid_s + half * np.linspace(-1.0, 1.0, PROBES))
        outlines = np.array([self._renderer.corners(pose) for pose in probes])
        path_px = np.linalg.norm(np.diff(outlines, axis=0), axis=2).sum(axis=0).max()
        # Gauss-Legendre: instants half a pixel apart resolve an edge blurred by 0.7 px, and two
        # more make the average exact to far below one grey level.
        count = min(2 + int(np.ceil(2.0 * float(path_px))), MOST_INSTANTS)
        nodes, weights = np.polynomial.legendre.leggauss(count)
        poses = self._pose_at(t_mid_s + half * nodes)
        return self._renderer.expose(poses, weights / 2.0, self._generator)
