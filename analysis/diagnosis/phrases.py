"""One sentence for each effect of the library, with its cables and its numbers."""

from collections.abc import Callable, Mapping
from typing import Any

from analysis.diagnosis.candidates import RUN_CODE
from analysis.diagnosis.spelling import cables, listed, sentence
from analysis.diagnosis.told import Told


def phrase(cause: Mapping[str, Any]) -> str:
    """What a cause does, as one sentence.

    Parameters
    ----------
    cause
        One of the statement's causes.
    """
    say = PHRASES.get(cause["effect"])
    text = say(Told(cause)) if say else f"{cause['effect']} acts on {cause['where']['side']}"
    return sentence(text)


COUNTS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight")
"""In words, as a sentence begins."""


def _lost_frames(c: Told) -> str:
    """How many, and from when on: of those lost one by one, each."""
    further = sorted(name for name in c.names if name.startswith("again_"))
    again = [c.value(name) for name in further if c.value(name) > 0.0]
    first = max(round(c.value("count")), 1)
    count, times = first + len(again), [c.value("moment") % RUN_CODE, *again]
    many = "frame of the video is" if count == 1 else "frames of the video are"
    return (
        f"{COUNTS[min(count, len(COUNTS) - 1)]} {many} missing without a mark, from "
        f"{listed([f'{at:.2f}' for at in times])} s on"
    )


PHRASES: Mapping[str, Callable[[Told], str]] = {
    # cables
    "anchor_play": lambda c: (
        f"the hook at the anchor of {c.who} has {c.of('play_m')} of play, which it runs through "
        "after each reversal of the force"
    ),
    "cable_creep": lambda c: (
        f"{c.who} {c.does('creeps', 'creep')} under load by {c.of('creep_share')} of "
        f"{c.does('its', 'their')} elastic elongation each time that passes e-fold, from "
        f"{c.of('creep_s')} on, so the mean tension falls ever more slowly"
    ),
    "cable_end_forcing": lambda c: (
        f"the moving anchor shakes {c.who} sideways, {c.of('forcing_share')} times as much as a "
        "taut string would take up"
    ),
    "cable_hysteresis": lambda c: (
        f"{c.who} {c.does('follows', 'follow')} a hysteresis loop of the fibres: "
        f"{c.of('loop_share')} of the stiffness is lost once the fibres slip, "
        f"{c.of('yield_m')} after each reversal"
    ),
    "cable_modes": lambda c: (
        f"{c.who} {c.does('vibrates', 'vibrate')} in transverse modes beyond the first, with "
        f"{c.of('coupling')} of the coupling that theory gives"
    ),
    "cable_relaxation": lambda c: (
        f"{c.who} {c.does('relaxes', 'relax')}: {c.of('branch_share')} of the stiffness gives way "
        f"within {c.of('relaxation_s')}"
    ),
    "cable_sag": lambda c: (
        f"{c.who} {c.does('sags', 'sag')} under {c.of('weight_share')} times the weight that the "
        "rig file states, and so soften at low tension"
    ),
    "cable_slack": lambda c: (
        f"{c.who} {c.does('is', 'are')} {c.of('slack_m')} longer than thought and "
        f"{c.does('goes', 'go')} slack when tension is low"
    ),
    "cable_stiffening": lambda c: (
        f"{c.who} {c.does('stiffens', 'stiffen')} as {c.does('it is', 'they are')} stretched, by "
        f"{c.of('cubic_n_per_m3')} times the elongation cubed"
    ),
    "cable_structural": lambda c: (
        f"{c.who} {c.does('dissipates', 'dissipate')} a share of {c.does('its', 'their')} elastic "
        f"energy in each cycle, whatever the frequency: a loss factor of {c.of('loss_factor')}"
    ),
    "cable_viscous": lambda c: (
        f"{c.who} {c.does('damps', 'damp')} the motion in proportion to speed, with "
        f"{c.of('viscous_n_s_per_m')}"
    ),
    "frame_compliance": lambda c: (
        f"the frame gives way under {c.who}, by {c.of('compliance_m_per_n')}, with a mode at "
        f"{c.of('frame_hz')}"
    ),
    # pulleys
    "pulley_capstan": lambda c: (
        f"{c.who} {c.does('rubs', 'rub')} on {c.does('its pulley', 'their pulleys')} in "
        f"proportion to tension, with a friction coefficient of {c.of('friction')}"
    ),
    "pulley_coulomb": lambda c: (
        f"{c.who} {c.does('loses', 'lose')} {c.of('coulomb_n')} to friction at "
        f"{c.does('its pulley', 'their pulleys')}, whichever way {c.does('it runs', 'they run')}, "
        "so the tension steps by twice that at each reversal"
    ),
    "pulley_geometry": lambda c: (
        f"the pulley of {c.who} has a radius of {c.of('radius_m')}, which changes the cable's "
        "length as it swings; the model has a point there"
    ),
    "pulley_inertia": lambda c: (
        f"the pulley of {c.who} has to be spun up with the cable, as a mass of "
        f"{c.of('equivalent_kg')}"
    ),
    "pulley_presliding": lambda c: (
        f"{c.who} {c.does('loses', 'lose')} {c.of('coulomb_n')} to friction at "
        f"{c.does('its pulley', 'their pulleys')}, which builds up over "
        f"{c.of('presliding_m')} of travel after each reversal"
    ),
    "pulley_stribeck": lambda c: (
        f"{c.who} {c.does('loses', 'lose')} {c.of('coulomb_n')} to friction at "
        f"{c.does('its pulley', 'their pulleys')}, and {c.of('static_ratio')} times that when "
        "starting from rest at each reversal"
    ),
    # platform
    "air_drag": lambda c: (
        "air resists the platform as the square of its speed: "
        + c.all_of(("drag_area_m2", "a drag area of"), ("turning_n_m_s2", "and in turning"))
    ),
    "platform_damping": lambda c: (
        "something damps the platform itself, in proportion to its speed: "
        + c.all_of(("linear_n_s_per_m", "in moving"), ("angular_n_m_s", "in turning"))
    ),
    "umbilical": lambda c: (
        "the umbilical pulls the platform back like a spring: "
        + c.all_of(("spring_n_per_m", "in moving"), ("turning_n_m_per_rad", "in turning"))
    ),
    # parameters
    "centre_of_mass": lambda c: (
        "the platform's centre of mass is not where the rig file has it: off by "
        + c.all_of(("centre_x_m", "x"), ("centre_y_m", "y"), ("centre_z_m", "z"))
    ),
    "geometry": lambda c: (
        f"{c.who} {c.does('does', 'do')} not run between the points of the rig file: off by "
        + c.all_of(
            *((f"base_{a}_m", f"base {a}") for a in "xyz"),
            *((f"anchor_{a}_m", f"anchor {a}") for a in "xyz"),
        )
    ),
    "inertia": lambda c: (
        "the platform's moments of inertia are not those of the rig file: off by "
        + c.all_of(("roll_share", "roll"), ("pitch_share", "pitch"), ("yaw_share", "yaw"))
    ),
    "mass": lambda c: (
        f"the platform is {c.signed('mass_share', 'heavier', 'lighter')} than the rig file says"
    ),
    "pretension": lambda c: (
        f"{c.who} {c.does('is', 'are')} tightened "
        f"{c.signed('pretension_offset_n', 'more', 'less')} than the rig file says"
    ),
    "stiffness": lambda c: (
        f"{c.who} {c.does('is', 'are')} {c.signed('stiffness_share', 'stiffer', 'softer')} than "
        "the rig file says"
    ),
    # drive
    "drive_amplitude": lambda c: (
        f"the drive moves {c.signed('amplitude_share', 'more', 'less')} than commanded"
    ),
    "drive_backlash": lambda c: (
        f"the drive has {c.of('backlash_deg')} of backlash, which it runs through at each reversal"
    ),
    "drive_frequency": lambda c: (
        f"the drive runs {c.signed('frequency_share', 'faster', 'slower')} than commanded"
    ),
    "drive_harmonic": lambda c: (
        f"the drive also moves at {c.value('order') or 2.0:.0f} times its frequency, with "
        f"{c.of('harmonic_share')} of its amplitude"
    ),
    "drive_phase": lambda c: (
        f"the drive is {c.signed('late_s', 'later', 'earlier')} than commanded"
    ),
    # cells
    "cell_drift": lambda c: (
        f"{c.whose} {c.does('drifts', 'drift')} by {c.of('drift_n_per_s')}, whatever the cable does"
    ),
    "cell_gain": lambda c: (
        f"{c.whose} {c.does('reads', 'read')} {c.signed('gain_share', 'too high', 'too low')}"
    ),
    "cell_lag": lambda c: f"{c.whose} {c.does('lags', 'lag')} the tension by {c.of('lag_s')}",
    "cell_saturation": lambda c: (
        f"{c.whose} {c.does('clips', 'clip')} the highest tensions, by up to {c.of('clipped_n')}"
    ),
    "cell_swapped": lambda c: (
        f"the force cells of {cables(c.cables)} are swapped: each channel holds the other's cable"
    ),
    "cell_zero": lambda c: (
        f"{c.whose} {c.does('reads', 'read')} {c.signed('zero_n', 'too high', 'too low')} "
        "throughout: its zero is off"
    ),
    # camera and clocks
    "camera_axis": lambda c: (
        "the camera's axes are turned against the platform's, by "
        + c.all_of(("axis_roll_deg", "roll"), ("axis_pitch_deg", "pitch"), ("axis_yaw_deg", "yaw"))
    ),
    "camera_exposure": lambda c: (
        f"each frame is exposed for {c.of('exposure_s')}, which blurs the motion and lowers its "
        "amplitude"
    ),
    "camera_gain": lambda c: (
        f"the camera shows every movement {c.signed('gain_share', 'too large', 'too small')}"
    ),
    "camera_latency": lambda c: (
        f"the camera's stamps are {c.signed('latency_s', 'late', 'early')} against the tensions"
    ),
    "camera_rolling_shutter": lambda c: (
        f"the camera reads its rows one after another, over {c.of('readout_s')}, which tilts what "
        "moves"
    ),
    "clock_drift": lambda c: (
        f"the camera's clock runs {c.signed('drift_ppm', 'fast', 'slow')} against the tensions'"
    ),
    "frames_dropped": _lost_frames,
}
