"""Frames that are missing without a mark, by what poses show after them."""

from dataclasses import replace

import numpy as np
import pytest
from recorded_by import STILL, by_model

from analysis.diagnosis.as_recorded import as_lost
from analysis.diagnosis.candidates import candidates
from analysis.diagnosis.lost_frames import lost_frames
from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.recording import Recording
from analysis.engine.stated import check_candidates
from analysis.engine.system import Point
from cdpr8.rigfile import Excitation
from model.simulator import run

FRAME_HZ = 16.0


@pytest.fixture(scope="module")
def pitched(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    excitation = Excitation(
        amplitude_deg=2.0, frequency_hz=2.06, motion_s=7.0, ramp_s=0.5, rest_s=1.0, **STILL
    )
    return by_model(tmp_path_factory.mktemp("runs") / "pitched", [], excitation)


def without(recording: Recording, *frames: int) -> Recording:
    """Those frames missing, the stamps of all others as if none were."""
    poses = recording.bundles[-1]
    kept = np.delete(np.arange(len(poses.t_s)), frames)
    left = replace(poses, t_s=poses.t_s[: len(kept)], value=poses.value[kept], jitter=None)
    return replace(recording, bundles=(*recording.bundles[:-1], left))


def found(recording: Recording) -> list[int]:
    """Before which of the frames that are left."""
    machine = RecordedMachine([recording], ("stiffness",), workers=1)
    job = machine.job(Point(np.zeros(len(machine.nuisances))), 0)
    seen = run(job.task, output_rate_hz=recording.output_hz(job.task))
    at_s = lost_frames(recording, seen, job.sight, FRAME_HZ)
    stamps = recording.bundles[-1].t_s - job.sight.start_s
    return np.searchsorted(stamps, at_s).tolist()


@pytest.mark.parametrize("lost", [(), (40,), (40, 41), (40, 60, 61, 90)])
def test_each_is_found_where_it_was_lost(pitched: Recording, lost: tuple[int, ...]) -> None:
    assert found(without(pitched, *lost)) == [frame - k for k, frame in enumerate(lost)]


def test_what_poses_show_is_all_that_is_tried() -> None:
    (dropped,) = candidates(["frames_dropped"], [(1.0, 8.0)], FRAME_HZ)
    (shapes,) = as_lost(dropped, (3.5, 3.5, 6.25)).variants()
    assert (shapes["count"], shapes["moment"]) == (2.0, 3.5)
    assert [shapes[f"again_{k}_s"] for k in (1, 2)] == [6.25, 0.0]


def test_more_at_one_moment_than_one_number_holds_are_lost_again_just_then() -> None:
    """As a drive's frequency that is off looks, once it is half a cycle off."""
    (dropped,) = candidates(["frames_dropped"], [(1.0, 8.0)], FRAME_HZ)
    known = as_lost(dropped, (3.5,) * 5)
    check_candidates([known])
    (shapes,) = known.variants()
    assert (shapes["count"], shapes["moment"]) == (3.0, 3.5)
    assert [shapes[f"again_{k}_s"] for k in (1, 2, 3)] == [3.5, 3.5, 0.0]
