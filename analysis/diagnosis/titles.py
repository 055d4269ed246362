"""Effects in a few words, for sentences and labels."""

from collections.abc import Mapping

SHORT: Mapping[str, str] = {
    "air_drag": "drag of the air",
    "anchor_play": "play of the hook at the anchor",
    "cable_creep": "creep of the cables",
    "cable_end_forcing": "shaking of the cables by their anchors",
    "cable_hysteresis": "hysteresis of the cables",
    "cable_modes": "higher transverse modes of the cables",
    "cable_relaxation": "relaxation of the cables",
    "cable_sag": "sag of the cables",
    "cable_slack": "slack of the cables",
    "cable_stiffening": "stiffening of the cables",
    "cable_structural": "structural damping of the cables",
    "cable_viscous": "viscous damping of the cables",
    "camera_axis": "a turned camera axis",
    "camera_exposure": "blur by a long exposure",
    "camera_gain": "a wrong scale of the camera",
    "camera_latency": "late stamps of the camera",
    "camera_rolling_shutter": "rolling shutter of the camera",
    "cell_drift": "drift of a force cell",
    "cell_gain": "a wrong gain of a force cell",
    "cell_lag": "lag of the force cells",
    "cell_saturation": "clipping of a force cell",
    "cell_swapped": "swapped force cells",
    "cell_zero": "a wrong zero of a force cell",
    "centre_of_mass": "a wrong centre of mass",
    "clock_drift": "drift between the clocks",
    "drive_amplitude": "a wrong amplitude of the drive",
    "drive_backlash": "backlash of the drive",
    "drive_frequency": "a wrong frequency of the drive",
    "drive_harmonic": "a harmonic of the drive",
    "drive_phase": "lateness of the drive",
    "frame_compliance": "compliance of the frame",
    "frames_dropped": "frames dropped without a mark",
    "geometry": "wrong points of the geometry",
    "inertia": "a wrong inertia of the platform",
    "mass": "a wrong mass of the platform",
    "platform_damping": "damping of the platform",
    "pretension": "a wrong pretension",
    "pulley_capstan": "capstan friction at the pulleys",
    "pulley_coulomb": "Coulomb friction at the pulleys",
    "pulley_geometry": "the pulleys' own radius",
    "pulley_inertia": "inertia of the pulleys",
    "pulley_presliding": "friction with presliding at the pulleys",
    "pulley_stribeck": "Stribeck friction at the pulleys",
    "stiffness": "a wrong stiffness",
    "umbilical": "the pull of the umbilical",
}


def short(effect: str) -> str:
    """An effect in a few words that fit into a sentence; its own name where there are none."""
    return SHORT.get(effect, effect.replace("_", " "))


def title(effect: str) -> str:
    """The same with its identifier: "friction at the pulleys [pulley_coulomb]"."""
    return f"{short(effect)}\n{effect}"


def together(effects: list[str]) -> str:
    """A hypothesis in words."""
    return " + ".join(short(one) for one in effects) if effects else "nothing left out"


def rival(name: str) -> str:
    """An explanation named by its effects' identifiers, "a and b", in words."""
    return together(name.split(" and "))


_AXES = ("x", "y", "z", "roll", "pitch", "yaw")

_PLAIN: Mapping[str, str] = {
    "camera_axis": "camera axis",
    "camera_gain": "camera scale",
    "camera_latency": "camera latency",
    "cell_gain": "gain of the cell",
    "centre_of_mass": "centre of mass",
    "drive_amplitude": "drive amplitude",
    "geometry": "geometry",
    "inertia": "inertia",
    "mass": "mass",
    "stiffness": "stiffness",
}
"""Parameters of the rig file, as such: not as left-out physics."""


def parameter_name(name: str) -> str:
    """A nuisance's name in words: "geometry base_x_m@3" is "geometry base x, cable 3"."""
    whole, _, cable = name.partition("@")
    place = f", cable {cable}" if cable else ""
    first, _, term = whole.partition(" ")
    if whole.startswith("pose zero"):
        return f"place of the plate, {_AXES[int(whole.split()[-1])]}"
    if first in _PLAIN:
        # The number's own name where the effect has several, without its unit.
        several = first in ("geometry", "inertia", "centre_of_mass", "camera_axis")
        words = [one for one in term.split("_")[:-1] if one not in first.split("_")]
        detail = " ".join(words) if several else ""
        return f"{_PLAIN[first]} {detail}".strip() + place
    return whole.replace("_", " ") + place
