"""`rig verify`: what it finds in a run, good, overloaded or interrupted."""

import json
from pathlib import Path

import pytest
from rig_stand_ins import WavePlatform, record_virtually

from cdpr8.rigfile import Rig
from cdpr8.runfolder import load_run
from cdpr8.terminal import run_app
from rig.command import app
from rig.finding import Verdict
from rig.verify import verify

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


def test_a_cable_that_fell_silent_for_good_fails_and_does_not_stretch_the_skew(
    rig: Rig, here: Path
) -> None:
    record_virtually(rig, here / "run", 2.0, camera=False)
    path = here / "run" / "tension.csv"
    heading, *rows = path.read_text().splitlines(keepends=True)
    kept = [row for row in rows if row.split(",")[1] != "3" or float(row.split(",")[0]) < 0.5]
    path.write_text("".join([heading, *kept]))
    found = {each.what: (each.verdict, each.words) for each in verify(load_run(here / "run"))}
    verdict, words = found["cable 3"]
    assert verdict is Verdict.FAIL
    assert words.startswith("3")  # about 131/s for a quarter of the time
    assert "none good from 0.49" in words
    assert words.endswith("to the end")
    assert found["cable 4"][0] is Verdict.OK
    assert "none good" not in found["cable 4"][1]
    assert found["skew"][1].startswith("values of one sweep lie up to 3.")


def test_a_damaged_clock_anchor_is_told_and_the_rest_is_verified(rig: Rig, here: Path) -> None:
    record_virtually(rig, here / "run", 1.0, camera=False)
    path = here / "run" / "events.csv"
    path.write_text(path.read_text().replace("2024-01-01T", "2024-01-.1T"))
    found = [each for each in verify(load_run(here / "run")) if each.verdict is Verdict.WARN]
    assert [each.what for each in found] == ["files"]
    assert "a clock_anchor is no date: '2024-01-.1T" in found[0].words


def test_an_interrupted_run_is_said_to_be_one(rig: Rig, here: Path) -> None:
    record_virtually(rig, here / "run", 1.0, camera=False)
    (here / "run" / "stop.json").unlink()
    assert run_app(app, ["verify", "run"]) == 0
    found = verify(load_run(here / "run"))
    assert found[0].verdict is Verdict.WARN
    assert "interrupted" in found[0].words
