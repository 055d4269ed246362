"""The rendered cases by which `vision` is measured: the table of docs/vision.md.

1280 x 1024 px, f = 1500 px, 1 m away, noise 2/255, blur 0.7 px, 2 deg of pitch at 2.06 Hz. Only
the part of the sensor that shows the plate is rendered; `film` and the renderer share no code with
what is measured.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from takes import Take, film, moving, seen_from, with_markers

from cdpr8.rigfile.schema import CameraPose, Marker, Plate, PlatePose, RegionOfInterest, Rig
from rig.simulated.render import Appearance
from vision.camera_model import CameraModel
from vision.mounting import mounting_of
from vision.plate import Plate as SeenPlate
from vision.self_calibration import PlateView, calibrate_plate, spread_out
from vision.tracker import Tracker

MISPLACED_M = 5e-5
FOCAL_ERROR = 0.01
REST_FRAMES = 8


def cropped(rig: Rig, side_px: int = 200) -> Rig:
    lens = rig.camera.intrinsics
    region = RegionOfInterest(
        x_px=int(lens.cx_px) - side_px // 2,
        y_px=int(lens.cy_px) - side_px // 2,
        width_px=side_px,
        height_px=side_px,
    )
    return rig.model_copy(
        update={"camera": rig.camera.model_copy(update={"region_of_interest": region})}
    )


def in_front(rig: Rig, tilt_deg: float) -> Rig:
    """The plate across X, tilted about the pitch axis, the camera in front and rolled by 3 deg."""
    tilt, roll = np.deg2rad((tilt_deg, 3.0))
    place = rig.plate.pose.position_m
    pose = PlatePose(
        position_m=place,
        normal=(np.cos(tilt), 0.0, np.sin(tilt)),
        up=(-np.sin(tilt), 0.0, np.cos(tilt)),
    )
    camera = CameraPose(
        position_m=(place[0] + 1.0, place[1], place[2]),
        look_at_m=place,
        up=(0.0, np.sin(roll), np.cos(roll)),
    )
    return rig.model_copy(
        update={
            "plate": rig.plate.model_copy(update={"pose": pose}),
            "camera": rig.camera.model_copy(update={"pose": camera}),
        }
    )


def misprinted(rig: Rig, seed: int) -> Rig:
    """The rig with its markers off by 0.05 mm, each its own way."""
    generator = np.random.default_rng(seed)
    markers = []
    for marker in rig.plate.markers():
        way = generator.uniform(0.0, 2.0 * np.pi)
        shift = MISPLACED_M * np.array([np.cos(way), np.sin(way)])
        centre = tuple(float(value) for value in np.add(marker.centre_m, shift))
        markers.append(Marker(id=marker.id, centre_m=centre, size_m=marker.size_m))
    plate = Plate(margin_m=rig.plate.margin_m, marker=tuple(markers), pose=rig.plate.pose)
    return rig.model_copy(update={"plate": plate})


@dataclass(frozen=True)
class Case:
    """A set-up, what it looks like, how it is tracked, and the pitch error allowed."""

    name: str
    make: Callable[[Rig], Rig]
    bar_deg: float
    appearance: Appearance | None = None
    zeroed: bool = False
    spoiled: bool = False


def _small(view: Callable[[Rig], Rig], across: int = 2, size_m: float = 0.02):
    return lambda rig: cropped(
        view(with_markers(rig, size_m=size_m, across=across)), 300 if size_m > 0.03 else 200
    )


def _off(degrees: float) -> Callable[[Rig], Rig]:
    return lambda rig: seen_from(rig, degrees)


CASES = (
    Case("2x2 of 20 mm, along the pitch axis", _small(_off(0.0)), 0.003),
    Case("2x2 of 20 mm, camera 30 deg off", _small(_off(30.0)), 0.004),
    Case("2x2 of 20 mm, tilted 45 deg", _small(lambda rig: in_front(rig, 45.0)), 0.006),
    Case("2x2 of 20 mm, face-on", _small(lambda rig: in_front(rig, 0.0)), 0.12),
    Case("3x3 of 40 mm, 30 deg off", _small(_off(30.0), 3, 0.04), 0.001),
    Case("one of 20 mm, 30 deg off", _small(_off(30.0), 1), 0.07),
    Case("shading 20 %", _small(_off(30.0)), 0.006, Appearance(shading=0.2), True),
    Case("gamma 1.2", _small(_off(30.0)), 0.006, Appearance(gamma=1.2), True),
    Case("blur 1.2 px", _small(_off(30.0)), 0.006, Appearance(blur_px=1.2), True),
    Case("0.05 mm misprint, 1 % focal error", _small(_off(30.0)), 0.008, None, True, True),
)


@dataclass(frozen=True)
class Result:
    """Errors of one case and seed: x, y, z, roll, pitch, yaw (m, rad), frames by six."""

    errors: np.ndarray
    covariances: np.ndarray
    flips: int
    unflagged_flips: int
    frames: int

    @property
    def pitch_rms_deg(self) -> float:
        return float(np.rad2deg(np.sqrt((self.errors[:, 4] ** 2).mean())))

    @property
    def sigma_deg(self) -> float:
        """What the covariances say: the Cramer-Rao bound of the picture's model."""
        return float(np.rad2deg(np.sqrt(self.covariances[:, 4, 4].mean())))

    @property
    def normalised_square(self) -> float:
        """Squared error over covariance, per degree of freedom: 1 where covariances are true."""
        pairs = zip(self.errors, self.covariances, strict=True)
        return float(np.mean([e @ np.linalg.solve(c, e) / 6.0 for e, c in pairs]))


FLIP_RAD = np.deg2rad(3.0)


def measure(case: Case, packaged: Rig, frames: int, seed: int) -> Result:
    """Render a case, track it, and compare with the truth."""
    rig = case.make(packaged)
    shown = misprinted(rig, seed) if case.spoiled else rig
    take = film(shown, frames, motion=moving, seed=seed, appearance=case.appearance)
    return compared(rig, take, case)


def compared(rig: Rig, take: Take, case: Case) -> Result:
    intrinsics = rig.camera.intrinsics
    if case.spoiled:
        focal = (1.0 + FOCAL_ERROR) * intrinsics.fx_px
        intrinsics = intrinsics.model_copy(update={"fx_px": focal, "fy_px": focal})
    camera = CameraModel.from_intrinsics(intrinsics, rig.camera.region_of_interest)
    plate, mounting = SeenPlate.from_rig(rig.plate), mounting_of(rig)
    if case.spoiled:
        plate = _self_calibrated(plate, take, camera)
    tracker = Tracker(camera, plate)
    found = [tracker.see(image).sightings[0] for image in take.images]
    seen = [one.estimate.pose if one.estimate else None for one in found]
    if case.zeroed:
        mounting = mounting.with_camera_seeing_rest([p for p in seen[:REST_FRAMES] if p])
    errors, covariances, flips, unflagged = [], [], 0, 0
    for sighting, truth in zip(found, take.truth, strict=True):
        if sighting.estimate is None:
            continue
        pose = mounting.platform(sighting.estimate.pose)
        errors.append(pose.values - truth)
        covariances.append(pose.covariance)
        if np.abs(errors[-1][3:]).max() > FLIP_RAD:
            flips += 1
            unflagged += not sighting.flags
    return Result(np.array(errors), np.array(covariances), flips, unflagged, len(take.images))


def _self_calibrated(plate: SeenPlate, take: Take, camera: CameraModel) -> SeenPlate:
    tracker, views = Tracker(camera, plate), []
    for index in spread_out(len(take.images), 40):
        sighting = tracker.see(take.images[index]).sightings[0]
        views.append(PlateView(take.images[index], sighting.ids, sighting.estimate.pose))
    return calibrate_plate(plate, views, camera).plate
