"""Laws proposed for a missing force: what is chosen, what is told with it, and when nothing is."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis_stand_ins import statement
from recorded_by import STILL, by_model

from analysis.challenge.draw import Slot
from analysis.challenge.make import make
from analysis.diagnosis.missing_force import Missing, missing_forces
from analysis.diagnosis.prepare import prepare
from analysis.diagnosis.proposal import Proposal, propose
from analysis.diagnosis.proposing import HEADING, in_words, proposals
from analysis.diagnosis.results import complete
from analysis.diagnosis.run import diagnose_recordings
from analysis.diagnosis.schema import Statement
from analysis.diagnosis.state_terms import TERMS, State, values
from analysis.diagnosis.tables import proposal as table
from analysis.diagnosis.words import sections
from analysis.page.gather import Material
from analysis.page.page import page
from analysis.steady import harmonic_basis
from cdpr8.rigfile import Excitation
from model import ActiveEffect

HERTZ, STIFFNESS, NOISE_N = 2.0, 1400.0, 0.02
PLACE = {one.name: k for k, one in enumerate(TERMS)}
SLOW = Excitation(motion_s=10.0, **STILL)


def missing(
    law: Mapping[str, float],
    *,
    harmonics: int = 3,
    blocks: int = 10,
    share: float = 0.01,
    seed: int = 1,
) -> Missing:
    """A force of some terms in noise, its stiffness known to a share and its clock to 0.5 ms."""
    t_s = np.arange(128) / (128 * HERTZ)
    angle = 2.0 * np.pi * HERTZ * t_s
    stretch = 0.003 * np.sin(angle) + 0.0003 * np.cos(2.0 * angle)
    speed = 2.0 * np.pi * HERTZ * (0.003 * np.cos(angle) - 0.0006 * np.sin(2.0 * angle))
    basis = harmonic_basis(t_s, HERTZ, harmonics)
    seen = []
    for block in range(blocks):
        state = State(
            stretch, speed, 30.0 + STIFFNESS * stretch, stretch, np.full(128, 1.0 * block)
        )
        seen.append(np.linalg.lstsq(basis, values(state), rcond=None)[0])
    count = 1 + 2 * harmonics
    terms = np.array(seen).reshape(blocks * count, -1)
    moved = STIFFNESS * np.column_stack([share * stretch, 5e-4 * speed])
    known = np.tile(np.linalg.lstsq(basis, moved, rcond=None)[0], (blocks, 1))
    noise = NOISE_N * np.random.default_rng(seed).standard_normal(len(terms))
    level = np.tile(np.eye(count)[0], blocks)[:, None]
    force = 10.0 * level[:, 0] + sum(value * terms[:, PLACE[name]] for name, value in law.items())
    block = np.repeat(np.arange(blocks), count)
    return Missing(3, block, force + noise, np.full(len(terms), NOISE_N**2), known, terms, level)


def proposed(force: Missing, **options: Any) -> Proposal | None:
    return propose(force, np.random.default_rng(0), **options)


def names(found: Proposal | None) -> list[str]:
    return [] if found is None else [TERMS[one.term].name for one in found.terms]


@pytest.mark.parametrize(
    ("name", "value"),
    [("sign(speed)", 0.3), ("elongation²", 6e4), ("elongation³", 3e7), ("|speed|", 12.0),
     ("elongation speed", 5e3), ("time", 0.1)],
)  # fmt: skip
def test_a_law_of_one_term_is_proposed_with_its_number(name: str, value: float) -> None:
    found = proposed(missing({name: value}))
    assert names(found) == [name]
    assert found is not None
    only = found.terms[0]
    assert only.value == pytest.approx(value, abs=4.0 * only.sigma)
    assert only.sigma < 0.2 * value
    assert only.share > 0.7
    assert found.explains > 0.9
    assert (found.cable, found.blocks) == (3, 10)


def test_a_second_term_enters_where_it_is_worth_it() -> None:
    found = proposed(missing({"sign(speed)": 0.3, "elongation²": 4e4}))
    assert set(names(found)) == {"sign(speed)", "elongation²"}


@pytest.mark.parametrize("seed", range(20))
def test_nothing_is_proposed_for_noise(seed: int) -> None:
    assert proposed(missing({}, seed=seed), resamples=10) is None


def test_what_the_rig_file_leaves_open_is_no_law() -> None:
    # Two sigmas of the stiffness, one of the clock: far more than the noise.
    off = {"elongation": 0.02 * STIFFNESS, "speed": 5e-4 * STIFFNESS}
    assert proposed(missing(off)) is None
    assert names(proposed(missing({"elongation": 0.2 * STIFFNESS}))) == ["elongation"]


def test_what_does_not_repeat_is_no_law() -> None:
    force = missing({})
    kick = np.where(force.block == 4, 1.0, 0.0) * force.terms[:, PLACE["sign(speed)"]]
    off = Missing(3, force.block, force.force + kick, force.variance, force.known, force.terms,
                  force.level)  # fmt: skip
    assert proposed(off) is None


def test_terms_that_one_harmonic_does_not_part_are_told_together() -> None:
    found = proposed(missing({"sign(speed)": 0.3}, harmonics=1))
    assert found is not None
    told = {names(found)[0], *(TERMS[k].name for k, _, _ in found.terms[0].alternatives)}
    assert {"speed", "sign(speed)", "speed |speed|"} <= told
    apart = proposed(missing({"sign(speed)": 0.3}))
    assert apart is not None
    assert "speed" not in {TERMS[k].name for k, _, _ in apart.terms[0].alternatives}


def test_the_platform_may_stand_in_where_all_cables_are_off() -> None:
    force = missing({"elongation²": 6e4})
    alone, common = proposed(force), proposed(force, everywhere=True)
    assert alone is not None
    assert common is not None
    square = PLACE["platform angle²"]
    assert square not in {k for k, _, _ in alone.terms[0].alternatives}
    assert square in {k for k, _, _ in common.terms[0].alternatives}


@pytest.mark.long
def test_it_is_told_as_a_proposal_with_units_and_what_to_check(tmp_path: Path) -> None:
    rubbing = ActiveEffect("pulley_coulomb", {"coulomb_n": (0.3, 0.3, 0, 0, 0, 0, 0, 0)})
    run = by_model(tmp_path / "run", [rubbing], SLOW)
    said = statement("unexplained", [])
    said["proposal"] = proposals(said, [run], lambda: None)
    assert [one["cables"] for one in said["proposal"]] == [[1], [2]]
    for one in said["proposal"]:
        assert [term["term"] for term in one["terms"]] == ["sign(speed)"]
        assert one["terms"][0]["value"] == pytest.approx(0.3, abs=0.05)
        assert one["note"].startswith("a proposal, not a finding")
    Statement.model_validate(said)
    text = in_words(said)
    assert text.startswith("A proposal, not a finding")
    assert "The missing force of cables 1 and 2 goes as sign(speed): 0." in text
    assert " N (cable 1) and 0." in text
    assert "To check: another frequency" in text
    assert len(table(said).rows) == 2
    said["words"] = [{"heading": h, "text": t} for h, t in sections(said)]
    shown = page(Material("hand", said, None, None, None, ()))
    assert f"<h2>{HEADING}</h2><p>A proposal, not a finding" in shown
    assert "proposed, not found" in shown
    # What a cause makes is not missing.
    named = {**said, "verdict": "explained", "remains": {"significant": True}}
    assert proposals(named, [run], lambda: [run]) == []
    assert len(proposals({**named, "verdict": "ambiguous"}, [run], lambda: [run])) == 2


@pytest.mark.long
def test_nothing_is_proposed_where_nothing_is_missing_or_the_camera_is_too_slow(
    tmp_path: Path,
) -> None:
    said = statement()
    assert proposals(said, [], lambda: None) == []
    assert in_words({**said, "proposal": []}) == ""
    left = {**said, "verdict": "unexplained", "proposal": []}
    assert in_words(left).startswith("None:")
    quick = Excitation(motion_s=4.0, **{**STILL, "frequency_hz": 7.5})
    assert missing_forces([by_model(tmp_path / "quick", [], quick)]) == []
    # The third harmonic of 4 Hz shows at 4 Hz in a camera of 16 frames a second.
    folded = Excitation(motion_s=6.0, **{**STILL, "frequency_hz": 4.0})
    assert missing_forces([by_model(tmp_path / "folded", [], folded)]) == []


@pytest.mark.slow
def test_a_law_that_the_library_lacks_is_proposed_for_another_plants_run(tmp_path: Path) -> None:
    plan = [Slot(1, "single", (), ()), Slot(2, "single", ("pulley_coulomb",), ("strong",))]
    make(tmp_path / "runs", 2, 6, plant="outsider", rivals=False, plan=plan)
    clean = prepare([tmp_path / "runs" / "case_0001" / "run01"])
    generator = np.random.default_rng(0)
    assert [propose(one, generator) for one in missing_forces(clean)] == [None] * 8
    rubbing = prepare([tmp_path / "runs" / "case_0002" / "run01"])
    said = complete(diagnose_recordings(rubbing, effects=["mass", "camera_gain"])).statement
    assert said["verdict"] == "unexplained"
    assert said["proposal"]
    assert HEADING in [one["heading"] for one in said["words"]]
    for one in said["proposal"]:
        first = one["terms"][0]
        assert "sign(speed)" in [first["term"], *(other["term"] for other in first["alternatives"])]
