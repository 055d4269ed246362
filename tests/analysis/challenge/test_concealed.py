"""The diagnosis itself on runs of the independent plant: it is not told what they conceal."""

from pathlib import Path

import pytest

from analysis.challenge.draw import Slot
from analysis.challenge.make import make
from analysis.challenge.run import run
from analysis.challenge.score import score
from analysis.diagnosis import diagnose_recordings
from analysis.diagnosis.prepare import prepare

SEED = 5

SHORT_LIST = (
    "cable_viscous",
    "camera_latency",
    "cell_gain",
    "cell_lag",
    "drive_phase",
    "pulley_coulomb",
    "stiffness",
)
"""All of the library takes half a minute a case."""

SHORT = (
    Slot(1, "single", (), ()),
    Slot(2, "single", ("cable_viscous",), ("strong",)),
    Slot(3, "single", ("drive_phase",), ("typical",)),
)

DOZEN = (
    *(Slot(number, "single", (), ()) for number in range(1, 5)),
    *(
        Slot(number, "single", (name,), ("strong",))
        for number, name in enumerate(
            (
                "pulley_coulomb",
                "cable_viscous",
                "cable_creep",
                "cell_zero",
                "camera_gain",
                "drive_phase",
                "drive_backlash",
                "frames_dropped",
            ),
            start=5,
        )
    ),
)


@pytest.fixture(scope="module")
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("short") / "challenge"
    make(folder, len(SHORT), SEED, rivals=False, plan=SHORT)
    return folder


@pytest.mark.parametrize("slot", SHORT, ids=lambda slot: "+".join(slot.effects) or "nothing")
def test_a_short_case_is_named(short: Path, slot: Slot) -> None:
    recordings = prepare([short / slot.name / "run01"])
    found = diagnose_recordings(recordings, effects=SHORT_LIST, stop_after="name").statement
    reported = [{one["effect"], *one["indistinguishable_from"]} for one in found["causes"]]
    if not slot.effects:
        assert found["verdict"] == "none"
    else:
        assert len(reported) == 1, reported
        assert set(slot.effects) <= reported[0]


@pytest.mark.slow
def test_a_dozen_cases_are_diagnosed_with_the_whole_library(tmp_path: Path) -> None:
    folder = tmp_path / "challenge"
    make(folder, len(DOZEN), SEED + 1, rivals=False, plan=DOZEN)
    run(folder)
    grades = score(folder).grades
    assert not [one.case for one in grades if not one.truth and one.verdict != "none"]
    named = [one.case for one in grades if one.truth and one.right]
    assert len(named) >= 7, named
