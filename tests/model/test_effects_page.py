"""The page about the effects is the library, and the command speaks of it."""

import json
from pathlib import Path

import pytest

from cdpr8.errors import UsageError
from cdpr8.rigfile import Rig
from cdpr8.terminal import run_app
from model import ActiveEffect, simulate
from model.command import app
from model.effects import library
from model.library.document import markdown
from model.library.selection import of_rig

PAGE = Path(__file__).parents[2] / "docs" / "effects.md"


def test_the_page_is_what_the_library_says() -> None:
    assert PAGE.read_text() == markdown(), "write it anew: model effects --markdown"


def test_an_effect_is_read_from_the_command_line() -> None:
    one = ActiveEffect.from_text("pulley_coulomb:coulomb_n=0.4,presliding_m=1e-4@1,2")
    assert one.values == {"coulomb_n": 0.4, "presliding_m": 1e-4}
    assert one.columns()["coulomb_n"].tolist() == [0.4, 0.4, 0, 0, 0, 0, 0, 0]
    assert ActiveEffect.from_text("air_drag") == ActiveEffect("air_drag")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("pulley_colomb", "pulley_coulomb"),
        ("pulley_coulomb:force=1", "coulomb_n, presliding_m"),
        ("pulley_coulomb:coulomb_n", "a number"),
        ("pulley_coulomb:coulomb_n=-1", "0 to 5 N"),
        ("pulley_coulomb@9", "1 to 8"),
        ("pulley_coulomb@one", "@1,2"),
        ("air_drag@1", "no choice of cables"),
    ],
)
def test_a_wrong_effect_says_what_is_allowed(text: str, says: str) -> None:
    with pytest.raises(UsageError) as caught:
        ActiveEffect.from_text(text)
    assert says in caught.value.sentence()


def test_the_rig_file_keeps_effects_and_simulate_honours_them(rig: Rig) -> None:
    table = {"coulomb_n": {"value": 0.5, "sigma": 0.1}, "cables": [1, 2]}
    held = rig.model_copy(update={"physics": {"pulley_coulomb": table}})
    (kept,) = of_rig(held.physics)
    assert kept == ActiveEffect("pulley_coulomb", {"coulomb_n": 0.5}, (1, 2))
    assert ActiveEffect.from_table("pulley_coulomb", kept.as_table()) == kept
    run = simulate(held)
    assert run.effects == (kept,)
    assert run.provenance["effects"] == {"pulley_coulomb": {"coulomb_n": 0.5, "cables": [1, 2]}}
    assert simulate(held, effects=()).effects == ()


def test_an_effect_switched_on_twice_is_refused(rig: Rig) -> None:
    twice = [ActiveEffect("air_drag"), ActiveEffect("air_drag")]
    with pytest.raises(UsageError, match="twice"):
        simulate(rig, effects=twice)


def test_the_command_lists_every_effect(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["effects", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["effects"]
    assert [one["name"] for one in listed] == list(library())
    assert all(one["equation"] for one in listed)


def test_the_command_simulates_with_an_effect(capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["--with", "pulley_coulomb:coulomb_n=0.3@1,2"]
    assert run_app(app, ["simulate", "--motion", "1", *asked, "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["provenance"]["effects"] == {
        "pulley_coulomb": {"coulomb_n": 0.3, "cables": [1, 2]}
    }
