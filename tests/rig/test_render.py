"""The renderer against brute force, and what the simulated camera promises."""

import cv2
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from cdpr8.errors import DataError
from cdpr8.rigfile import load_rig, packaged_rig_path
from cdpr8.rigfile.schema import CameraPose, Intrinsics, RegionOfInterest
from rig.simulated.camera import SimulatedCamera
from rig.simulated.render import Appearance, PlateRenderer

RIG = load_rig(packaged_rig_path())
SUPERSAMPLING = 11
LENS = (-0.2, 0.05, 0.001, 0.002, 0.0)


def oblique_camera(distortion=(0.0,) * 5):
    """A small picture of a corner of the plate, seen at a slant."""
    return RIG.camera.model_copy(
        update={
            "intrinsics": Intrinsics(
                width_px=1280,
                height_px=1024,
                fx_px=1500.0,
                fy_px=1500.0,
                cx_px=639.5,
                cy_px=511.5,
                distortion=distortion,
            ),
            "region_of_interest": RegionOfInterest(x_px=565, y_px=440, width_px=60, height_px=56),
            "pose": CameraPose(position_m=(0.45, 1.0, 0.3), look_at_m=(0, 0.1, 0), up=(0.2, 0, 1)),
        }
    )


def brute_force(camera, appearance, pose):
    """The sharp pattern sampled 121 times a pixel, then blurred as a picture."""
    region, lens = camera.region_of_interest, camera.intrinsics
    border = 8  # pixels, so that the blur has something to reach for
    columns = (
        np.arange((region.width_px + 2 * border) * SUPERSAMPLING) + 0.5
    ) / SUPERSAMPLING - 0.5
    rows = (np.arange((region.height_px + 2 * border) * SUPERSAMPLING) + 0.5) / SUPERSAMPLING - 0.5
    x, y = np.meshgrid(columns + region.x_px - border, rows + region.y_px - border)
    pixels = np.column_stack([x.ravel(), y.ravel()])
    focal, middle = np.array([lens.fx_px, lens.fy_px]), np.array([lens.cx_px, lens.cy_px])
    matrix = np.array([[focal[0], 0, middle[0]], [0, focal[1], middle[1]], [0, 0, 1.0]])
    rays = (pixels - middle) / focal
    for _ in range(5 if any(lens.distortion) else 0):
        points = np.column_stack([rays, np.ones(len(rays))])
        seen = cv2.projectPoints(
            points, np.zeros(3), np.zeros(3), matrix, np.array(lens.distortion)
        )[0].reshape(-1, 2)
        rays = rays + (pixels - seen) / focal

    forward = np.array(camera.pose.look_at_m) - camera.pose.position_m
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, camera.pose.up)
    right /= np.linalg.norm(right)
    world = np.column_stack([rays, np.ones(len(rays))]) @ np.stack(
        [right, np.cross(forward, right), forward]
    )
    turn = cv2.Rodrigues(np.array([pose[3], 0, 0]))[0]  # roll alone is turned by these tests
    normal = turn @ RIG.plate.pose.normal
    up = turn @ RIG.plate.pose.up
    origin = np.array(pose[:3]) + turn @ RIG.plate.pose.position_m
    reach = ((origin - camera.pose.position_m) @ normal) / (world @ normal)
    hit = camera.pose.position_m + reach[:, None] * world - origin
    u, v = hit @ np.cross(up, normal), hit @ up

    half = 0.045 + RIG.plate.margin_m
    level = np.where((abs(u) <= half) & (abs(v) <= half), appearance.white, appearance.background)
    book = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    for marker in RIG.plate.markers():
        bits = cv2.aruco.generateImageMarker(book, marker.id, 6, borderBits=1)
        across = (u - marker.centre_m[0]) / marker.size_m + 0.5
        down = 0.5 - (v - marker.centre_m[1]) / marker.size_m
        on = (across >= 0) & (across < 1) & (down >= 0) & (down < 1)
        ink = bits[(down[on] * 6).astype(int), (across[on] * 6).astype(int)] == 0
        level[on] = np.where(ink, appearance.black, appearance.white)
    picture = gaussian_filter(
        level.reshape(x.shape), appearance.blur_px * SUPERSAMPLING, truncate=6
    )
    half_step = SUPERSAMPLING // 2
    small = picture[half_step::SUPERSAMPLING, half_step::SUPERSAMPLING]
    return small[border:-border, border:-border]


@pytest.mark.parametrize("distortion", [(0.0,) * 5, LENS])
def test_the_picture_is_the_one_that_brute_force_gives(distortion):
    camera, appearance = oblique_camera(distortion), Appearance()
    pose = np.array([0.002, -0.001, 0.003, 0.03, 0.0, 0.0])
    exact = PlateRenderer(camera, RIG.plate, appearance).brightness(pose)
    difference = 255 * (exact - brute_force(camera, appearance, pose))
    assert np.ptp(exact) > 0.6, "the picture shows ink, paper and what is behind"
    assert difference.std() < 0.1  # brute force's own grain
    assert np.abs(difference).max() < 3.0


def test_edges_stand_where_the_geometry_puts_them():
    renderer = PlateRenderer(RIG.camera, RIG.plate, Appearance())
    image = renderer.brightness(np.zeros(6))
    left, _ = renderer.corners(np.zeros(6))[0]
    row = image[120, : image.shape[1] // 4 + 10]
    look = renderer.appearance
    share = (row - look.background) / (look.white - look.background)
    first = int(np.argmax(share > 0.5))
    crossing = first - 1 + (0.5 - share[first - 1]) / (share[first] - share[first - 1])
    left_at_row = np.interp(
        120, renderer.corners(np.zeros(6))[[0, 3], 1], renderer.corners(np.zeros(6))[[0, 3], 0]
    )
    assert crossing == pytest.approx(left_at_row, abs=0.05)
    assert abs(left - left_at_row) < 20


def simulated(seed=7, **changes):
    def swing(t):
        poses = np.zeros((len(t), 6))
        poses[:, 4] = np.deg2rad(2.0) * np.sin(2 * np.pi * 2.06 * t)
        return poses

    camera = RIG.camera.model_copy(update=changes)
    return SimulatedCamera(camera, RIG.plate, swing, np.random.default_rng(seed))


def test_one_seed_gives_the_same_bytes_and_another_does_not():
    assert simulated().expose(0.3).tobytes() == simulated().expose(0.3).tobytes()
    assert simulated().expose(0.3).tobytes() != simulated(seed=8).expose(0.3).tobytes()


def test_noise_is_that_of_the_appearance():
    quiet = Appearance(noise=0.0)
    renderer = PlateRenderer(RIG.camera, RIG.plate, Appearance(noise=3.0))
    noiseless = PlateRenderer(RIG.camera, RIG.plate, quiet).brightness(np.zeros(6)) * 255
    image = renderer.expose(np.zeros((1, 6)), np.ones(1), np.random.default_rng(1))
    assert image.dtype == np.uint8
    assert (image - noiseless).std() == pytest.approx(3.0, rel=0.02)


def test_an_exposure_is_the_mean_over_its_instants():
    renderer = PlateRenderer(RIG.camera, RIG.plate, Appearance(noise=0.0))
    long = simulated(exposure_s=0.06)
    long._renderer = renderer
    instants = 0.1 + 0.06 * ((np.arange(200) + 0.5) / 200 - 0.5)
    mean = np.mean([255 * renderer.brightness(pose) for pose in long._pose_at(instants)], axis=0)
    assert np.abs(long.expose(0.1) - mean).max() < 0.8  # half a level is rounding


def test_a_plate_seen_from_behind_shows_nothing():
    behind = RIG.camera.model_copy(
        update={"pose": CameraPose(position_m=(0.0, -1.0, 0.0), look_at_m=(0.0, 0.1, 0.0))}
    )
    renderer = PlateRenderer(behind, RIG.plate, Appearance())
    assert np.ptp(renderer.brightness(np.zeros(6))) == 0.0


def test_the_packaged_plate_stays_in_the_packaged_picture():
    renderer = PlateRenderer(RIG.camera, RIG.plate, Appearance())
    for pitch_deg in (-RIG.excitation.amplitude_deg, 0.0, RIG.excitation.amplitude_deg):
        for shift_m in (-0.01, 0.01):
            pose = np.array([shift_m, shift_m, shift_m, 0.0, np.deg2rad(pitch_deg), 0.0])
            corners = renderer.corners(pose)
            assert corners.min() > 4.0
            assert (corners < np.array([renderer.width_px, renderer.height_px]) - 5.0).all()


def test_a_camera_whose_pose_is_not_stated_is_refused():
    with pytest.raises(DataError, match="pose"):
        PlateRenderer(RIG.camera.model_copy(update={"pose": None}), RIG.plate)


def test_a_marker_that_the_dictionary_lacks_is_refused():
    plate = RIG.plate.model_copy(
        update={"grid": RIG.plate.grid.model_copy(update={"first_id": 48})}
    )
    with pytest.raises(DataError, match="no marker 50"):
        PlateRenderer(RIG.camera, plate)


def test_a_camera_that_was_prepared_takes_the_same_pictures() -> None:
    def pictures(prepared: bool) -> list[np.ndarray]:
        camera = SimulatedCamera(
            RIG.camera, RIG.plate, lambda t_s: np.zeros((len(t_s), 6)), np.random.default_rng(1)
        )
        if prepared:
            camera.prepare()
        return [camera.expose(t_s) for t_s in (0.1, 0.2)]

    for one, other in zip(pictures(True), pictures(False), strict=True):
        assert np.array_equal(one, other)
