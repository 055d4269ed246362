"""What a law of the plant may ask for by name, and where either kernel finds it.

A law may also ask for its effect's own parameters and states.
"""

from collections.abc import Mapping

CABLE: Mapping[str, tuple[str, str]] = {
    "length": ("L_i, m", "line.length"),
    "elongation": ("Delta L_i of Eq. 14, less what a winch paid out, m", "line.elongation"),
    "elongation_rate": ("its rate, m/s", "line.elongation_rate"),
    "axial_velocity": ("dL_i/dt, m/s", "line.axial_velocity"),
    "direction_x": ("u_i in O-XYZ", "line.direction[0]"),
    "direction_y": ("u_i in O-XYZ", "line.direction[1]"),
    "direction_z": ("u_i in O-XYZ", "line.direction[2]"),
    "anchor_velocity_x": ("of the anchor in O-XYZ, m/s", "line.anchor_velocity[0]"),
    "anchor_velocity_y": ("of the anchor in O-XYZ, m/s", "line.anchor_velocity[1]"),
    "anchor_velocity_z": ("of the anchor in O-XYZ, m/s", "line.anchor_velocity[2]"),
    "elastic": ("T_i of Eq. 16, N", "line.elastic"),
    "before_pulley": (
        "the same with what acts in the cable, N; for what acts at the pulley",
        "(line.pull - line.behind)",
    ),
    "mid_span": ("X_w of Eq. 15, m", "state[12 + i]"),
    "tension": ("the tension at the anchor with all effects, N; not in `pull`", "line.pull"),
}
"""For laws of cables and pulleys: meaning, and the expression of the scalar kernel."""

NUMBERS: Mapping[str, str] = {
    "rest_length": "L_0i, m",
    "stiffness": "k_wi, N/m",
    "pretension": "T_0i, N",
    "line_density": "rho_w A, kg/m",
    "damping": "c_wi of Eq. 17, 1/s",
    "gravity": "m/s2",
    "post_share": "one over the number of cables of the post",
    "rest_direction_x": "u_i at rest, in O-XYZ",
    "rest_direction_y": "u_i at rest, in O-XYZ",
    "rest_direction_z": "u_i at rest, in O-XYZ",
}
"""For the same laws: numbers of the cable, found by `model.library.lanes`."""

PLATFORM: Mapping[str, tuple[str, str]] = {
    "x": ("X_p, m", "state[0]"),
    "y": ("Y_p, m", "state[1]"),
    "z": ("Z_p, m", "state[2]"),
    "roll": ("rad", "state[3]"),
    "pitch": ("rad", "state[4]"),
    "yaw": ("rad", "state[5]"),
    "velocity_x": ("m/s", "velocity[0]"),
    "velocity_y": ("m/s", "velocity[1]"),
    "velocity_z": ("m/s", "velocity[2]"),
    "omega_x": ("angular velocity in O-XYZ, rad/s", "omega[0]"),
    "omega_y": ("angular velocity in O-XYZ, rad/s", "omega[1]"),
    "omega_z": ("angular velocity in O-XYZ, rad/s", "omega[2]"),
}
"""For laws of the platform: meaning, and the expression of the scalar kernel."""
