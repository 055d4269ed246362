"""One module owns exit codes and how an error is told."""

import json

import pytest
import typer

from cdpr8 import errors
from cdpr8.terminal import run_app, say_json


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (errors.CheckError, 1),
        (errors.UsageError, 2),
        (errors.DataError, 3),
        (errors.RigFileError, 3),
        (errors.DeviceError, 4),
    ],
)
def test_each_kind_of_error_has_its_exit_code_and_one_message(
    error: type[errors.ToolkitError], code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    app = typer.Typer()

    @app.command()
    def fail() -> None:
        raise error("it broke", allowed="whole ones", where="file:3", remedy="mend it")

    assert run_app(app, []) == code
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == ("error: file:3: it broke\n  allowed: whole ones\n  remedy:  mend it\n")


def test_an_unknown_option_is_a_usage_error(capsys: pytest.CaptureFixture[str]) -> None:
    app = typer.Typer()

    @app.command()
    def work() -> None:
        """Nothing to do."""

    assert run_app(app, ["--no-such-option"]) == 2
    assert "no-such-option" in capsys.readouterr().err


def test_json_is_strict(capsys: pytest.CaptureFixture[str]) -> None:
    say_json({"a": float("nan"), 1: (float("inf"), 2.0)})
    assert json.loads(capsys.readouterr().out) == {"a": None, "1": [None, 2.0]}
