"""`rig verify`: what it finds in a run, good, overloaded or interrupted."""

import json
from pathlib import Path

import pytest
from rig_stand_ins import WavePlatform, record_virtually

from cdpr8.rigfile import Rig
from cdpr8.runfolder import load_run
from cdpr8.terminal import run_app
from rig.command import app
from rig.verify import Verdict, verify

pytestmark = pytest.mark.usefixtures("here")


def verdicts(rig: Rig, folder: Path, **keys: object) -> dict[str, tuple[Verdict, str]]:
    record_virtually(rig, folder, 2.0, **keys)
    return {each.what: (each.verdict, each.words) for each in verify(load_run(folder))}


def test_a_good_run_is_found_good(rig: Rig, here: Path) -> None:
    found = verdicts(rig, here / "run")
    assert {verdict for verdict, _ in found.values()} == {Verdict.OK}
    assert found["lost"][1] == "nothing"
    assert found["video"][1].startswith("32 frames, 16.00/s")


def test_an_overloaded_run_fails_its_check(
    rig: Rig, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = verdicts(rig, here / "run", platform=WavePlatform(45.0, 0.5), camera=False)
    assert found["overload"][0] is Verdict.FAIL
    assert run_app(app, ["verify", "run"]) == 1
    told = capsys.readouterr()
    assert "FAIL  overload   cables" in told.out
    assert "not in order: overload" in told.err
    assert run_app(app, ["verify", "run", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)[0]["verdict"] == "ok"


def test_an_interrupted_run_is_said_to_be_one(rig: Rig, here: Path) -> None:
    record_virtually(rig, here / "run", 1.0, camera=False)
    (here / "run" / "stop.json").unlink()
    assert run_app(app, ["verify", "run"]) == 0
    found = verify(load_run(here / "run"))
    assert found[0].verdict is Verdict.WARN
    assert "interrupted" in found[0].words
