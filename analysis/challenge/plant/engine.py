"""MuJoCo's free body, stepped from compiled code."""

import ctypes
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LIBRARIES = ("libmujoco*.so*", "libmujoco*.dylib", "mujoco.dll")
"""What MuJoCo's shared library is called on Linux, macOS and Windows."""

FASTEST = 1e3
"""A platform this fast, m/s or rad/s, has come apart. Long before MuJoCo would see it, begin anew
at rest in the middle of the run, and say so in a file of its own only."""

XML = """
<mujoco>
  <option timestep="{step}" gravity="0 0 {gravity}" integrator="Euler">
    <flag contact="disable" constraint="disable" eulerdamp="disable"/>
  </option>
  <worldbody>
    <body name="platform">
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass}" fullinertia="{inertia}"/>
    </body>
  </worldbody>
</mujoco>
"""


@dataclass(frozen=True)
class Body:
    """A free body in MuJoCo: its model and data, and views of the arrays inside."""

    model: Any
    data: Any

    @property
    def addresses(self) -> tuple[int, int]:
        """Of model and data, as the C library takes them."""
        return int(self.model._address), int(self.data._address)


def free_body(mass_kg: float, inertia: Array, gravity: float, step_s: float) -> Body:
    """A platform with a full inertia tensor about its centre of mass.

    Parameters
    ----------
    mass_kg
        Mass.
    inertia
        Shape (3, 3), platform frame, kg m2.
    gravity
        Along -Z, m/s2.
    step_s
        Step of the integration, s.
    """
    import mujoco

    six = (inertia[j] for j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
    text = XML.format(
        step=repr(float(step_s)),
        gravity=repr(-float(gravity)),
        mass=repr(float(mass_kg)),
        inertia=" ".join(repr(float(value)) for value in six),
    )
    model = mujoco.MjModel.from_xml_string(text)
    return Body(model, mujoco.MjData(model))


@lru_cache(maxsize=1)
def compiled_loop() -> Any:
    """The loop over steps: cables push, MuJoCo moves. Compiled once a process."""
    import mujoco
    from numba import njit

    from analysis.challenge.plant import layout as at
    from analysis.challenge.plant.forces import push

    beside = Path(mujoco.__file__).parent
    library = next(path for pattern in LIBRARIES for path in beside.glob(pattern))
    move = ctypes.CDLL(str(library)).mj_step
    move.argtypes, move.restype = [ctypes.c_void_p, ctypes.c_void_p], None

    @njit
    def loop(
        model: int,
        data: int,
        qpos: Array,
        qvel: Array,
        applied: Array,
        cables: Array,
        states: Array,
        g: Array,
        post_of: NDArray[np.int64],
        posts: Array,
        drive: Array,
        jump_at: int,
        jump: Array,
        step_s: float,
        pose: Array,
        cell: Array,
    ) -> None:
        wrench, attitude = np.zeros(6), np.zeros(3)
        for n in range(len(drive)):
            for j in range(6):
                if not abs(qvel[j]) < FASTEST or np.isnan(qpos[j]):
                    # All that follows is no number, a later call's included.
                    qpos[0], pose[n:], cell[n:] = np.nan, np.nan, np.nan
                    return
            kick = 1.0
            if n == jump_at:
                # Rates are half a step behind: from a jump on, half a kick brings them there.
                kick = 0.5
                for j in range(3):
                    qpos[j] += jump[j]
                    qvel[j] += jump[3 + j]
                    qvel[3 + j] += jump[6 + j]
                for i in range(len(cables)):
                    states[i, at.STRING] += jump[9]
                    # It was held there and is let go: no wheel and no dashpot has yet to follow.
                    states[i, at.STARTED] = 0.0
            push(
                cables, states, g, post_of, posts, qpos, qvel, n * step_s, step_s,
                kick, wrench, cell[n], attitude,
            )  # fmt: skip
            for j in range(3):
                pose[n, j], pose[n, 3 + j] = qpos[j], attitude[j]
            for j in range(6):
                applied[j] = kick * (wrench[j] + drive[n, j])
            applied[2] += (1.0 - kick) * g[at.MASS] * g[at.GRAVITY]
            move(model, data)

    return loop
