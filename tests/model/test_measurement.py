"""Every effect of cell, camera and clock: what it does to a known tension and pose, and no more."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cdpr8.rigfile import Rig
from model import ActiveEffect, Machine, Task, observe
from model.effects import library
from model.motion import RampedSine
from model.observation import _read
from model.simulator import run

TIME_S = np.arange(4001) / 1000.0
CIRCULAR = 2.0 * np.pi * 2.0
TENSION = 10.0 + np.sin(CIRCULAR * TIME_S)[:, None] + np.arange(8.0)


def pose_at(stamp_s: np.ndarray) -> np.ndarray:
    return np.asarray(stamp_s)[:, None] * np.arange(1.0, 7.0)


def cell(name: str, value: float, cable: int = 3) -> np.ndarray:
    """What the cells report with the effect at one cable."""
    effect = library()[name]
    (magnitude,) = effect.magnitudes
    values = np.zeros(8)
    values[cable - 1] = value
    given = {one.name: one.default for one in effect.parameters} | {magnitude: values}
    seen = effect.measure(TIME_S, TENSION, **given)
    others = np.delete(np.arange(8), cable - 1)
    assert np.array_equal(seen[:, others], TENSION[:, others]), "other channels stay clean"
    return seen[:, cable - 1]


def lag_is_first_order(seen: np.ndarray, true: np.ndarray) -> bool:
    last = TIME_S >= 2.0
    wave = np.exp(-1j * CIRCULAR * TIME_S[last])[:-1]
    answer = (seen[last][:-1] @ wave) / (true[last][:-1] @ wave)
    return bool(abs(answer - 1.0 / (1.0 + 0.01j * CIRCULAR)) < 1e-4)


CELLS: list[tuple[str, float, Callable[[np.ndarray, np.ndarray], bool]]] = [
    ("cell_gain", 0.02, lambda seen, true: np.allclose(seen / true, 1.02, rtol=1e-14)),
    ("cell_zero", 0.2, lambda seen, true: np.allclose(seen - true, 0.2, atol=1e-14)),
    ("cell_drift", 0.01, lambda seen, true: np.allclose(seen - true, 0.01 * TIME_S, atol=1e-14)),
    ("cell_lag", 0.01, lag_is_first_order),
    ("cell_saturation", 12.5, lambda seen, true: np.array_equal(seen, np.minimum(true, 12.5))),
]


@pytest.mark.parametrize(("name", "value", "holds"), CELLS, ids=[one[0] for one in CELLS])
def test_a_cell_spoils_its_own_channel_as_it_says(
    name: str, value: float, holds: Callable[[np.ndarray, np.ndarray], bool]
) -> None:
    seen = cell(name, value)
    assert holds(seen, TENSION[:, 2])
    assert np.abs(seen - TENSION[:, 2]).max() > 1e-3


@pytest.mark.parametrize("order", [0.1875, 0.25, 1.0 / 3.0, 0.5])
def test_a_lag_of_second_order_has_the_gain_and_phase_of_its_filter(order: float) -> None:
    """Two poles apart, two alike, Bessel's and Butterworth's."""
    lag_s = np.where(np.arange(8) == 2, 0.02, 0.0)
    seen = library()["cell_lag"].measure(TIME_S, TENSION, lag_s=lag_s, second_order=order)
    last = TIME_S >= 2.0
    wave = np.exp(-1j * CIRCULAR * TIME_S[last])[:-1]
    answer = (seen[last, 2][:-1] @ wave) / (TENSION[last, 2][:-1] @ wave)
    late = 0.02j * CIRCULAR
    assert abs(answer - 1.0 / (1.0 + late + order * late**2)) < 2e-4
    assert seen[0, 2] == TENSION[0, 2], "it has settled before"


def test_swapped_cells_show_each_others_tension() -> None:
    chosen = np.isin(np.arange(8), (1, 4)).astype(float)
    seen = library()["cell_swapped"].measure(TIME_S, TENSION, swapped=chosen)
    assert np.array_equal(seen, TENSION[:, [0, 4, 2, 3, 1, 5, 6, 7]])


CAMERAS: list[tuple[str, dict[str, float], Callable[[np.ndarray], np.ndarray]]] = [
    ("camera_latency", {"latency_s": 0.01}, lambda t: pose_at(t - 0.01)),
    ("camera_gain", {"gain_share": 0.02}, lambda t: 1.02 * pose_at(t)),
    ("clock_drift", {"drift_ppm": 100.0}, lambda t: pose_at(t / 1.0001)),
    (
        "frames_dropped",
        {"frames": 2.0, "at_s": 3.0, "frame_hz": 16.0},
        lambda t: pose_at(np.where(t < 3.0, t, t + 0.125)),
    ),
    (
        "frames_dropped",
        {"frames": 1.0, "at_s": 3.0, "frame_hz": 16.0, "again_1_s": 4.0, "again_2_s": 0.0},
        lambda t: pose_at(t + 0.0625 * (t >= 3.0) + 0.0625 * (t >= 4.0)),
    ),
]


@pytest.mark.parametrize(("name", "values", "wanted"), CAMERAS, ids=[one[0] for one in CAMERAS])
def test_a_camera_and_its_clock_shift_and_scale_as_they_say(
    name: str, values: dict[str, float], wanted: Callable[[np.ndarray], np.ndarray]
) -> None:
    seen = library()[name].measure(pose_at, **values)(TIME_S)
    assert seen == pytest.approx(wanted(TIME_S), rel=1e-12, abs=1e-12)
    assert np.abs(seen - pose_at(TIME_S)).max() > 1e-4


def test_a_harmonic_is_heard_however_often_the_drive_was_altered_before() -> None:
    from model.altered import Altered, Distorted

    sine = RampedSine(1, 0.03, 2.0, 0.0, 4.0, 0.0, 4.0)
    time_s = np.linspace(0.0, 4.0, 400)
    twice = Altered(Altered(sine, factor=1.1), pace=1.01)
    added = Distorted(twice, 0.1, 2, 0.0).at(time_s)[0] - twice.at(time_s)[0]
    assert np.abs(added).max() == pytest.approx(0.1 * 1.1 * 0.03, rel=0.01)


def test_a_tone_is_read_between_rows_twenty_times_closer_than_a_straight_line() -> None:
    time_s, tone = np.arange(501) / 500.0, 2.0 * np.pi * 27.0
    tension = 20.0 + np.sin(tone * time_s)[:, None] + np.arange(8.0)
    read_s = np.linspace(0.1, 0.9, 777)
    true = 20.0 + np.sin(tone * read_s)[:, None] + np.arange(8.0)
    straight = np.interp(read_s, time_s, tension[:, 0]) - true[:, 0]
    seen = _read(time_s, tension, read_s) - true
    assert np.abs(seen).max() < np.abs(straight).max() / 20.0


def test_a_cable_that_goes_slack_has_a_corner_between_rows() -> None:
    time_s, tone = np.arange(301) / 333.0, 2.0 * np.pi * 3.0
    read_s = np.linspace(0.1, 0.8, 3000)

    def pull(at_s: np.ndarray) -> np.ndarray:
        return np.asarray(np.maximum(5.0 * np.sin(tone * at_s) + 1.0, 0.0))

    rows = np.repeat(pull(time_s)[:, None], 8, axis=1)
    seen = _read(time_s, rows, read_s)[:, 0]
    assert seen.min() == 0.0
    assert np.abs(seen - pull(read_s)).max() < 2e-3


def test_a_jump_between_rows_reaches_no_further_than_the_next_row() -> None:
    time_s = np.arange(40) / 10.0
    tension = np.repeat((time_s >= 2.0).astype(float)[:, None], 8, axis=1)
    read_s = np.linspace(0.0, 3.9, 1000)
    seen = _read(time_s, tension, read_s)[:, 0]
    away = (read_s < 1.8) | (read_s > 2.1)
    assert np.array_equal(seen[away], (read_s[away] >= 2.0).astype(float))


def test_a_camera_sees_the_point_that_the_rig_file_takes_for_the_centre_of_mass(rig: Rig) -> None:
    # Cable lengths tell where the platform is, whatever point of it moves as a body falls.
    moved = {"centre_x_m": 3e-3, "centre_y_m": -2e-3, "centre_z_m": 1e-3}
    pitching = rig.excitation.model_copy(update={"motion_s": 1.0, "rest_s": 0.2})
    simulation = run(Task(rig, pitching, effects=(ActiveEffect("centre_of_mass", moved),)))
    machine = Machine.from_rig(rig)

    def missed_m(pose: np.ndarray) -> float:
        turned = Rotation.from_euler("xyz", pose[:, 3:])
        missed = []
        for anchor, base, rest in zip(
            machine.anchor, machine.base, machine.rest_length, strict=True
        ):
            line = base - pose[:, :3] - turned.apply(anchor)
            missed.append(np.linalg.norm(line, axis=1) - rest)
        return float(np.abs(np.stack(missed, axis=1) - simulation.elongation_m).max())

    assert missed_m(observe(simulation).pose) < 1e-12
    assert missed_m(simulation.pose) > 5e-5
