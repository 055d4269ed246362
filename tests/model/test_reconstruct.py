import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cdpr8.errors import DataError, RigFileError
from cdpr8.rigfile import Rig, packaged_rig_path, parse_rig
from cdpr8.terminal import run_app
from model.command import app
from model.machine import Machine
from model.outputs import cable_states
from model.reconstruct.layout import BOUNDS, Layout, reach
from model.reconstruct.misfit import REFUSED, Judge, Misfit
from model.reconstruct.published import EXACT, VIOLENT
from model.reconstruct.rig_text import rig_text
from model.reconstruct.search import Plan, search, settled

GRAVITY_N_PER_KG = 9.80665


@pytest.fixture(scope="module")
def layout(rig: Rig) -> Layout:
    return Layout.of_machine(Machine.from_rig(rig))


@pytest.fixture(scope="module")
def judged(rig: Rig, layout: Layout) -> Misfit:
    return Judge(rig, repetitions=1).judge(layout)


def test_the_packaged_machine_has_a_layout(rig: Rig, layout: Layout) -> None:
    machine, again = Machine.from_rig(rig), Machine.from_rig(layout.rig(rig))
    for name in ("base", "anchor", "stiffness", "line_density", "damping"):
        assert getattr(again, name) == pytest.approx(getattr(machine, name), rel=1e-12)
    assert again.inertia == pytest.approx(machine.inertia, rel=1e-9, abs=1e-15)
    assert again.pretension == pytest.approx(machine.pretension, abs=2e-3)


def test_pretensions_carry_the_weight_exactly(rig: Rig, layout: Layout) -> None:
    heavier = replace(layout, mass=0.7, front_z=0.02, rear_down_tension=9.0)
    machine = Machine.from_rig(heavier.rig(rig))
    direction = (machine.base - machine.anchor) / machine.rest_length[:, None]
    force = machine.pretension @ direction
    moment = machine.pretension @ np.cross(machine.anchor, direction)
    assert force == pytest.approx([0, 0, 0.7 * GRAVITY_N_PER_KG], abs=1e-12)
    assert moment == pytest.approx(np.zeros(3), abs=1e-12)
    assert machine.pretension[[5, 6]].tolist() == [9.0, 9.0]


@settings(derandomize=True, deadline=None)
@given(st.lists(st.floats(0.0, 1.0), min_size=len(BOUNDS), max_size=len(BOUNDS)))
def test_any_point_of_the_search_has_the_inertia_of_a_rigid_body(shares: list[float]) -> None:
    low, high = np.array(list(BOUNDS.values())).T
    inertia = Layout.of_vector(low + np.array(shares) * (high - low), 0.2, -0.2).inertia
    smallest, middle, largest = np.sort(inertia)
    assert smallest > 0
    assert smallest + middle >= largest * (1 - 1e-12)


@pytest.mark.parametrize(("cable", "field"), [(0, "front_x"), (6, "rear_x")])
def test_an_anchor_is_placed_where_it_gives_the_wanted_variation(
    rig: Rig, layout: Layout, cable: int, field: str
) -> None:
    stiffness = rig.cable[cable].stiffness_n_per_m.value
    found = reach(layout, cable, stiffness, 0.035, 5.5)
    machine = Machine.from_rig(replace(layout, **{field: found}).rig(rig))
    pose = np.zeros((2, 6))
    pose[:, 4] = 0.035, -0.035
    tension = cable_states(machine, pose, np.zeros((2, 6)), np.zeros((2, 8))).tension_n
    variation = np.abs(tension[:, cable] - machine.pretension[cable]).max()
    assert variation == pytest.approx(5.5, abs=2e-3)
    assert np.sign(found) == np.sign(getattr(layout, field))


def test_a_variation_out_of_reach_is_no_number(layout: Layout) -> None:
    assert np.isnan(reach(layout, 0, 1410.0, 0.035, 500.0))


def test_the_packaged_machine_meets_the_exact_figures_and_misses_the_cables(
    judged: Misfit,
) -> None:
    assert judged.complete
    for figure in EXACT:
        found = judged.figures[2.06][figure.quantity]
        assert f"{found:.2f}" == f"{figure.value:.2f}"
    assert judged.terms["2.06 Hz, exact figures"] < 10
    assert judged.terms["14 Hz, cable_mm"] > 1
    assert judged.cost == pytest.approx(sum(judged.terms.values()))


def test_judging_stops_when_it_is_enough(rig: Rig, layout: Layout, judged: Misfit) -> None:
    stopped = Judge(rig, repetitions=1).judge(layout, enough=5.0)
    assert not stopped.complete
    assert 5.0 < stopped.cost < judged.cost
    assert len(stopped.terms) < len(judged.terms)


def test_a_machine_that_cannot_hang_is_refused_without_a_simulation(
    rig: Rig, layout: Layout
) -> None:
    misfit = Judge(rig).judge(replace(layout, rear_down_tension=0.2))
    assert misfit.cost >= REFUSED
    assert misfit.figures == {}


def test_other_stiffnesses_than_the_published_are_refused(rig: Rig) -> None:
    soft = rig.cable[0].stiffness_n_per_m.model_copy(update={"value": 1000.0})
    cables = (rig.cable[0].model_copy(update={"stiffness_n_per_m": soft}), *rig.cable[1:])
    with pytest.raises(RigFileError, match="1410"):
        Judge(rig.model_copy(update={"cable": cables}))


class Bowl:
    """Stands for a judge: how far a layout is from one in the middle of the bounds."""

    repetitions = 1

    def __init__(self) -> None:
        self.count = 0
        self.low, self.high = np.array(list(BOUNDS.values())).T

    def judge(self, layout: Layout, enough: float = np.inf) -> Misfit:
        self.count += 1
        off = (layout.vector() - self.low) / (self.high - self.low) - 0.5
        cost = float(off @ off)
        return Misfit(layout, cost, complete=cost <= enough)


def walk(starts: Sequence[Layout], path: Path, generations: int, seed: int = 4) -> list:
    plan = Plan(Bowl(), 60.0, 12, seed, generations)  # type: ignore[arg-type]
    return search(starts, plan, path)


def test_the_search_gets_better_and_keeps_what_it_found(layout: Layout, tmp_path: Path) -> None:
    first = walk([layout], tmp_path / "a.jsonl", 1)
    later = walk([layout], tmp_path / "b.jsonl", 60)
    start = Bowl().judge(layout).cost
    assert first[0].cost <= start
    assert later[0].cost < 0.2 * start
    assert [member.cost for member in later] == sorted(member.cost for member in later)


def test_a_search_cut_at_any_byte_goes_on_as_if_it_had_not_been(
    layout: Layout, tmp_path: Path
) -> None:
    path = tmp_path / "journal.jsonl"
    whole = walk([layout], path, 6)
    content = path.read_bytes()
    for cut in np.linspace(0, len(content), 23).astype(int):
        path.write_bytes(content[:cut])
        assert walk([layout], path, 6) == whole
        assert path.read_bytes() == content


def test_finalists_are_judged_again_and_ranked_by_that(layout: Layout, tmp_path: Path) -> None:
    found = walk([layout], tmp_path / "a.jsonl", 3)

    class Otherwise(Bowl):
        def judge(self, layout: Layout, enough: float = np.inf) -> Misfit:
            return Misfit(layout, 10.0 - super().judge(layout).cost, complete=True)

    again = settled(found[:5], Otherwise(), layout)  # type: ignore[arg-type]
    assert [one.vector for one in again] == [one.vector for one in found[4::-1]]


def test_a_journal_of_another_search_is_refused(layout: Layout, tmp_path: Path) -> None:
    path = tmp_path / "journal.jsonl"
    walk([layout], path, 1)
    with pytest.raises(DataError, match="another search"):
        walk([layout], path, 1, seed=5)


def test_the_rig_file_written_is_the_machine_found(rig: Rig, layout: Layout) -> None:
    pattern = packaged_rig_path().read_text()
    changed = replace(layout, mass=0.61, damping=5.123456789, rear_down_tension=8.2)
    text = rig_text(changed, pattern, name="CDPR-8", origin="From a test.")
    written = parse_rig(text, "written.toml", packaged_rig_path().parent)
    found = Machine.from_rig(written)
    assert found.mass == 0.61
    assert found.damping == pytest.approx(np.full(8, 5.123456789), rel=1e-5)
    assert found.base == pytest.approx(changed.base, rel=1e-5)
    assert found.pretension == pytest.approx(changed.rounded(6).pretension, abs=1e-6)
    assert "From a test." in text.split("[platform]")[0]
    assert written.cable[0].amplifier == rig.cable[0].amplifier
    assert (written.camera, written.plate, written.excitation) == (
        rig.camera,
        rig.plate,
        rig.excitation,
    )


def test_a_pattern_without_eight_cables_is_refused(layout: Layout) -> None:
    with pytest.raises(RigFileError, match="0 lines give mass_kg"):
        rig_text(layout, "[platform]\n", name="x", origin="y")


def test_every_target_names_its_section() -> None:
    assert all("Section" in figure.source for figure in (*EXACT, *VIOLENT))


@pytest.mark.parametrize(
    ("arguments", "code", "says"),
    [
        (["--population", "3"], 2, "at least 8"),
        (["--budget", "-1"], 2, "at least 0 s"),
        (["--start", "nowhere.toml"], 3, "nowhere.toml"),
    ],
)
def test_a_bad_input_gets_one_message(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    arguments: list[str],
    code: int,
    says: str,
) -> None:
    found = run_app(app, ["reconstruct", *arguments, "--out", str(tmp_path)])
    err = capsys.readouterr().err
    assert found == code
    assert says in err
    assert "Traceback" not in err


@pytest.mark.slow
def test_the_command_writes_a_rig_file_no_worse_than_where_it_started(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, judged: Misfit
) -> None:
    ask = ["--generations", "1", "--population", "8", "--repetitions", "1", "--budget", "1"]
    code = run_app(app, ["reconstruct", *ask, "--out", str(tmp_path), "--json"])
    answer = json.loads(capsys.readouterr().out)
    written = (tmp_path / "reconstructed.toml").read_text()
    assert code == 0
    assert answer["misfit"] <= 1.2 * judged.cost
    assert len(answer["figures"]) == len(EXACT) + len(VIOLENT)
    assert parse_rig(written, "reconstructed.toml", tmp_path).name == "CDPR-8"
