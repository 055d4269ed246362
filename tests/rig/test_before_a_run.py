"""What is done before a run: zeros, pretension, the doctor, a slack warning, a time to begin."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import WavePlatform, rig_text

from cdpr8.errors import CheckError, DataError, UsageError
from cdpr8.rigfile import Rig, packaged_rig_path
from cdpr8.runfolder import load_run
from cdpr8.terminal import run_app
from rig.command import app
from rig.slack import least_tension_n, slack_warning
from rig.until import seconds_until
from rig.zeros import Zeros, check_zeros, read_zeros, take_zero, write_zeros

NOW = datetime(2024, 1, 1, tzinfo=UTC)

pytestmark = pytest.mark.usefixtures("here")


def test_a_zero_is_taken_at_rest_and_without_load() -> None:
    rng = np.random.default_rng(1)
    zero = take_zero(0.004 + 1e-4 * rng.standard_normal(200), NOW, "1234567", 3)
    assert zero.zero_mv_per_v == pytest.approx(0.004, abs=3e-5)
    assert zero.spread_mv_per_v == pytest.approx(1e-4, rel=0.2)
    with pytest.raises(CheckError, match="cable 3 is not at rest"):
        take_zero(np.linspace(0.0, 0.01, 100), NOW, "1234567", 3)
    with pytest.raises(CheckError, match="cable 3 carries a load"):
        take_zero(np.full(10, 0.2), NOW, "1234567", 3)


def test_zeros_reach_the_tensions_and_the_start_record(rig: Rig, here: Path) -> None:
    from rig_stand_ins import motion, virtual_clock

    from rig.recorder import record
    from rig.simulated.rig import assemble

    zero = take_zero(np.full(10, 0.02), NOW, "SIM0001", 1)
    write_zeros(here / "zeros.json", Zeros(cables={1: zero}))
    zeros = read_zeros(here / "zeros.json")
    clock = virtual_clock()
    machine = assemble(rig, WavePlatform(), None, clock, seed=1)
    record(
        rig,
        rig_text(),
        here / "run",
        excitation=motion(0.5),
        clock=clock,
        machine=machine,
        zeros=zeros,
    )
    run = load_run(here / "run")
    # 0.02 of 1 mV/V of 50 N is 1 N.
    assert run.cable_tension(1)["tension_n"].mean() == pytest.approx(7.0 - 1.0, abs=0.01)
    assert run.start.nodes[0].zero_mv_per_v == 0.02
    assert run.start.nodes[0].zero_taken == NOW.isoformat()
    assert run.start.nodes[1].zero_taken == "never"
    with pytest.raises(DataError, match="'SIM0001', and '7654321' is on it now"):
        check_zeros(zeros, {1: "7654321"})


def test_the_simulated_rig_hangs_in_its_cables_so_its_zeros_are_refused(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rig.simulated import ahead

    monkeypatch.setattr(ahead, "simulate_ahead", lambda *_: WavePlatform())
    assert run_app(app, ["zero", "--for", "0.3"]) == 1
    assert "carries a load" in capsys.readouterr().err
    assert not Path("zeros.json").exists()


def test_pretension_tells_what_to_turn(
    rig: Rig, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rig.simulated import ahead

    monkeypatch.setattr(ahead, "simulate_ahead", lambda *_: WavePlatform())
    assert run_app(app, ["pretension", "--for", "1"]) == 1
    told = capsys.readouterr()
    target = float(rig.cable[0].pretension_n.value)
    assert f"cable 1:    7.00 N of {target:g} N (-" in told.out
    assert told.out.splitlines()[0].endswith("N): pull")
    assert "not at their targets" in told.err


def test_the_doctor_says_one_verdict_a_line(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_app(app, ["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert {line.split()[1] for line in lines} >= {"versions", "port", "camera", "disk", "writing"}
    text = packaged_rig_path().read_text(encoding="utf-8")
    (here / "rig.toml").write_text(text.replace('port = "simulated"', 'port = "/dev/ttyUSB7"'))
    assert run_app(app, ["doctor"]) == 1
    told = capsys.readouterr()
    assert "FAIL  port       /dev/ttyUSB7 is not there" in told.out
    assert "plug the adapter in" in told.out


def test_a_motion_that_would_let_a_cable_go_slack_is_warned_of(rig: Rig) -> None:
    small = rig.excitation.model_copy(update={"amplitude_deg": 0.1})
    large = rig.excitation.model_copy(update={"amplitude_deg": 30.0})
    assert slack_warning(rig, small) is None
    assert "near slack" in slack_warning(rig, large)
    assert min(least_tension_n(rig, large).values()) < 0


@pytest.mark.parametrize(
    ("text", "seconds"), [("12:30", 1800.0), ("12:00:05", 5.0), ("11:00", 23 * 3600.0)]
)
def test_until_is_the_next_time_the_clock_shows_it(text: str, seconds: float) -> None:
    assert seconds_until(text, datetime(2024, 1, 1, 12, 0, tzinfo=UTC)) == seconds
    with pytest.raises(UsageError, match="no time of day"):
        seconds_until("noon", NOW)
