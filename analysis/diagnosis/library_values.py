"""A candidate's numbers as the library's effect takes them."""

from collections.abc import Sequence
from math import atan2, hypot

from analysis.diagnosis.candidates import CABLE_NUMBERS, PAIRS, RUN_CODE, begun_name
from analysis.diagnosis.policies import POLICIES, Policy
from analysis.diagnosis.sighting import Sighting
from analysis.engine.candidate import Setting
from model.library.discovery import library


def library_values(
    name: str,
    setting: Setting,
    peaks_n: Sequence[float],
    record: int,
    sighting: Sighting,
    records: int = 1,
) -> dict[str, float | tuple[float, ...]] | None:
    """A candidate's numbers as the library's effect takes them.

    Parameters
    ----------
    name, setting
        The candidate and its numbers.
    peaks_n
        Highest tension of each cable without it.
    record
        Which run it is for.
    sighting
        What the rig file says of the camera.
    records
        How many runs there are.

    Returns
    -------
    dict or None
        None where it does nothing in this run.
    """
    if name == "drive_harmonic":
        sine, cosine = setting.values.get("sine", 0.0), setting.values.get("cosine", 0.0)
        return {
            "harmonic_share": hypot(sine, cosine),
            "harmonic_phase_rad": atan2(cosine, sine),
            "order": setting.shapes.get("order", 2.0),
        }
    if name == "cell_swapped":
        pair = PAIRS[round(setting.shapes.get("pair", 0.0))]
        on = setting.values.get("swapped", 0.0) > 0.0
        return {"swapped": tuple(float(on and c in pair) for c in CABLE_NUMBERS)}
    if name == "cell_saturation":
        clips = [setting.values.get(f"clipped_n@{c}", 0.0) for c in CABLE_NUMBERS]
        knee, pairs = setting.shapes.get("knee_share", 0.0), zip(peaks_n, clips, strict=True)
        limits = [max(peak - clip, 1e-3) if clip > 0.0 else 0.0 for peak, clip in pairs]
        return {"limit_n": tuple(limits), "knee_n": tuple(knee * clip for clip in clips)}
    if name == "frames_dropped":
        run, at_s = divmod(setting.shapes.get("moment", 0.0), RUN_CODE)
        if setting.values.get("frames", 0.0) <= 0.0 or run not in (record, records):
            return None
        return {
            "frames": setting.shapes.get("count", 1.0),
            "at_s": at_s,
            "frame_hz": sighting.frame_hz,
            **{key: at for key, at in setting.shapes.items() if key.startswith("again_")},
        }
    effect = library()[name]
    values: dict[str, float | tuple[float, ...]] = {
        key: one for key, one in setting.shapes.items() if "@" not in key
    }
    if name == "camera_rolling_shutter":
        values = {**sighting.shutter, **values}
    for begun in POLICIES.get(name, Policy()).begins:
        values[begun] = tuple(
            setting.shapes.get(begun_name(begun, c, record, records), 0.0) for c in CABLE_NUMBERS
        )
    for one in effect.parameters:
        if not one.magnitude:
            continue
        if one.per_cable:
            values[one.name] = tuple(
                setting.values.get(f"{one.name}@{c}", 0.0) for c in CABLE_NUMBERS
            )
        else:
            values[one.name] = setting.values.get(one.name, 0.0)
    return values
