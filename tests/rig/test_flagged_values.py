"""Values that are recorded with a flag: overloaded, beyond the electronics, stuck."""

from pathlib import Path

from rig_stand_ins import WavePlatform, record_virtually, without_noise

from cdpr8.rigfile import Rig
from cdpr8.runfolder import TensionStatus, load_run


def test_overload_is_flagged_and_said_once(rig: Rig, tmp_path: Path) -> None:
    # Cable 8 rests at 21 N; the wave takes it over 120 % of 50 N and back.
    record_virtually(rig, tmp_path / "run", 2.0, platform=WavePlatform(45.0, 0.5), camera=False)
    run = load_run(tmp_path / "run")
    cable = run.tension[run.tension["cable"] == 8]
    over = (cable["status"] & int(TensionStatus.HOST_OVERLOAD)) != 0
    assert (cable["tension_n"][over] > 60).all()
    assert (cable["tension_n"][~over] <= 60).all()
    events = run.events[(run.events["kind"] == "overload") & (run.events["cable"] == 8)]
    assert len(events) == 1
    assert "above 120 % of the cell's 50 N" in events["detail"].iloc[0]


def test_an_input_beyond_the_electronics_is_kept_raw_and_not_good(rig: Rig, tmp_path: Path) -> None:
    record_virtually(
        rig, tmp_path / "run", 1.0, platform=WavePlatform(slope_n_per_s=400.0), camera=False
    )
    run = load_run(tmp_path / "run")
    clipped = run.tension[run.tension["digits"] >= 6_400_000]
    assert len(clipped) > 100
    assert ((clipped["status"] & int(TensionStatus.ADC_OVERFLOW)) != 0).all()
    assert run.cable_tension(1)["tension_n"].max() < 125.0


def test_a_stuck_value_is_flagged(rig: Rig, tmp_path: Path) -> None:
    record_virtually(without_noise(rig), tmp_path / "run", 2.0, camera=False)
    tension = load_run(tmp_path / "run").tension
    stale = (tension["status"] & int(TensionStatus.STALE)) != 0
    assert stale[tension["t_s"] > 0.6].all()
    assert not stale[tension["t_s"] < 0.5].any()
