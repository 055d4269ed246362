"""The library's effects as candidates: which of their numbers are fitted, and how."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain

import numpy as np

from analysis.engine.candidate import Candidate, Shape, Term
from model.library.discovery import library
from model.library.effect import Effect, Parameter

CABLE_NUMBERS = tuple(range(1, 9))

PAIRS = tuple((i, k) for i in CABLE_NUMBERS for k in CABLE_NUMBERS if i < k)

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
    return Policy(shapes={**shapes, "bristle_loss_s": (5e-4,)}, begins=("bent_at_rest",))


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
            "counted_share": (0.5,),
        }
    ),
    # Fibres relax in a spectrum of times.
    "cable_relaxation": Policy(
        shapes={"relaxation_s": (0.03, 0.5), "branch_ratio": (2.0,)}, form_share=LINEAR
    ),
    # Whoever made its drive may have reckoned with cables that push, as Eq. 16 has them.
    "cable_slack": Policy(shapes={"drive_pushes": (1.0, 0.0)}, form_share=NUMBER),
    "cable_viscous": Policy(form_share=LINEAR),
    "cable_stiffening": Policy(shapes={"quadratic_share": (0.0, 3.0), "hardening": (0.3,)}),
    # A rig's stiffness may have been measured more slowly than the slowest branch relaxes; and
    # whoever has branches farther apart, as many do with one a decade, has a loss that ripples.
    "cable_structural": Policy(
        form_share=LINEAR,
        shapes={"decades_below": (0.0,), "branch_ratio": (5.0,), "highest_hz": (125.0,)},
    ),
    "platform_damping": Policy(form_share=LINEAR),
    "cable_modes": Policy(form_share=0.4),
    # A string that hangs between a wall and what moves is shaken, whichever cable it is.
    "cable_end_forcing": Policy(
        shapes={"reaction_share": (0.0, 1.0)}, together=True, form_share=0.2
    ),
    "frame_compliance": Policy(shapes={"frame_hz": (14.0, 25.0), "frame_loss": (0.03,)}),
    "pulley_coulomb": _friction(presliding_m=(5e-5,)),
    "pulley_capstan": _friction(presliding_m=(5e-5,), loaded_share=(0.5,)),
    "pulley_presliding": _friction(presliding_m=(6e-4, 2.4e-3)),
    "pulley_stribeck": _friction(
        static_ratio=(1.4,), stribeck_m_per_s=(0.008,), presliding_m=(5e-5,)
    ),
    # Where it is tied on is told once it is there.
    "umbilical": Policy(
        shapes={"loss_s": (5e-3,), "at_x_m": (0.0,), "at_y_m": (0.0,), "at_z_m": (0.0,)}
    ),
    "pulley_inertia": Policy(
        shapes={"grip_s": (2e-3,), "front_share": (0.0, 0.2), "bearing_per_s": (0.0, 50.0)},
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
    # A filter's second pole is told once it is there.
    "cell_lag": Policy(steps={"lag_s": 0.003}, shapes={"second_share": (0.0,)}, form_share=LINEAR),
    "cell_drift": Policy(shapes={"settles_per_s": (0.0,)}, form_share=LINEAR),
    # What disturbs the platform as its motion begins need not wait for a drive that is late.
    "drive_phase": Policy(steps={"late_s": 0.003}, shapes={"disturbed_late_share": (1.0, 0.0)}),
    "drive_backlash": Policy(shapes={"servo_s": (6e-3,)}, form_share=LAW),
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
    "held_share",
    "bouc_wen_share",
)
"""Shapes that are one thing or another."""

BETWEEN = (
    "bend",
    "counted_share",
    "drive_stays_share",
    "quadratic_share",
    "log_share",
    "loaded_share",
    "reaction_share",
    "depth_share",
    "front_share",
    "ramps_kept_share",
    "highest_hz",
)
"""Shapes that lead from one law to another: a row of branches, to one whose end is out of sight."""

SATURATION_STEP_N = 0.3

RUN_CODE = 1000.0
"""Moments are seconds of a run's clock and this many times the run's number; after the last run's
number comes that of all of them."""

GROWING = ("camera_exposure", "cable_sag", "cable_end_forcing")
"""What it does goes with the square of its magnitude."""


def candidates(
    names: Sequence[str] | None, times_s: Sequence[tuple[float, float]], frame_hz: float
) -> tuple[Candidate, ...]:
    """Candidates of the library.

    Parameters
    ----------
    names
        Those to look at; None: all.
    times_s
        Start and end of the motion of each run.
    frame_hz
        Of the camera.
    """
    chosen = library() if names is None else {name: library()[name] for name in names}
    found = []
    for name, effect in chosen.items():
        if name == "drive_harmonic":
            found.append(_harmonic(effect))
        elif name == "cell_swapped":
            found.append(_swapped(effect))
        elif name == "cell_saturation":
            found.append(_saturation(effect))
        elif name == "frames_dropped":
            found.append(_dropped(effect, times_s, frame_hz))
        else:
            found.append(_plain(effect, POLICIES.get(name, Policy()), len(times_s)))
    return tuple(found)


def _plain(effect: Effect, policy: Policy, records: int) -> Candidate:
    magnitudes = [
        one for one in effect.parameters if one.magnitude and one.name not in policy.aside
    ]
    terms = []
    for one in magnitudes:
        step = policy.steps.get(one.name, one.default) or 0.2 * one.high
        if effect.name == "geometry":
            step = 0.003
        if one.per_cable:
            terms += [_term(one, step, str(cable)) for cable in CABLE_NUMBERS]
        else:
            terms.append(_term(one, step, ""))
    shapes = tuple(
        Shape(one.name, one.unit, one.default, one.low, one.high,
              policy.shapes[one.name], logarithmic=one.low > 0.0, whole=one.name in WHOLE,
              between=one.name in BETWEEN)
        for one in effect.parameters
        if one.name in policy.shapes
    )  # fmt: skip
    shapes += tuple(
        Shape(begun_name(one.name, cable, record, records), one.unit, one.default, one.low,
              one.high, logarithmic=False, term=f"{magnitudes[0].name}@{cable}")
        for one in effect.parameters
        if one.name in policy.begins
        for record in range(records)
        for cable in CABLE_NUMBERS
    )  # fmt: skip
    exact = effect.acts.side in ("parameter", "cell", "camera", "clock", "drive")
    form = policy.form_share if policy.form_share is not None else NUMBER if exact else LAW
    wholes: tuple[tuple[str, ...], ...] = ()
    if effect.name == "geometry":
        wholes = _shifted(magnitudes)
    elif len(magnitudes) == 1 and magnitudes[0].per_cable:
        wholes = _wholes(magnitudes[0])
    return Candidate(
        name=effect.name,
        title=effect.title,
        side=effect.acts.side,
        terms=tuple(terms),
        shapes=shapes,
        form_share=form,
        together=policy.together,
        shareable=len(magnitudes) == 1 or effect.name == "geometry",
        combinations=wholes,
        akin=AKIN.get(effect.name, ()),
        chosen_terms=12 if effect.name == "geometry" else 0,
        family=FAMILIES.get(effect.name, ""),
        grows=effect.name in GROWING,
        bends=policy.bends,
    )


def begun_name(parameter: str, cable: int, record: int, records: int) -> str:
    """What a number of the state is called in which a cable begins a run."""
    return f"{parameter}@{cable}" + (f" in run {record + 1}" if records > 1 else "")


def _term(parameter: Parameter, step: float, place: str) -> Term:
    name = f"{parameter.name}@{place}" if place else parameter.name
    return Term(name, parameter.name, parameter.unit, place, parameter.low, parameter.high, step)


def _wholes(parameter: Parameter) -> tuple[tuple[str, ...], ...]:
    """All cables, the upper and the lower four: sets that often share their fate."""
    sets = (CABLE_NUMBERS, CABLE_NUMBERS[:4], CABLE_NUMBERS[4:])
    return tuple(tuple(f"{parameter.name}@{cable}" for cable in one) for one in sets)


def _shifted(parameters: Sequence[Parameter]) -> tuple[tuple[str, ...], ...]:
    """Posts or plates that were measured as one: all points of a kind, along one axis or any."""
    bases = [one for one in parameters if one.name.startswith("base")]
    anchors = [one for one in parameters if one.name.startswith("anchor")]
    kinds = [bases, anchors, *([one] for one in parameters)]
    return tuple(
        tuple(chain.from_iterable(sets))
        for kind in kinds
        for sets in zip(*map(_wholes, kind), strict=True)
    )


def _harmonic(effect: Effect) -> Candidate:
    limit = next(one.high for one in effect.parameters if one.name == "harmonic_share")
    terms = tuple(
        Term(name, "harmonic_share", "1", "", -limit, limit, 0.01) for name in ("sine", "cosine")
    )
    order = Shape("order", "1", 2.0, 2.0, 5.0, (2.0, 3.0, 4.0, 5.0), whole=True)
    return Candidate(effect.name, effect.title, effect.acts.side, terms, (order,), LINEAR,
                     together=True, shareable=False)  # fmt: skip


def _swapped(effect: Effect) -> Candidate:
    term = Term("swapped", "swapped", "1", "", 0.0, 1.0, 1.0)
    pair = Shape(
        "pair", "1", 0.0, 0.0, len(PAIRS) - 1.0, tuple(float(i) for i in range(len(PAIRS))),
        logarithmic=False, whole=True,
    )  # fmt: skip
    return Candidate(effect.name, effect.title, effect.acts.side, (term,), (pair,), NUMBER,
                     fixed=True)  # fmt: skip


def _saturation(effect: Effect) -> Candidate:
    terms = tuple(
        Term(f"clipped_n@{cable}", "clipped_n", "N", str(cable), 0.0, 30.0, SATURATION_STEP_N)
        for cable in CABLE_NUMBERS
    )
    # Over how much of what is cut off it bends: what cuts off nothing then does nothing.
    knee = Shape("knee_share", "1", 0.5, 0.002, 5.0, (0.1, 1.0))
    return Candidate(effect.name, effect.title, effect.acts.side, terms, (knee,), 0.1,
                     shareable=False, grows=True)  # fmt: skip


def _dropped(effect: Effect, times_s: Sequence[tuple[float, float]], frame_hz: float) -> Candidate:
    term = Term("frames", "frames", "1", "", 0.0, 3.0, 1.0)
    count = Shape("count", "1", 1.0, 1.0, 3.0, (1.0, 2.0, 3.0), logarithmic=False, whole=True)
    moments: list[float] = []
    spacing = 0.25 if len(times_s) == 1 else 0.5
    spans = list(times_s)
    if len(spans) > 1:
        # A program that loses them may do so in every run, and at the same time.
        spans.append((min(start for start, _ in spans), min(end for _, end in spans)))
    for i, (start, end) in enumerate(spans):
        moments += [RUN_CODE * i + at for at in np.arange(start + 0.25, end - 0.1, spacing)]
    when = Shape(
        "moment", "s", moments[0], 0.0, 1e5, tuple(moments),
        logarithmic=False, whole=True, finest=0.5 / frame_hz,
    )  # fmt: skip
    again = tuple(
        Shape(one.name, one.unit, one.default, one.low, one.high, logarithmic=False, whole=True)
        for one in effect.parameters
        if one.name.startswith("again_")
    )
    return Candidate(effect.name, effect.title, effect.acts.side, (term,), (count, when, *again),
                     NUMBER, fixed=True)  # fmt: skip
