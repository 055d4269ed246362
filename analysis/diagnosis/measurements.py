"""What tells two explanations apart where no motion of the platform does."""

from dataclasses import dataclass

from analysis.diagnosis.policies import FRICTIONS
from model.library.discovery import library


@dataclass(frozen=True)
class Measurement:
    """One measurement beside the runs: what to do, and the minutes it takes."""

    what: str
    minutes: float


TAP = Measurement(
    "tap the platform with a hammer some ten times, seen by force cells and camera alike (press "
    "Enter in `rig record` at each): the clocks are then known, and what is still late is not the "
    "camera",
    3.0,
)
"""A delay dissipates nothing and damping does not delay a tap."""

WEIGHTS = Measurement(
    "hang known weights on the platform in five steps up and down: poses and tensions at rest give "
    "stiffness, and the gains of cells and camera, without motion",
    30.0,
)

CELLS = Measurement(
    "hang a certified weight on the cell by itself, and read its zero unloaded: gain, zero and "
    "drift of the cell are then known, whatever the cable does",
    15.0,
)

RULER = Measurement(
    "turn the platform by a known angle against a stop (gauge block or protractor): the camera's "
    "gain and axes are then known",
    10.0,
)

SCALE = Measurement(
    "weigh the platform, and let it swing as a pendulum about two axes: mass, centre of mass and "
    "inertia are then known by themselves",
    40.0,
)

TAPE = Measurement("measure base and anchor points again, to a millimetre", 40.0)

BREAKAWAY = Measurement(
    "pull each cable over its pulley by hand with a spring scale, slowly, from rest and both ways, "
    "at two loads: the force at breakaway and in sliding is the friction and its load dependence",
    20.0,
)

LOG = Measurement(
    "log the commanded and the measured motion of the drive (`rig record --command-log`): what the "
    "drive does is then known",
    5.0,
)

FRAMES = Measurement(
    "film a flashing light of known rate for a minute: exposure, readout and dropped frames show",
    5.0,
)

DECAY = Measurement(
    "stop the drive at an extreme and record the free decay at high camera rate: linear decay is "
    "dry friction, exponential is viscous, quick at large amplitude only is drag",
    5.0,
)

AGAIN = Measurement(
    "record the same motion longer and with the camera closer: these differ by less than the noise",
    5.0,
)

LATE = ("camera_latency", "cell_lag", "drive_phase", "cable_viscous", "clock_drift",
        "cable_structural", "cable_relaxation")  # fmt: skip
"""What all looks like a delay between tension and pose."""

LIKE_STIFFNESS = ("stiffness", "cell_gain", "camera_gain", "frame_compliance", "drive_amplitude",
                  "cable_stiffening", "geometry")  # fmt: skip


def measurement(one: str, other: str) -> Measurement:
    """What tells two effects apart, by what is known of their kind.

    Parameters
    ----------
    one, other
        Effects of the library; other words are taken as nothing known.
    """
    names = {one, other}
    sides = {library()[name].acts.side for name in names if name in library()}
    rules: list[tuple[bool, Measurement]] = [
        (names <= set(FRICTIONS), BREAKAWAY),
        (bool(names & {"camera_latency", "clock_drift"}) and names <= set(LATE), TAP),
        (bool(names & {"cell_lag", "drive_phase"}) and names <= set(LATE), TAP),
        ("drive" in sides, LOG),
        (bool(names & {"camera_gain", "camera_axis"}), RULER),
        (names <= set(LIKE_STIFFNESS), WEIGHTS),
        ("cell" in sides, CELLS),
        (bool(names & {"mass", "inertia", "centre_of_mass"}), SCALE),
        (bool(names & {"geometry", "pulley_geometry"}), TAPE),
        (bool(names & {"camera_exposure", "camera_rolling_shutter", "frames_dropped"}), FRAMES),
        (bool(names & set(FRICTIONS)), BREAKAWAY),
        (
            bool(names & {"cable_viscous", "cable_structural", "platform_damping", "air_drag"}),
            DECAY,
        ),
        (bool(names & {"pretension", "cable_slack", "cable_sag"}), WEIGHTS),
    ]
    return next((found for fits, found in rules if fits), AGAIN)
