"""A run as the engine sees it: what its samples are known to."""

from dataclasses import replace

import numpy as np
import pytest

from analysis.diagnosis.recording import recording
from analysis.diagnosis.segments import segments
from analysis.diagnosis.sight import FAR, Sight, seen_by
from cdpr8.runfolder import Run, load_run, sample_data_folder
from model import simulate

STATED_S = 2.4e-4


@pytest.fixture(scope="module")
def run() -> Run:
    return load_run(sample_data_folder() / "run01")


def stating(run: Run, sigma_s: float | None) -> Run:
    """The run with another statement of how well its sampling instants are known."""
    nodes = [one.model_copy(update={"sampling_sigma_s": sigma_s}) for one in run.start.nodes]
    return replace(run, start=run.start.model_copy(update={"nodes": nodes}))


def test_what_a_run_states_of_its_instants_goes_with_the_rate_of_the_tension(run: Run) -> None:
    one = recording(stating(run, STATED_S), None).bundles[0]
    assert one.jitter is not None
    assert one.jitter.shape == one.value.shape
    motion = run.start.excitation
    moving = (one.t_s > motion.start_s + 1.0) & (one.t_s < motion.end_s - 1.0)
    resting = one.t_s < motion.start_s - 0.1
    # 7.4 N at 2.06 Hz change by 68 N/s, rms; a ring adds to it.
    driven = STATED_S * 2.0 * np.pi * motion.frequency_hz * 7.4 / np.sqrt(2.0)
    assert np.sqrt(np.mean(one.jitter[moving] ** 2)) == pytest.approx(driven, rel=0.2)
    assert np.sqrt(np.mean(one.jitter[resting] ** 2)) < 0.05 * driven


def test_where_a_run_states_nothing_its_noise_tells_it(run: Run) -> None:
    """The amplifiers of this rig sample at instants known to 0.24 ms, which their bus makes."""
    silent = recording(stating(run, None), None)
    stated = recording(stating(run, STATED_S), None)
    found, known = silent.bundles[0].jitter, stated.bundles[0].jitter
    assert found is not None
    assert known is not None
    assert np.linalg.norm(found) == pytest.approx(np.linalg.norm(known), rel=0.35)
    (note,) = (one for one in silent.notes if "instants" in one)
    assert "counted as noise" in note
    assert not any("instants" in one for one in stated.notes)


def test_an_averaged_sample_is_simulated_as_an_average(run: Run) -> None:
    """Four readings at 1200 Hz: what a ring loses to their mean, to a fifth."""
    whole = recording(run, None)
    happened = simulate(run.rig, run.start.excitation, output_rate_hz=333.0)
    offsets_s = (np.arange(4) - 1.5) / 1200.0

    def tension(late_s: float, averaged_s2: float) -> np.ndarray:
        looked = replace(whole, averaged_s2=(averaged_s2,) * 8)
        sight = Sight((), 0.0, np.zeros(6), np.full(8, late_s))
        return np.concatenate(seen_by(looked, happened, sight)[:8])

    mean = np.mean([tension(one, 0.0) for one in offsets_s], axis=0)
    lost = tension(0.0, 0.0) - mean
    missed = tension(0.0, float(np.var(offsets_s))) - mean
    assert np.sqrt(np.mean(lost**2)) > 5e-4
    assert np.sqrt(np.mean(missed**2)) < 0.2 * np.sqrt(np.mean(lost**2))


def test_of_a_simulation_that_blew_up_at_once_nothing_is_seen(run: Run) -> None:
    looked = replace(recording(run, None), averaged_s2=(1e-7,) * 8)
    happened = simulate(run.rig, run.start.excitation, output_rate_hz=333.0)
    begun = replace(happened, t_s=happened.t_s[:1], pose=happened.pose[:1],
                    tension_n=happened.tension_n[:1])  # fmt: skip
    seen = seen_by(looked, begun, Sight((), 0.0, np.zeros(6), np.zeros(8)))
    for one, bundle in zip(seen, looked.bundles, strict=True):
        assert one.shape == bundle.value.shape
        assert (np.abs(one) >= FAR).all()


def test_fast_tensions_are_averaged_and_say_over_how_long(run: Run) -> None:
    table = run.tension
    first = table[table["cable"] == 1]
    fast = first.iloc[np.repeat(np.arange(len(first)), 8)].copy()
    interval_s = float(np.median(np.diff(first["t_s"])))
    fast["t_s"] += np.tile(np.arange(8) * interval_s / 8.0, len(first))
    found = recording(replace(run, tension=fast), None)
    (bundle,) = found.bundles
    block = round(len(fast) / len(bundle.t_s))
    assert block == int(8.0 / (250.0 * interval_s))
    step_s = interval_s / 8.0
    assert found.averaged_s2[0] == pytest.approx((block**2 - 1) / 12.0 * step_s**2, rel=0.05)


def test_what_is_sampled_just_when_the_motion_starts_is_not_looked_at(run: Run) -> None:
    """Two rows of a simulation, 3 ms each, before the jump and after it."""
    motion = run.start.excitation
    parts = {one.name: one for one in segments(motion, 0.0, 0.0, motion.duration_s)}
    assert motion.start_s - parts["rest"].end_s == pytest.approx(0.006)
    assert parts["onset"].start_s - motion.start_s == pytest.approx(0.006)
    assert parts["onset"].end_s == parts["steady"].start_s


def test_what_is_sampled_just_when_a_platform_is_let_go_is_not_looked_at(run: Run) -> None:
    motion = run.start.excitation
    gone = motion.model_copy(update={"amplitude_deg": 0.0, "platform_offset_m": (2e-3, 0.0, 0.0)})
    rest, decay = segments(gone, 0.0, 0.0, gone.duration_s)
    assert (rest.name, decay.name) == ("rest", "free decay")
    assert gone.start_s - rest.end_s == pytest.approx(0.006)
    assert decay.start_s - gone.start_s == pytest.approx(0.006)
    assert decay.end_s > gone.duration_s
    still = gone.model_copy(update={"platform_offset_m": (0.0, 0.0, 0.0)})
    assert [one.name for one in segments(still, 0.0, 0.0, still.duration_s)] == ["whole"]


@pytest.mark.parametrize(
    ("lowest_n", "hangs"),
    [(2.0, False), (0.0, False), (-4.0, True)],
    ids=["pulls always", "only just", "slack"],
)
def test_a_cable_hangs_slack_where_its_tension_stays_at_zero(
    run: Run, lowest_n: float, hangs: bool
) -> None:
    whole = recording(run, None)
    assert whole.hanging == ()
    one = whole.bundles[2]
    sigma_n = float(np.sqrt(one.covariance[0, 0]))
    swings = lowest_n + 8.0 * (1.0 + np.sin(2.0 * np.pi * 2.06 * one.t_s))
    noise = sigma_n * np.random.default_rng(5).standard_normal(swings.shape)
    looked = replace(one, value=(np.maximum(swings, 0.0) + noise)[:, None])
    bundles = (*whole.bundles[:2], looked, *whole.bundles[3:])
    assert replace(whole, bundles=bundles).hanging == ((3,) if hangs else ())


def test_a_cell_that_reads_below_zero_shows_no_slack(run: Run) -> None:
    whole = recording(run, None)
    one = whole.bundles[2]
    swings = 4.0 + 8.0 * np.sin(2.0 * np.pi * 2.06 * one.t_s)
    bundles = (*whole.bundles[:2], replace(one, value=swings[:, None]), *whole.bundles[3:])
    assert replace(whole, bundles=bundles).hanging == ()
