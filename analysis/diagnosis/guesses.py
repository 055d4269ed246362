"""The paper's own guesses (its Section 5), weighed with numbers.

It lays the smaller measured amplitude to the camera's low rate, and the frequency content of the
tensions to friction and hysteresis.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from analysis.diagnosis.candidates import FRICTIONS
from analysis.diagnosis.pictures import Pictures

CAMERA = ("camera_exposure", "frames_dropped")
"""What a slow camera may do beside sampling rarely."""


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
