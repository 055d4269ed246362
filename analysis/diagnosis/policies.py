"""How each effect of the library is fitted: which of its numbers, from where, and beside what."""

from collections.abc import Mapping
from dataclasses import dataclass, field

LAW, LINEAR, NUMBER = 0.12, 0.05, 0.01
"""Errors of form: of a law of friction or of a fibre, of a linear law, of a factor or an offset."""


@dataclass(frozen=True)
class Policy:
    """How one effect is fitted, where that is not plain from the library.

    Parameters
    ----------
    steps
        Size of a magnitude for screening; default: the library's default.
    shapes
        Numbers that are fitted, each with the values that are tried in screening; the others keep
        their default.
    begins
        Numbers of the state in which each cable begins a run: fitted for each cable and run.
    aside
        Magnitudes that are no cause of their own: nuisances move them.
    together
        Whether it is there in all cables or in none.
    form_share
        Error of form; None: by the side it acts on.
    bends
        See `Candidate`.
    """

    steps: Mapping[str, float] = field(default_factory=dict)
    shapes: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    begins: tuple[str, ...] = ()
    aside: tuple[str, ...] = ()
    together: bool = False
    form_share: float | None = None
    bends: bool = False


def _friction(**shapes: tuple[float, ...]) -> Policy:
    """Of a law whose bristles were left bent by what came before the run."""
    own = {"bristle_loss_s": (5e-4,), "dahl_exponent": (1.0,), "elastic_share": (-1.0,)}
    return Policy(shapes={**shapes, **own}, begins=("bent_at_rest",))


POLICIES: dict[str, Policy] = {
    "air_drag": Policy(shapes={"arm_m": (0.15,)}),
    # Nothing may hold the hook in its gap: then it costs no energy.
    "anchor_play": Policy(
        steps={"play_m": 1e-4},
        shapes={
            "hold_n": (0.25, 0.8),
            "held_share": (1.0, 0.0),
            "middle_share": (0.0,),
            "slide_s": (1e-3,),
        },
        form_share=0.3,
        bends=True,
    ),
    "cable_creep": Policy(shapes={"creep_s": (2.0, 20.0), "log_share": (1.0,)}),
    # A rig's stiffness may have been measured before fibres slip, or after.
    "cable_hysteresis": Policy(
        shapes={
            "yield_m": (5e-4, 2e-3),
            "bouc_wen_share": (0.0, 1.0),
            "bend": (0.5,),
            "back_share": (0.5,),
            "counted_share": (0.5,),
        }
    ),
    # Fibres relax in a spectrum of times.
    "cable_relaxation": Policy(
        shapes={"relaxation_s": (0.03, 0.5), "branch_ratio": (2.0,), "let_go_share": (1.0,)},
        form_share=LINEAR,
    ),
    # Whoever made its drive may have reckoned with cables that push, as Eq. 16 has them.
    "cable_slack": Policy(shapes={"drive_pushes": (1.0, 0.0)}, form_share=NUMBER),
    # A dashpot with a spring in series shows where a motion begins or ends at once.
    "cable_viscous": Policy(shapes={"series_s": (0.0,)}, form_share=LINEAR),
    "cable_stiffening": Policy(shapes={"quadratic_share": (0.0, 3.0), "hardening": (0.3,)}),
    # A rig's stiffness may have been measured more slowly than the slowest branch relaxes; and
    # whoever has branches farther apart, as many do with one a decade, has a loss that ripples.
    "cable_structural": Policy(
        form_share=LINEAR,
        shapes={
            "decades_below": (0.0,),
            "branch_ratio": (5.0,),
            "highest_hz": (125.0,),
            "let_go_share": (1.0,),
        },
    ),
    "platform_damping": Policy(form_share=LINEAR),
    "cable_modes": Policy(
        shapes={"line_loss_share": (1.0,), "loss_growth": (0.0,)}, form_share=0.4
    ),
    # A string that hangs between a wall and what moves is shaken, whichever cable it is.
    "cable_end_forcing": Policy(
        shapes={"reaction_share": (0.0, 1.0), "overtone_share": (1.0,)},
        together=True,
        form_share=0.2,
    ),
    # A stiff post gives way at once, and what it stands on loses.
    "frame_compliance": Policy(shapes={"frame_hz": (14.0, 25.0, 120.0), "frame_loss": (0.03, 0.6)}),
    "pulley_coulomb": _friction(presliding_m=(5e-5,)),
    # Few write the tension as growing along the wrap: to others friction is in proportion to it.
    "pulley_capstan": _friction(presliding_m=(5e-5,), loaded_share=(0.5,), growth_share=(1.0,)),
    "pulley_presliding": _friction(presliding_m=(6e-4, 2.4e-3)),
    "pulley_stribeck": _friction(
        static_ratio=(1.4,),
        stribeck_m_per_s=(0.008,),
        tail_share=(0.0,),
        presliding_m=(5e-5,),
    ),
    # Where it is tied on is told once it is there.
    "umbilical": Policy(
        shapes={
            "loss_s": (5e-3,),
            "at_x_m": (0.0, 0.1, -0.1),
            "at_y_m": (0.0,),
            "at_z_m": (0.0, 0.1, -0.1),
        }
    ),
    "pulley_inertia": Policy(
        shapes={
            "grip_s": (2e-3,),
            "front_share": (0.0, 0.2),
            "bearing_per_s": (0.0, 50.0),
            "damping_ratio": (1.0,),
            "let_go_share": (1.0, 0.0),
        },
        form_share=LINEAR,
    ),
    "pulley_geometry": Policy(shapes={"left_at_rest": (0.0, 1.0)}, form_share=LINEAR),
    "centre_of_mass": Policy(
        steps={"centre_x_m": 0.002, "centre_y_m": 0.002, "centre_z_m": 0.002},
        shapes={"drive_stays_share": (0.0,)},
    ),
    "pretension": Policy(aside=("trimmed_share",)),
    "inertia": Policy(steps={"roll_share": 0.05, "pitch_share": 0.05, "yaw_share": 0.05}),
    "camera_axis": Policy(steps={"axis_roll_deg": 0.5, "axis_pitch_deg": 0.5, "axis_yaw_deg": 0.5}),
    "camera_latency": Policy(steps={"latency_s": 0.003}),
    "camera_exposure": Policy(steps={"exposure_s": 0.0625}, form_share=LINEAR),
    # Its stamp is of any row, a picture may be turned, and markers have been fitted in space.
    "camera_rolling_shutter": Policy(
        shapes={"before_share": (0.0, 0.12), "depth_share": (0.0, 1.0), "reads_up": (0.0, 1.0)},
        form_share=LINEAR,
    ),
    # Of which order a filter is, is told once it is there.
    "cell_lag": Policy(steps={"lag_s": 0.003}, shapes={"second_order": (0.0,)}, form_share=LINEAR),
    "cell_drift": Policy(shapes={"settles_per_s": (0.0,)}, form_share=LINEAR),
    # What disturbs the platform as its motion begins need not wait for a drive that is late.
    "drive_phase": Policy(
        steps={"late_s": 0.003},
        shapes={"disturbed_late_share": (1.0, 0.0), "phase_share": (0.0, 1.0)},
    ),
    "drive_backlash": Policy(shapes={"servo_s": (6e-3,), "servo_late_s": (0.0,)}, form_share=LAW),
    "clock_drift": Policy(steps={"drift_ppm": 200.0}),
    # Whether its ramps last as commanded is told at the end of the motion alone.
    "drive_frequency": Policy(steps={"frequency_share": 2e-4}, shapes={"ramps_kept_share": (0.0,)}),
}

FRICTION = "friction at the pulleys"
FRICTIONS = ("pulley_coulomb", "pulley_capstan", "pulley_stribeck", "pulley_presliding")
"""Laws of one thing: two of them at once are rather one law that is none of these."""

DRAG = "what holds back the platform"
DRAGS = ("platform_damping", "air_drag", "umbilical")

LOSS = "loss in the cables"
LOSSES = ("cable_viscous", "cable_structural", "cable_relaxation")

LENGTH = "length of the cables"
LENGTHS = ("pretension", "cable_slack")
"""A cable that is too long pulls less from the start: only where it then hangs is it another."""

STIFFER = "stiffness that rises with the tension"
STIFFENINGS = ("cable_stiffening", "cable_sag")
"""The chord of a cable that hangs through, and fibres that are stretched straight."""

FAMILIES = (
    dict.fromkeys(FRICTIONS, FRICTION)
    | dict.fromkeys(DRAGS, DRAG)
    | dict.fromkeys(LOSSES, LOSS)
    | dict.fromkeys(LENGTHS, LENGTH)
    | dict.fromkeys(STIFFENINGS, STIFFER)
)

AKIN = {
    "cable_hysteresis": ("pulley_presliding",),
    "pulley_presliding": ("cable_hysteresis",),
}
"""Laws of other things that may do nearly the same: what gives before it slips loses as a loop
does, in a cable or at its pulley."""

WHOLE = (
    "left_at_rest",
    "reads_up",
    "drive_pushes",
    "disturbed_late_share",
    "phase_share",
    "held_share",
    "bouc_wen_share",
)
"""Shapes that are one thing or another."""

BETWEEN = (
    "bend",
    "dahl_exponent",
    "elastic_share",
    "tail_share",
    "counted_share",
    "drive_stays_share",
    "quadratic_share",
    "log_share",
    "loaded_share",
    "growth_share",
    "reaction_share",
    "overtone_share",
    "line_loss_share",
    "loss_growth",
    "depth_share",
    "servo_s",
    "servo_late_s",
    "grip_s",
    "damping_ratio",
    "frame_hz",
    "front_share",
    "middle_share",
    "let_go_share",
    "ramps_kept_share",
    "highest_hz",
    "series_s",
)
"""Shapes that lead from one law to another: a row of branches, to one whose end is out of sight; a
servo, a grip, a spring or a post, to one that is too quick to be seen; a gap, to one at whose end
the hook hangs."""

LOW_IS = {"static_ratio": "pulley_coulomb"}
"""Shapes at whose low end a law is another: that sticks no harder than it slips."""

GROWING = ("camera_exposure", "cable_sag", "cable_end_forcing")
"""What it does goes with the square of its magnitude."""
