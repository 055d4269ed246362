"""start.json: what is known before the first sample."""

import hashlib
import math
import uuid

from cdpr8.provenance import versions
from cdpr8.rigfile import Excitation, Rig
from cdpr8.runfolder import UNKNOWN, CameraStart, ClockAnchor, Node, StartRecord
from rig.camera import Camera
from rig.filter_delay import filter_delay
from rig.machine import Machine
from rig.station import Station
from rig.zeros import Zeros, taken


def start_record(
    machine: Machine,
    stations: tuple[Station, ...],
    rig: Rig,
    rig_text: str,
    excitation: Excitation,
    *,
    rig_file: str,
    reconstruction: str | None,
    seed: int,
    anchor: ClockAnchor,
    zeros: Zeros | None = None,
    command_log: str | None = None,
) -> StartRecord:
    """The start record of a run.

    Parameters
    ----------
    machine, stations
        Opened and configured.
    rig, rig_text, rig_file
        The rig, its file's text and name.
    excitation
        The motion.
    reconstruction
        Said where the data are made to stand for others.
    seed
        Of a simulated rig.
    anchor
        The run's time against wall time.
    zeros
        Host-side zeros of the cells.
    command_log
        Which log of the winch controller is recorded, and how it is read.
    """
    # From the wall time, so unique; and from what repeats a run, so repeated with it.
    name = f"{anchor.wall.isoformat()}\n{rig_text}\n{excitation}\n{seed}"
    return StartRecord(
        id=str(uuid.uuid5(uuid.NAMESPACE_OID, name)),
        simulated=machine.simulated,
        reconstruction=reconstruction,
        rig_file=rig_file,
        rig_sha256=hashlib.sha256(rig_text.encode("utf-8")).hexdigest(),
        excitation=excitation,
        motion_start_known=machine.motion_known,
        nodes=tuple(_node(station, zeros, rig) for station in stations),
        sweep="streaming" if rig.bus.streaming else rig.bus.sweep,
        camera=_camera(machine.camera, rig),
        clock_anchor=anchor,
        command_log=command_log,
        seed=seed if machine.simulated else None,
        versions=versions(),
    )


def _node(station: Station, zeros: Zeros | None, rig: Rig) -> Node:
    delay = filter_delay(station, rig)
    known = station.profile
    # On a port of its own a value's time is fitted, and what of it is left is not stated.
    sigma_s = None if rig.bus.streaming else station.period_s / math.sqrt(12.0)
    return Node.model_validate(
        {
            "cable": station.cable,
            "address": station.address,
            "identity": station.identity.text,
            "settings": station.state.settings,
            "found": station.state.found,
            "profile": UNKNOWN if known is None else known.name,
            "value_bytes": station.format.length,
            "zero_mv_per_v": station.scaling.zero_mv_per_v,
            "zero_taken": taken(zeros, station.cable),
            "output_period_s": station.period_s,
            "sampling_sigma_s": sigma_s,
            "filter_delay_s": None if delay is None else delay.delay_s,
            "filter_delay_sigma_s": None if delay is None else delay.sigma_s,
            "filter_delay_from": UNKNOWN if delay is None else delay.source,
        }
    )


def _camera(camera: Camera | None, rig: Rig) -> CameraStart | None:
    if camera is None or rig.camera is None:
        return None
    return CameraStart(
        source=camera.source,
        fps=camera.fps,
        exposure_s=camera.exposure_s,
        width_px=camera.width_px,
        height_px=camera.height_px,
        region_of_interest=rig.camera.region_of_interest,
    )
