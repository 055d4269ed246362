"""The frame gives way under its cables; those of one post move together."""

from typing import Any

import numpy as np

from model.library.effect import Acts, Effect, Parameter, State

TURN = 2.0 * float(np.pi)


def pull(
    compliance_m_per_n: Any,
    give_x: Any,
    give_y: Any,
    give_z: Any,
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
    stiffness: Any,
) -> Any:
    """Add k u . b, b = C f the way the base point has moved: the cable is that much longer."""
    along = direction_x * give_x + direction_y * give_y + direction_z * give_z
    return stiffness * compliance_m_per_n * along


def rates(
    frame_hz: Any,
    frame_loss: Any,
    give_x: Any,
    give_y: Any,
    give_z: Any,
    give_x_rate: Any,
    give_y_rate: Any,
    give_z_rate: Any,
    tension: Any,
    pretension: Any,
    direction_x: Any,
    direction_y: Any,
    direction_z: Any,
    rest_direction_x: Any,
    rest_direction_y: Any,
    rest_direction_z: Any,
    post_share: Any,
) -> Any:
    """Give f'' = w^2 (F - f) - 2 zeta w f': the post's mode under its cables, over rest."""
    turn = TURN * frame_hz
    loss = 2.0 * frame_loss * turn * post_share
    spring = turn * turn
    pull_x = pretension * rest_direction_x - tension * direction_x
    pull_y = pretension * rest_direction_y - tension * direction_y
    pull_z = pretension * rest_direction_z - tension * direction_z
    return (
        post_share * give_x_rate,
        post_share * give_y_rate,
        post_share * give_z_rate,
        spring * (pull_x - post_share * give_x) - loss * give_x_rate,
        spring * (pull_y - post_share * give_y) - loss * give_y_rate,
        spring * (pull_z - post_share * give_z) - loss * give_z_rate,
    )


EFFECT = Effect(
    name="frame_compliance",
    title="compliance of the frame, shared by the cables of a post",
    acts=Acts.CABLE,
    equation="T += k C u.f, f'' + 2 zeta w f' + w^2 f = -w^2 sum over the post of (T u - T_0 u_0)",
    source="one mode of each post in each direction; Pott, Cable-Driven Parallel Robots (2018)",
    signature="the same loss of stiffness in cables that share a post; a line at the frame's mode",
    parameters=(
        Parameter("compliance_m_per_n", "m/N", 2e-5, 0.0, 3e-4, "C", magnitude=True),
        Parameter("frame_hz", "Hz", 25.0, 5.0, 150.0, "w / 2 pi"),
        Parameter("frame_loss", "1", 0.03, 5e-3, 1.0, "zeta"),
    ),
    states=(
        *(
            State(f"give_{axis}", "N", f"f along {axis.upper()}", True, held_by=f"give_{axis}_rate")
            for axis in "xyz"
        ),
        *(State(f"give_{axis}_rate", "N/s", "its rate", shared=True) for axis in "xyz"),
    ),
    pull=pull,
    rates=rates,
    longest_step_s=2e-3,
    cost="the frame's mode may be the highest tone of the machine; twice the steps",
)
