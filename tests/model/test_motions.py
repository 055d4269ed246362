import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cdpr8.errors import DataError, UsageError
from cdpr8.rigfile import Rig
from cdpr8.terminal import run_app
from model import simulate
from model.command import app
from model.machine import Machine
from model.motion import Motion
from model.motions import (
    COLUMNS,
    COORDINATES,
    FreeDecay,
    Multisine,
    Recorded,
    Staircase,
    Times,
    along,
    motion_of,
)
from model.outputs import mechanical_energy

TIMES = Times(start_s=0.5, motion_s=4.0, ramp_s=0.4, rest_s=0.3)
EVERY_AXIS = (0.003, -0.002, 0.004, 0.01, -0.02, 0.015)


def recorded() -> Recorded:
    samples_s = np.linspace(0.0, 4.0, 81)
    poses = np.outer(np.sin(3.0 * samples_s), EVERY_AXIS)
    return Recorded(samples_s, poses, times=TIMES)


WINDOWED = {
    "sine": Multisine.sine(EVERY_AXIS, 1.7, 0.8, TIMES),
    "multisine": Multisine.odd_random_phase(EVERY_AXIS, 0.5, 4.0, np.random.default_rng(3), TIMES),
    "recorded": recorded(),
}
STEPS = Staircase((EVERY_AXIS, along("yaw", 2.0)), rise_s=0.4, stay_s=0.3, start_s=0.5)
ALL = WINDOWED | {"steps": STEPS, "decay": FreeDecay(EVERY_AXIS, hold_s=0.2, free_s=1.0)}


@pytest.mark.parametrize("motion", ALL.values(), ids=ALL)
def test_rates_and_accelerations_are_derivatives(motion: Motion) -> None:
    time_s = np.linspace(1e-3, motion.duration_s - 1e-3, 2001)
    time_s = time_s[np.abs(time_s[:, None] - motion.breaks_s).min(axis=1) > 1e-3]
    dt = 1e-5
    _, rate, acceleration = motion.at(time_s)
    (ahead, rate_ahead, _), (behind, rate_behind, _) = (
        motion.at(time_s + dt),
        motion.at(time_s - dt),
    )
    assert (ahead - behind) / (2 * dt) == pytest.approx(rate, abs=1e-6)
    assert (rate_ahead - rate_behind) / (2 * dt) == pytest.approx(acceleration, abs=1e-4)


@pytest.mark.parametrize("motion", [*WINDOWED.values(), STEPS], ids=[*WINDOWED, "steps"])
def test_it_starts_and_ends_at_rest_without_a_jump(motion: Motion) -> None:
    for values in motion.at(np.array([0.0, motion.start_s - 1e-9, motion.duration_s])):
        assert not np.abs(values).any()
    for moment in motion.breaks_s:
        before, after = motion.at(np.array([moment - 1e-9])), motion.at(np.array([moment + 1e-9]))
        for one, other in zip(before, after, strict=True):
            assert one == pytest.approx(other, abs=1e-5)
    assert np.abs(motion.at(np.linspace(0, motion.duration_s, 999))[0]).max(axis=0).min() > 1e-3


@pytest.mark.parametrize("motion", ALL.values(), ids=ALL)
def test_any_shape_of_times_is_taken(motion: Motion) -> None:
    flat = np.linspace(0.0, motion.duration_s, 12)
    for one, other in zip(motion.at(flat.reshape(3, 4)), motion.at(flat), strict=True):
        assert one.shape == (3, 4, 6)
        assert one.reshape(-1, 6) == pytest.approx(other)


def test_a_multisine_drives_odd_harmonics_only_and_reaches_its_amplitude() -> None:
    motion = Multisine.odd_random_phase(
        along("roll", 2.0), 0.5, 5.0, np.random.default_rng(1), Times(0.0, 8.0, 0.0, 0.0)
    )
    time_s = np.arange(0.0, 2.0, 1e-3)
    roll = motion.at(time_s)[0][:, 3]
    lines = np.abs(np.fft.rfft(roll)) / roll.size
    driven = np.flatnonzero(lines > 1e-3 * lines.max())
    assert driven.tolist() == [1, 3, 5, 7, 9]
    assert lines[driven] == pytest.approx(np.full(5, lines[1]))
    assert np.rad2deg(np.abs(roll).max()) == pytest.approx(2.0, rel=1e-2)


def test_random_phases_come_from_the_generator() -> None:
    first, again, other = (
        Multisine.odd_random_phase(EVERY_AXIS, 0.5, 5.0, np.random.default_rng(seed))
        for seed in (1, 1, 2)
    )
    assert first == again
    assert first.phases_rad != other.phases_rad


@pytest.mark.parametrize("name", COORDINATES)
def test_a_sine_goes_along_the_coordinate_named(name: str) -> None:
    motion = Multisine.sine(along(name, 0.5), 2.0, np.pi / 2, Times(0.0, 1.0, 0.0, 0.0))
    pose = motion.at(np.array(0.5))[0]
    expected = 0.5 if name in "xyz" else np.deg2rad(0.5)
    assert np.flatnonzero(pose).tolist() == [COORDINATES.index(name)]
    assert pose.max() == pytest.approx(expected)


def test_steps_stay_where_they_lead() -> None:
    staying = STEPS.moments_s + STEPS.rise_s + 0.1
    pose, rate, _ = STEPS.at(staying)
    assert pose == pytest.approx(np.array([EVERY_AXIS, along("yaw", 2.0), np.zeros(6)]), abs=1e-15)
    assert not np.abs(rate).max() > 1e-12


def test_what_is_let_go_is_held_before_and_commanded_to_rest_after() -> None:
    motion = FreeDecay(EVERY_AXIS, hold_s=0.2)
    release = np.array([0.2, 0.2])
    held, free = motion.at(release, within_s=np.array([0.1, 0.3]))[0]
    assert held.tolist() == list(EVERY_AXIS)
    assert not free.any()
    assert not motion.at(np.array(0.0), np.array(-1.0))[0].any()
    assert motion.breaks_s == (0.2,)
    assert motion.start_s == 0.0


@pytest.fixture
def series(tmp_path: Path) -> Path:
    """A recorded pitch and height, as pose.csv has them."""
    t_s = 5.0 + np.arange(60) / 16.0
    path = tmp_path / "series.csv"
    pitch = 2.0 * np.sin(2.0 * np.pi * 0.7 * (t_s - 5.0))
    pd.DataFrame({"frame": range(60), "t_s": t_s, "pitch_deg": pitch, "z_m": 1e-3 * pitch}).to_csv(
        path, index=False
    )
    return path


def test_a_recorded_series_is_met_at_its_samples_and_smooth_between(series: Path) -> None:
    motion = Recorded.from_csv(series, start_s=1.0)
    t_s = np.arange(60) / 16.0
    pose = motion.at(1.0 + t_s)[0]
    expected = 2.0 * np.sin(2.0 * np.pi * 0.7 * t_s)
    assert np.rad2deg(pose[:, 4]) == pytest.approx(expected, abs=1e-9)
    assert pose[:, 2] == pytest.approx(1e-3 * expected, abs=1e-12)
    assert not pose[:, [0, 1, 3, 5]].any()
    between = motion.at(1.0 + t_s[:-1] + 1 / 32)[0][:, 4]
    exact = np.deg2rad(2.0 * np.sin(2.0 * np.pi * 0.7 * (t_s[:-1] + 1 / 32)))
    assert between == pytest.approx(exact, abs=1e-4)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "cannot be read"),
        ("", "cannot be read"),
        ("time,pitch\n0,1\n", "t_s and at least one of x_m"),
        ("t_s,pitch_deg\n0,1\n1,x\n", "no number"),
        ("t_s,pitch_deg\n0,1\n1,\n2,1\n", "series.csv:3"),
        ("t_s,pitch_deg\n0,1\n2,2\n1,1\n", "series.csv:4"),
        ("t_s,pitch_deg\n0,1\n1,2\n2,1\n", "more than 5"),
    ],
)
def test_a_series_that_cannot_be_used_is_refused_with_its_line(
    tmp_path: Path, content: str | None, says: str
) -> None:
    path = tmp_path / "series.csv"
    if content is not None:
        path.write_text(content)
    with pytest.raises(DataError) as caught:
        Recorded.from_csv(path)
    assert says in caught.value.sentence()


def test_a_motion_is_found_by_its_words(series: Path) -> None:
    generator = np.random.default_rng(0)
    sine = motion_of("sine:pitch=2,frequency=2.06,phase=90,start=0,ramp=0,motion=3", generator)
    assert np.rad2deg(sine.at(np.array(0.0))[0][4]) == pytest.approx(2.0)
    assert (sine.start_s, sine.end_s) == (0.0, 3.0)
    multisine = motion_of("multisine:yaw=1,base=0.5,highest=2.5", generator)
    assert multisine.frequencies_hz == pytest.approx([0.5, 1.5, 2.5])
    steps = motion_of("steps:x=0.01,z=0.002,rise=0.2", generator)
    assert steps.at(np.array(1.5))[0] == pytest.approx([0.01, 0, 0.002, 0, 0, 0])
    decay = motion_of("decay:z=0.01,free=2", generator)
    assert decay.duration_s == pytest.approx(2.1)
    follow = motion_of(f"csv:{series},ramp=0.5", generator)
    assert follow.steady_window_s == pytest.approx([0.5, 59 / 16 - 0.5])


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("circle:x=1", "sine, multisine, steps, decay, csv"),
        ("sine:frequency=1", "goes nowhere"),
        ("sine:pitch=two", "NAME=NUMBER"),
        ("decay:z=0.01,ramp=1", "hold, free"),
        ("sine:pitch=1,motion=1,ramp=2", "two ramps"),
        ("multisine:pitch=1,base=2,highest=1", "base <= highest"),
        ("sine:pitch=1,frequency=0", "all above 0"),
        ("steps:x=0.01,rise=0", "rise above 0"),
        ("decay:x=0.01,hold=0", "above 0"),
    ],
)
def test_words_that_make_no_motion_are_refused_with_what_is_allowed(words: str, says: str) -> None:
    with pytest.raises(UsageError) as caught:
        motion_of(words, np.random.default_rng(0))
    assert says in caught.value.sentence()


def test_columns_are_those_of_pose_csv() -> None:
    assert len(COLUMNS) == len(COORDINATES) == 6
    assert all(column.startswith(name) for column, name in zip(COLUMNS, COORDINATES, strict=True))


def test_the_platform_follows_any_of_them_where_nothing_disturbs_it(rig: Rig) -> None:
    for motion in (*WINDOWED.values(), STEPS):
        run = simulate(rig, motion=motion, excitation_effect=False)
        assert run.pose == pytest.approx(motion.at(run.t_s)[0], abs=1e-6)
        assert np.abs(run.pose).max() > 0.01


def test_what_is_let_go_swings_and_keeps_its_energy(rig: Rig) -> None:
    motion = FreeDecay(along("z", 0.002), hold_s=0.25, free_s=5.0)
    run = simulate(rig, motion=motion, excitation_effect=False)
    held = run.t_s < 0.25 - 1e-9
    assert run.pose[held] == pytest.approx(np.tile(motion.pose, (held.sum(), 1)), abs=1e-9)
    free = run.t_s > 0.25
    height = run.pose[free, 2]
    assert height.min() < -0.001
    energy = mechanical_energy(Machine.from_rig(rig), run.pose[free], run.pose_rate[free])
    rest = mechanical_energy(Machine.from_rig(rig), np.zeros((1, 6)), np.zeros((1, 6)))[0]
    # The drive holds what the rig file's digits leave of static equilibrium, some 1e-3 N, and so
    # does a little work.
    assert np.ptp(energy) < 2e-3 * (energy[0] - rest)


def simulated(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = run_app(app, ["simulate", *arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_model_simulate_follows_any_motion(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, series: Path
) -> None:
    out = tmp_path / "run.csv"
    code, said, _ = simulated(capsys, "--follow", f"csv:{series}", "--out", str(out))
    frame, wanted = pd.read_csv(out), pd.read_csv(series)
    assert code == 0
    assert str(series) in said.splitlines()[0]
    pitch = np.interp(wanted["t_s"] - 5.0, frame["t_s"], frame["pitch_deg"])
    assert pitch == pytest.approx(wanted["pitch_deg"], abs=0.05)
    code, said, _ = simulated(capsys, "--follow", "decay:z=0.001,free=1", "--check", "--json")
    answer = json.loads(said)
    assert code == 0
    assert answer["steady_window_s"] == pytest.approx([0.1, 1.1])
    assert all(check["passed"] for check in answer["checks"])


def test_a_seed_gives_a_multisine_its_phases(capsys: pytest.CaptureFixture[str]) -> None:
    words = "multisine:yaw=1,base=1,highest=5,start=0,motion=2,ramp=0.2,rest=0"
    yaw = [
        json.loads(simulated(capsys, "--follow", words, "--seed", seed, "--json")[1])["summary"]
        for seed in ("1", "1", "2")
    ]
    assert yaw[0] == yaw[1]
    assert yaw[0] != yaw[2]


def test_words_that_make_no_motion_are_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    code, _, err = simulated(capsys, "--follow", "circle:x=1")
    assert code == 2
    assert "multisine" in err
    code, _, err = simulated(capsys, "--follow", "csv:nowhere.csv")
    assert code == 3
    assert "nowhere.csv" in err
