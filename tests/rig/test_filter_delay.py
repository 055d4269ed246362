"""A measured filter delay: from the rig file to the start record, applied at reading alone."""

from pathlib import Path

import numpy as np
import pytest
from rig_stand_ins import WavePlatform, record_virtually, rig_text, with_bus, without_noise

from cdpr8.errors import RigFileError
from cdpr8.rigfile import Rig
from cdpr8.rigfile.load import parse_rig
from cdpr8.runfolder import Run, load_run
from rig.finding import Verdict
from rig.verify import verify

Array = np.ndarray


def with_delay(value: str, amplifier: str = "") -> Rig:
    text = rig_text().replace("[bus]\n", f"[bus]\nfilter_delay_s = {value}\n")
    if amplifier:
        text = text.replace("address = 3,", f"address = 3, filter_delay_s = {amplifier},", 1)
    return parse_rig(text, "lab.toml", Path())


def recorded(rig: Rig, folder: Path, **keys: object) -> Run:
    record_virtually(rig, folder, 4.0, camera=False, **keys)
    return load_run(folder)


def test_a_measured_delay_is_kept_with_its_uncertainty_and_applied_at_reading(
    tmp_path: Path,
) -> None:
    platform = WavePlatform(5.0, 2.06)
    rigs = {
        "measured": with_delay('{value = 0.0101, sigma = 0.0006, source = "30 taps"}', "0.0052"),
        "estimated": parse_rig(rig_text(), "lab.toml", Path()),
    }
    runs = {
        name: recorded(with_bus(rig, filter=4), tmp_path / name, platform=platform)
        for name, rig in rigs.items()
    }
    nodes = runs["measured"].start.nodes
    assert (nodes[0].filter_delay_s, nodes[0].filter_delay_sigma_s) == (0.0101, 0.0006)
    assert nodes[2].filter_delay_s == 0.0052  # its own comes first
    assert nodes[2].filter_delay_sigma_s == pytest.approx(0.00052)
    assert {node.filter_delay_from for node in nodes} == {"measured"}
    (estimate,) = {node.filter_delay_s for node in runs["estimated"].start.nodes}
    assert estimate == pytest.approx(1 / (2 * np.pi * 18.0))
    assert {node.filter_delay_from for node in runs["estimated"].start.nodes} == {
        "from the cut-off"
    }
    assert runs["estimated"].start.nodes[0].filter_delay_sigma_s == pytest.approx(0.2 * estimate)
    # What was written is the same to the byte; what is read differs by the delay alone.
    written = [(tmp_path / name / "tension.csv").read_bytes() for name in runs]
    assert written[0] == written[1]
    for cable, delay_s in ((1, 0.0101), (3, 0.0052)):
        moved = (
            runs["estimated"].cable_tension(cable)["t_s"]
            - runs["measured"].cable_tension(cable)["t_s"]
        )
        assert moved.to_numpy() == pytest.approx(delay_s - estimate)
    found = {each.what: each for each in verify(runs["measured"])}
    assert found["delay"].verdict is Verdict.OK
    assert "cable 3: 5.20 ± 0.52 ms, measured" in found["delay"].words
    told = {each.what: each.words for each in verify(runs["estimated"])}
    assert told["delay"] == "8.84 ± 1.77 ms, from the cut-off; taken off where the run is read"


class Taps(WavePlatform):
    """Every half second the platform is tapped and swings at 3 Hz until it is at rest."""

    def tension_at(self, cable: int, t_s: Array) -> Array:
        since_s = np.asarray(t_s) % 0.5
        swing = np.exp(-since_s / 0.1) * np.sin(2 * np.pi * 3.0 * since_s)
        return np.asarray(20.0 + 10.0 * swing * (np.asarray(t_s) >= 0.5))


def first_maxima_s(run: Run, cable: int) -> Array:
    """Of each tap, from the times as they were written: a parabola through the values near it."""
    rows = run.tension[run.tension["cable"] == cable]
    times, values = rows["t_s"].to_numpy(), rows["tension_n"].to_numpy()
    found = []
    for tapped_s in np.arange(0.5, times[-1] - 0.4, 0.5):
        swing = (times > tapped_s) & (times < tapped_s + 0.3)
        top_s = times[swing][np.argmax(values[swing])]
        near = np.abs(times - top_s) < 0.025
        square, slope, _ = np.polyfit(times[near] - top_s, values[near], 2)
        found.append(top_s - 0.5 * slope / square)
    return np.array(found)


def test_taps_with_and_without_the_filter_tell_its_delay(rig: Rig, tmp_path: Path) -> None:
    # As docs/recording.md has it: how much later the first maximum shows, mean over the taps.
    quiet = without_noise(rig)
    maxima = [
        first_maxima_s(
            recorded(with_bus(quiet, filter=filter_), tmp_path / str(filter_), platform=Taps()), 2
        )
        for filter_ in (0, 4)
    ]
    later_s = maxima[1] - maxima[0]
    spread_s = later_s.std(ddof=1) / np.sqrt(len(later_s))
    assert later_s.mean() == pytest.approx(1 / (2 * np.pi * 18.0), abs=0.0015)
    assert spread_s < 0.0005


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("-0.001", "value -0.001 is refused"),
        ("12.0", "value 12.0 is refused"),
        ("nan", "value nan is refused"),
        ("true", "value True is refused"),
        ('"4 ms"', "value '4 ms' is refused"),
        ("{value = 0.004, sigma = -0.1}", "value -0.1 is refused"),
        ('{value = 4.1, unit = "ms"}', "unit 's'; the key says it too"),
        ("{sigma = 0.001}", "'value' is missing"),
    ],
)
def test_a_delay_that_cannot_be_is_refused_with_its_line(value: str, said: str) -> None:
    with pytest.raises(RigFileError) as fault:
        with_delay(value)
    assert said in fault.value.sentence()
    assert fault.value.where.startswith("lab.toml:109, bus.filter_delay_s")
    assert fault.value.exit_code == 3


@pytest.mark.parametrize(("value", "doubted"), [("4.1", True), ("0.0", False), ("0.012", False)])
def test_a_delay_of_another_filter_or_unit_is_doubted(
    value: str, doubted: bool, tmp_path: Path
) -> None:
    from rig_stand_ins import motion, virtual_clock

    from rig.recorder import record
    from rig.simulated.rig import assemble

    rig, clock, told = with_bus(with_delay(value), filter=4), virtual_clock(), list[str]()
    record(
        rig,
        rig_text(),
        tmp_path / "run",
        excitation=motion(0.5),
        clock=clock,
        machine=assemble(rig, WavePlatform(), None, clock, seed=1),
        warn=told.append,
    )
    if doubted:
        (words,) = told
        assert words.startswith("cable 1, 2, 3, 4, 5, 6, 7, 8: filter_delay_s = 4.1 was measured")
        assert "gives 0.0088 s: is it in s" in words
    else:
        assert told == []
