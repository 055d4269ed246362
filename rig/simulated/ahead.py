"""A platform that is simulated as the run goes on: a night's run begins as soon as a short one."""

import threading
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from cdpr8.rigfile import Excitation, Rig
from rig.simulated.plant import PlatformSimulation, PlatformTrajectory

Array = NDArray[np.float64]

FIRST_S = 60.0
"""So much is simulated before the run begins: a motion that throws the platform out shows by
then."""

AHEAD_S = 20.0
"""So far ahead of the times that are asked for it is kept."""

KEPT_S = 60.0
"""So far back times can be asked for: the slowest filter of a simulated amplifier looks back 10 s.
"""


class Simulation(Protocol):
    """What is simulated piece by piece: `rig.simulated.plant.PlatformSimulation`."""

    @property
    def over(self) -> bool:
        """Whether there is no more."""
        ...

    def advance(self) -> PlatformTrajectory:
        """The next piece."""
        ...


class AheadPlatform:
    """Knows the motion from `KEPT_S` before the last time asked for until `AHEAD_S` after it.

    Parameters
    ----------
    simulation
        Gives the motion, piece by piece. What it raises within `FIRST_S` is raised here; where it
        fails later, the platform stays where it was.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._turn = threading.Lock()
        self._wanted = threading.Event()
        self._asked_s = 0.0
        # Replaced whole, so that nobody waits who asks for what is there.
        self._known = simulation.advance()
        while not simulation.over and self._known.t_s[-1] < FIRST_S:
            self._known = self._known.then(simulation.advance())
        self._over = simulation.over
        if not self._over:
            threading.Thread(target=self._go_on, name="platform", daemon=True).start()

    def pose_at(self, t_s: Array) -> Array:
        """Poses at times of the run, shape (n, 6), m and rad; held after the end."""
        return self._about(t_s).pose_at(t_s)

    def tension_at(self, cable: int, t_s: Array) -> Array:
        """Tension of one cable, 1 to 8, at times of the run, shape (n,), N; held after the end."""
        return self._about(t_s).tension_at(cable, t_s)

    def _about(self, t_s: Array) -> PlatformTrajectory:
        """The motion about some times.

        Raises
        ------
        ValueError
            They lie so far back that they are forgotten.
        """
        last_s = float(np.max(t_s, initial=0.0))
        # No lock: of two that ask at once the earlier may stand, until the next asks.
        self._asked_s = max(self._asked_s, last_s)
        while not self._over and self._known.t_s[-1] < last_s:
            self._extend(last_s)
        known = self._known
        if not self._over and known.t_s[-1] < last_s + AHEAD_S:
            self._wanted.set()
        if known.t_s[0] > max(0.0, float(np.min(t_s, initial=np.inf))):
            raise ValueError(f"the platform's motion before {known.t_s[0]:.1f} s is forgotten")
        return known

    def _extend(self, until_s: float) -> None:
        with self._turn:
            if self._over or self._known.t_s[-1] >= until_s:
                return
            try:
                self._known = self._known.then(self._simulation.advance(), self._asked_s - KEPT_S)
            except UsageError:  # thrown out of its workspace, an hour into a run
                self._over = True
            else:
                self._over = self._simulation.over
            if self._over:
                self._wanted.set()  # which ends the thread

    def _go_on(self) -> None:
        while not self._over:
            self._wanted.wait()
            self._wanted.clear()
            until_s = self._asked_s + AHEAD_S
            while not self._over and self._known.t_s[-1] < until_s:
                self._extend(until_s)


def simulate_ahead(
    rig: Rig, excitation: Excitation, friction_n: Array | None = None
) -> AheadPlatform:
    """The platform of `PlatformSimulation`, whose parameters and errors these are."""
    return AheadPlatform(PlatformSimulation(rig, excitation, friction_n))
