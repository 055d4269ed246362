"""The pose that a rolling shutter shows, against corners that are each seen at their own time."""

import numpy as np
import pytest

from model.effects import library

SHUTTER = {"readout_s": 0.03, "field_m": 0.3, "plate_y_m": 0.1, "plate_half_m": 0.03}
SHUTTER |= {"distance_m": 1.0, "bearing_rad": 0.5, "depth_share": 0.0, "before_share": 0.0}
RATE = np.array([0.02, 0.01, -0.015, 0.2, -0.3, 0.25])


def in_uniform_motion(stamp_s: np.ndarray) -> np.ndarray:
    return np.outer(stamp_s, RATE)


def plate_corners() -> np.ndarray:
    half = SHUTTER["plate_half_m"]
    return np.array([[x, SHUTTER["plate_y_m"], z] for x in (-half, half) for z in (-half, half)])


def seen_by_a_rolling_shutter(late_s: np.ndarray) -> np.ndarray:
    """The corners where each is at its own time, shape (4, 3), m."""
    from scipy.spatial.transform import Rotation

    poses = in_uniform_motion(late_s)
    turned = Rotation.from_euler("xyz", poses[:, 3:])
    return np.asarray(poses[:, :3] + turned.apply(plate_corners()))


def test_a_rolling_shutter_turns_a_moving_plate() -> None:
    """Corners of a plate, each seen when its row is read, and a rigid plate fitted to them."""
    from scipy.spatial.transform import Rotation

    corners = plate_corners()
    seen = seen_by_a_rolling_shutter(SHUTTER["readout_s"] / SHUTTER["field_m"] * corners[:, 2])
    turned, _ = Rotation.align_vectors(seen - seen.mean(axis=0), corners - corners.mean(axis=0))
    exact = np.hstack(
        [seen.mean(axis=0) - turned.apply(corners.mean(axis=0)), turned.as_euler("xyz")]
    )
    effect = library()["camera_rolling_shutter"]
    assert effect.measure is not None
    law = effect.measure(in_uniform_motion, **{**SHUTTER, "depth_share": 1.0, "reads_up": 1.0})
    assert np.abs(law(np.zeros(1))[0] - exact).max() < 0.02 * np.abs(exact).max()


def test_a_plate_seen_from_aside_by_a_rolling_shutter_rolls() -> None:
    """The pose that OpenCV fits to corners, each drawn where it is when its row is read."""
    import cv2
    from scipy.spatial.transform import Rotation

    bearing, distance = SHUTTER["bearing_rad"], SHUTTER["distance_m"]
    ahead = -np.array([np.sin(bearing), np.cos(bearing), 0.0])
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    axes = np.array([right, np.cross(ahead, right), ahead])
    stands = np.array([0.0, SHUTTER["plate_y_m"], 0.0]) - distance * ahead
    lens = np.array([[1500.0, 0.0, 640.0], [0.0, 1500.0, 512.0], [0.0, 0.0, 1.0]])
    into_camera = -axes @ stands

    def drawn(points: np.ndarray) -> np.ndarray:
        turn, _ = cv2.Rodrigues(axes)
        return np.asarray(cv2.projectPoints(points, turn, into_camera, lens, None)[0][:, 0])

    late_s = np.zeros(4)
    for _ in range(5):
        picture = drawn(seen_by_a_rolling_shutter(late_s))
        rows_m = (picture[:, 1] - 512.0) / 1500.0 * distance
        late_s = SHUTTER["readout_s"] * rows_m / SHUTTER["field_m"]
    start, _ = cv2.Rodrigues(axes)
    _, turn, place = cv2.solvePnP(
        plate_corners(), picture, lens, None, start, into_camera.copy(), True
    )
    body = Rotation.from_matrix(axes.T @ cv2.Rodrigues(turn)[0])
    exact = np.hstack([axes.T @ (place[:, 0] - into_camera), body.as_euler("xyz")])
    effect = library()["camera_rolling_shutter"]
    assert effect.measure is not None
    law = effect.measure(in_uniform_motion, **{**SHUTTER, "reads_up": 0.0})
    ours = law(np.zeros(1))[0]
    assert abs(exact[3]) > 1e-3, "what moves along the rows looks rolled from aside"
    assert ours == pytest.approx(exact, abs=0.03 * np.abs(exact).max())
