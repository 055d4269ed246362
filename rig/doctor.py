"""Whether this computer is fit to record: one verdict a line, with its remedy."""

import os
import shutil
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cdpr8.errors import DeviceError
from cdpr8.provenance import versions
from cdpr8.rigfile import Rig
from rig.finding import Verdict

LEAST_FREE_BYTES = 2_000_000_000
MOST_SYNC_S = 0.25
"""Longest time to get a small file onto the disk: what `rig record` states as its interval."""

LATENCY_MS = 1
"""Latency timer of FTDI adapters; 16 ms, their default, costs 128 ms a sweep."""


@dataclass(frozen=True)
class Diagnosis:
    """One line.

    Attributes
    ----------
    verdict, what, words, remedy
        How it stands, what was looked at, what was found, what to do.
    """

    verdict: Verdict
    what: str
    words: str
    remedy: str = ""


def diagnose(rig: Rig, folder: Path) -> Iterator[Diagnosis]:
    """Look at versions, ports, camera, clock and disk; opens nothing that measures.

    Parameters
    ----------
    rig
        The machine that is to be recorded.
    folder
        Where runs will go.
    """
    yield _versions()
    yield from _ports(rig)
    yield from _latency()
    yield _camera(rig)
    yield _clock()
    yield from _disk(folder)


def _versions() -> Diagnosis:
    known = ", ".join(f"{name} {number}" for name, number in versions().items())
    return Diagnosis(Verdict.OK, "versions", known)


def _ports(rig: Rig) -> Iterator[Diagnosis]:
    from rig.transport.serial_port import serial_ports

    wanted = (
        [cable.amplifier.port for cable in rig.cable if cable.amplifier is not None]
        if rig.bus.streaming
        else [rig.bus.port]
    )
    here = serial_ports()
    for port in dict.fromkeys(wanted):
        if rig.bus.port == "simulated":
            yield Diagnosis(
                Verdict.OK,
                "port",
                f"simulated (serial ports here: {', '.join(here) or 'none'})",
            )
        elif sys.platform != "win32" and not Path(port).exists():
            yield Diagnosis(
                Verdict.FAIL,
                "port",
                f"{port} is not there (ports here: {', '.join(here) or 'none'})",
                "plug the adapter in, or correct [bus] port in the rig file",
            )
        elif sys.platform != "win32" and not os.access(port, os.R_OK | os.W_OK):
            yield Diagnosis(
                Verdict.FAIL,
                "port",
                f"{port} may not be opened by this user",
                "join the group that owns it (dialout on most systems), then log in again",
            )
        else:
            yield Diagnosis(Verdict.OK, "port", port)


def _latency() -> Iterator[Diagnosis]:
    for timer in sorted(Path("/sys/bus/usb-serial/devices").glob("*/latency_timer")):
        try:
            value = int(timer.read_text())
        except (OSError, ValueError):
            # Unplugged while it was looked at: the port's own line says so.
            continue
        if value > LATENCY_MS:
            yield Diagnosis(
                Verdict.WARN,
                "latency",
                f"{timer.parent.name} waits {value} ms with every answer",
                f"echo {LATENCY_MS} | sudo tee {timer}",
            )
        else:
            yield Diagnosis(Verdict.OK, "latency", f"{timer.parent.name}: {value} ms")


def _camera(rig: Rig) -> Diagnosis:
    if rig.camera is None or rig.camera.source == "simulated":
        if rig.camera is None:
            return Diagnosis(Verdict.OK, "camera", "none in the rig file: tensions only")
        if rig.bus.port == "simulated":
            return Diagnosis(Verdict.OK, "camera", "simulated")
        return Diagnosis(
            Verdict.WARN,
            "camera",
            "simulated in the rig file, beside a real port: tensions only, no video",
            "set [camera] source to the camera's number",
        )
    from cdpr8.clock import RealClock
    from rig.camera import CaptureCamera

    try:
        camera = CaptureCamera(rig.camera, RealClock())
    except DeviceError as fault:
        return Diagnosis(Verdict.FAIL, "camera", fault.what, fault.remedy)
    camera.close()
    words = f"{camera.width_px} x {camera.height_px} px, exposure {1e3 * camera.exposure_s:g} ms"
    return Diagnosis(Verdict.OK, "camera", words)


def _clock() -> Diagnosis:
    resolution_s = time.get_clock_info("monotonic").resolution
    synced = Path("/run/systemd/timesync/synchronized").exists()
    words = f"monotonic to {1e9 * resolution_s:.0f} ns; wall clock " + (
        "synchronised" if synced else "not known to be synchronised"
    )
    if synced:
        return Diagnosis(Verdict.OK, "clock", words)
    return Diagnosis(
        Verdict.WARN,
        "clock",
        words,
        "times within a run are right; for the date, let the system keep time (NTP)",
    )


def _disk(folder: Path) -> Iterator[Diagnosis]:
    place = folder.resolve()
    while not place.exists():
        place = place.parent
    free = shutil.disk_usage(place).free
    if free < LEAST_FREE_BYTES:
        yield Diagnosis(
            Verdict.WARN, "disk", f"{free / 1e9:.1f} GB free in {place}", "free some space"
        )
    else:
        yield Diagnosis(Verdict.OK, "disk", f"{free / 1e9:.0f} GB free in {place}")
    probe = place / f".doctor-{os.getpid()}"
    try:
        took = [_sync_s(probe) for _ in range(5)]
    except OSError as error:
        yield Diagnosis(
            Verdict.FAIL,
            "writing",
            f"{place} cannot be written: {error.strerror}",
            "choose a folder you may write to with --out",
        )
        return
    finally:
        probe.unlink(missing_ok=True)
    words = f"a row is on the disk after {1e3 * max(took):.0f} ms at most (5 tries)"
    if max(took) > MOST_SYNC_S:
        yield Diagnosis(Verdict.WARN, "writing", words, "record onto a local disk")
    else:
        yield Diagnosis(Verdict.OK, "writing", words)


def _sync_s(path: Path) -> float:
    began = time.perf_counter()
    with path.open("w") as file:
        file.write("row\n" * 100)
        file.flush()
        os.fsync(file.fileno())
    return time.perf_counter() - began
