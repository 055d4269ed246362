"""The paper's own guesses (its Section 5), weighed with numbers.

It lays the smaller measured amplitude to the camera's low rate, and the frequency content of the
tensions to friction and hysteresis.
"""

from collections.abc import Mapping, Sequence
from math import log
from typing import Any

import numpy as np

from analysis.diagnosis.pictures import Pictures
from analysis.diagnosis.policies import FRICTIONS
from analysis.diagnosis.spelling import odds

CAMERA = ("camera_exposure", "frames_dropped")
"""What a slow camera may do beside sampling rarely."""

NO_GAP_DEG, HALF = 0.005, 0.5
"""Angles that differ by no more than this do not differ; and what makes less than this share of a
difference is not its reason."""


def guesses(
    pictures: Pictures, ranked: Sequence[Mapping[str, Any]], out: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    """What the recording says to both guesses.

    Parameters
    ----------
    pictures
        Recorded and simulated.
    ranked, out
        From `ranking` and `ruled_out`.

    Returns
    -------
    dict
        "camera_rate": amplitudes in deg, and the share of the difference that sampling at the
        camera's frames makes; "frequency_content": rms residual of the tensions at the second to
        tenth harmonic, in units of noise, and log odds of friction and hysteresis. A guess that the
        runs cannot speak to is left out.
    """
    found: dict[str, Any] = {}
    peaks = next((one.peaks_deg for one in pictures.records if one.peaks_deg), None)
    if peaks is not None:
        simulated, framed, recorded = peaks
        gap = simulated - recorded
        found["camera_rate"] = {
            "simulated_deg": simulated,
            "at_frames_deg": framed,
            "recorded_deg": recorded,
            "share": (simulated - framed) / gap if gap else 0.0,
            "log_odds": {one["effect"]: one["log_odds"] for one in out if one["effect"] in CAMERA},
        }
    tensions = [
        one for one in pictures.channels if one.kind == "tension" and one.harmonics_before.size > 2
    ]
    if tensions:
        found["frequency_content"] = {
            "before": _rms([one.harmonics_before[2:] for one in tensions]),
            "after": _rms([one.harmonics_after[2:] for one in tensions]),
            "friction_log_odds": best_with(ranked, FRICTIONS),
            "hysteresis_log_odds": best_with(ranked, ("cable_hysteresis",), FRICTIONS),
        }
    return found


def best_with(
    ranked: Sequence[Mapping[str, Any]], any_of: Sequence[str], none_of: Sequence[str] = ()
) -> float | None:
    """Log odds of the best hypothesis that has one of these and none of those; None: none was."""
    fitting = [
        one["log_odds"]
        for one in ranked
        if set(one["effects"]) & set(any_of) and not set(one["effects"]) & set(none_of)
    ]
    return max(fitting, default=None)


def _rms(parts: Sequence[Any]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def in_words(said: Mapping[str, Any]) -> str:
    """The paper's guesses, weighed, as the statement has them."""
    told = said.get("paper_guesses") or {}
    texts = []
    camera = told.get("camera_rate")
    if camera:
        texts.append(
            "The paper suspects the camera's rate behind the smaller measured angle. Seen only at "
            f"the camera's frames, the simulated {camera['simulated_deg']:.3f} deg would read "
            f"{camera['at_frames_deg']:.3f} deg, against {camera['recorded_deg']:.3f} deg "
            f"recorded: {_rate(camera)}"
        )
        exposure = camera["log_odds"].get("camera_exposure")
        if exposure is not None and exposure < -log(20.0):
            texts.append(f"A long exposure instead is ruled out, {odds(-exposure)}.")
    content = told.get("frequency_content")
    if content:
        texts.append(_frequency_content(said, content))
    return " ".join(texts)


def _rate(camera: Mapping[str, Any]) -> str:
    """What the camera's rate makes of the difference between simulated and measured angle."""
    gap, share = camera["simulated_deg"] - camera["recorded_deg"], camera["share"]
    if abs(gap) <= NO_GAP_DEG:
        return "there is no difference to explain."
    if gap < 0.0:
        return "the measured angle is the larger one, which no rate makes it."
    if share <= 0.0:
        return "the rate makes none of the difference, so it is not the reason."
    ends = ", so it is not the reason." if share < HALF else "."
    return f"the rate makes {100.0 * share:.0f} % of the difference{ends}"


def _frequency_content(said: Mapping[str, Any], content: Mapping[str, Any]) -> str:
    text = (
        "It suspects friction and hysteresis behind the frequency content of the tensions. At the "
        f"second to tenth harmonic the tensions are {content['before']:.3g} times the noise off "
    )
    if not said["causes"]:
        return text + "with nothing left out, and neither is asked for."
    text += f"before and {content['after']:.3g} times after."
    friction, hysteresis = content["friction_log_odds"], content["hysteresis_log_odds"]
    if friction is None and hysteresis is None:
        return text + " Neither was near enough to be fitted."
    if friction is not None and (hysteresis is None or friction > hysteresis):
        text += " Friction"
        against, of = hysteresis, "hysteresis of the cables without friction"
        best = friction
    else:
        text += " Hysteresis of the cables"
        against, of = friction, "friction at the pulleys"
        best = hysteresis
    text += (
        " is in the best explanation"
        if best == 0.0
        else f" is {odds(-(best or 0.0))} behind the best"
    )
    if against is None:
        return text + f"; {of} was not near enough to be fitted."
    return text + f"; {of} is {odds((best or 0.0) - against)} behind it."
