"""Rendered takes with their truth, and run folders made of them."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from cdpr8.rigfile.schema import CameraPose, Plate, Rig
from cdpr8.runfolder import CameraStart, ClockAnchor, RunWriter, StartRecord
from rig.simulated.camera import SimulatedCamera
from rig.simulated.render import Appearance

PITCH_DEG = 2.0
PITCH_HZ = 2.06
FPS = 16.0
REST_S = 0.5

Motion = Callable[[np.ndarray], np.ndarray]


def moving(t: np.ndarray) -> np.ndarray:
    """Rest, then 2 deg of pitch at 2.06 Hz with a few millimetres and tenths of a degree beside."""
    after = np.clip(t - REST_S, 0.0, None)
    poses = np.zeros((len(t), 6))
    poses[:, 0] = 2e-3 * np.sin(2 * np.pi * 0.7 * after)
    poses[:, 1] = 3e-3 * np.sin(2 * np.pi * 0.45 * after)
    poses[:, 2] = 2e-3 * np.sin(2 * np.pi * 1.1 * after)
    poses[:, 3] = np.deg2rad(0.3) * np.sin(2 * np.pi * 0.9 * after)
    poses[:, 4] = np.deg2rad(PITCH_DEG) * np.sin(2 * np.pi * PITCH_HZ * after)
    poses[:, 5] = np.deg2rad(0.2) * np.sin(2 * np.pi * 1.3 * after)
    return poses


def still(t: np.ndarray) -> np.ndarray:
    return np.zeros((len(t), 6))


def seen_from(rig: Rig, azimuth_deg: float, elevation_deg: float = 0.0) -> Rig:
    """The rig with its camera 1 m from the plate, so many degrees off the pitch axis."""
    azimuth, elevation = np.deg2rad((azimuth_deg, elevation_deg))
    plate = np.array(rig.plate.pose.position_m)
    way = np.array(
        [
            np.sin(azimuth) * np.cos(elevation),
            np.cos(azimuth) * np.cos(elevation),
            np.sin(elevation),
        ]
    )
    pose = CameraPose(position_m=tuple(plate + way), look_at_m=tuple(plate))
    return rig.model_copy(update={"camera": rig.camera.model_copy(update={"pose": pose})})


def with_markers(rig: Rig, *, size_m: float, across: int = 2, gap_m: float = 0.005) -> Rig:
    """The rig with another grid of markers on its plate."""
    layout = {"size_m": size_m, "gap_m": gap_m} if across > 1 else {"size_m": size_m, "gap_m": 1.0}
    plate = Plate.model_validate(
        {
            "margin_m": 0.006,
            "grid": {"columns": across, "rows": across, **layout},
            "pose": rig.plate.pose.model_dump(),
        }
    )
    return rig.model_copy(update={"plate": plate})


@dataclass(frozen=True)
class Take:
    """Frames of a rig's simulated camera, and the truth."""

    rig: Rig
    times: np.ndarray
    images: tuple[np.ndarray, ...]
    truth: np.ndarray


def film(
    rig: Rig,
    frames: int,
    *,
    motion: Motion = moving,
    seed: int = 1,
    appearance: Appearance | None = None,
) -> Take:
    camera = SimulatedCamera(
        rig.camera,
        rig.plate,
        motion,
        np.random.default_rng(seed),
        appearance=appearance,
        centre_of_mass_m=rig.platform.centre_of_mass_m.value,
    )
    times = (np.arange(frames) + 0.5) / FPS
    return Take(rig, times, tuple(camera.expose(t) for t in times), motion(times))


def write_run(folder: Path, take: Take, rig_text: str, images=None, times=None) -> Path:
    """A run folder that holds a take."""
    images = take.images if images is None else images
    times = take.times if times is None else times
    height, width = images[0].shape
    start = StartRecord(
        id=folder.name,
        simulated=True,
        rig_file="rig.toml",
        rig_sha256="",
        excitation=take.rig.excitation.model_copy(update={"rest_s": REST_S}),
        motion_start_known=True,
        camera=CameraStart(
            source="simulated", fps=FPS, exposure_s=0.005, width_px=width, height_px=height
        ),
        clock_anchor=ClockAnchor(t_s=0.0, wall=datetime(2026, 1, 1, tzinfo=UTC)),
    )
    with RunWriter(folder, start, rig_text) as run:
        for image, t_s in zip(images, times, strict=True):
            run.write_frame(image, float(t_s))
    return folder
