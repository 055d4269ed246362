"""By which ramp a motion began and how it ended is found out where a run does not state it."""

from pathlib import Path

import numpy as np
import pytest

from analysis.challenge.case import Case, PlannedRun
from analysis.challenge.plant.concealed import Concealed, catalogue
from analysis.challenge.plant.machine import Offset
from analysis.challenge.plant.record import Sensing, write
from analysis.challenge.rig_text import rig_text
from analysis.challenge.rigs import cdpr8
from analysis.challenge.truth import drawn_offset
from analysis.diagnosis.onset import as_it_moved
from analysis.tracking import poses_of
from cdpr8.rigfile import Excitation
from cdpr8.runfolder import Run, load_run

UNSTATED = {"rest_s": 0.8, "motion_s": 3.0, "ramp_s": 0.5}
LOSS = Concealed(catalogue()["cable_viscous"], 5.0, tuple(range(1, 9)), {})


def recorded(folder: Path, *, stated: bool = False, loss: bool = False, **law: str) -> Run:
    """A run of the independent plant, its machine off by its sigmas, that was moved by a law."""
    generator = np.random.default_rng(5)
    excitation = Excitation(**UNSTATED, **law)
    rig = cdpr8().model_copy(update={"excitation": excitation})
    planned = PlannedRun(rig, np.random.SeedSequence(5))
    concealed = (LOSS,) if loss else ()
    offset = drawn_offset(rig, generator) if not loss else Offset.none()
    case = Case("onset", "single", (planned,), Sensing.drawn(generator), offset, concealed)
    said = excitation if stated else Excitation(**UNSTATED)
    write(folder, "onset", rig_text(rig), said, case.made(planned))
    return load_run(folder)


@pytest.mark.parametrize("loss", [False, True], ids=["nothing left out", "with loss in the cables"])
@pytest.mark.parametrize("ramp", ["quintic", "raised_cosine"])
def test_the_ramp_is_told_by_the_onset(tmp_path: Path, ramp: str, loss: bool) -> None:
    run = recorded(tmp_path / "run", ramp=ramp, loss=loss)
    assert run.start.excitation.ramp == "quintic"
    moved, notes = as_it_moved(run, poses_of(run))
    assert moved.start.excitation.ramp == ramp
    assert moved.start.excitation.ending == "ramp_within"
    assert [ramp.replace("_", " ") in note for note in notes] == [True] * (ramp != "quintic")


def test_the_ending_is_told_by_what_follows(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run", ending="ramp_beyond")
    moved, (note,) = as_it_moved(run, poses_of(run))
    assert moved.start.excitation.ending == "ramp_beyond"
    assert moved.start.excitation.end_s == run.start.excitation.end_s + 0.5
    assert "after motion_s" in note


def test_what_a_run_states_is_believed(tmp_path: Path) -> None:
    run = recorded(tmp_path / "run", stated=True, ramp="raised_cosine", ending="ramp_within")
    assert run.start.excitation.ramp == "raised_cosine"
    assert as_it_moved(run, poses_of(run)) == (run, [])
    wrong = recorded(tmp_path / "wrong", stated=True, ramp="cubic", ending="ramp_within")
    assert as_it_moved(wrong, poses_of(wrong)) == (wrong, [])
