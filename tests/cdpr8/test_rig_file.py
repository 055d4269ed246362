"""A rig file is read whole or refused with file, line, value and what is allowed."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from cdpr8.errors import ExitCode, RigFileError, ToolkitError
from cdpr8.rigfile import load_rig, packaged_rig_path, parse_rig
from cdpr8.rigfile.checks import structure_matrix_at_rest
from cdpr8.rigfile.lines import key_lines

CASES = sorted((Path(__file__).parent / "bad_rigs").glob("*.toml"))


def spoil(text: str, case: dict[str, object]) -> str:
    """The packaged rig file with one fault put in, as a case file describes it."""
    if before := case.get("by_before"):
        old, new = before  # type: ignore[misc]
        assert text.count(old) == 1
        text = text.replace(old, new)
    if start := case.get("replace_from"):
        first = text.index(str(start))
        last = text.index(str(case["replace_to"]), first) + len(str(case["replace_to"]))
        return text[:first] + str(case["by"]) + text[last:]
    assert str(case["replace"]) in text
    return text.replace(str(case["replace"]), str(case["by"]), 1)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_wrong_rig_file_is_told_where_what_and_what_is_allowed(
    path: Path, tmp_path: Path
) -> None:
    case = tomllib.loads(path.read_text())
    text = spoil(packaged_rig_path().read_text(), case)
    with pytest.raises(ToolkitError) as caught:
        parse_rig(text, "rig.toml", tmp_path)
    message = str(caught.value)
    assert [words for words in case["says"] if words not in message] == [], message
    assert caught.value.exit_code == ExitCode.BAD_DATA


def test_the_packaged_rig_hangs_in_equilibrium() -> None:
    rig = load_rig(packaged_rig_path())
    pretension = np.array([cable.pretension_n.value for cable in rig.cable])
    wrench = structure_matrix_at_rest(rig) @ pretension
    weight = rig.platform.mass_kg.value * 9.80665
    assert np.allclose(wrench, [0, 0, weight, 0, 0, 0], atol=1e-3 * weight)


def test_a_bare_number_takes_the_default_sigma_of_its_kind() -> None:
    rig = load_rig(packaged_rig_path())
    cable = rig.cable[0]
    assert cable.pretension_n.sigma == 0.1
    assert cable.base_m.sigma == 1e-3
    assert cable.stiffness_n_per_m.sigma == pytest.approx(0.02 * cable.stiffness_n_per_m.value)
    assert cable.line_density_kg_per_m.sigma == pytest.approx(
        0.05 * cable.line_density_kg_per_m.value
    )
    assert rig.platform.mass_kg.sigma == pytest.approx(0.01 * rig.platform.mass_kg.value)


def test_a_parameter_may_say_how_well_it_is_known_and_from_where() -> None:
    text = packaged_rig_path().read_text()
    row = 'mass_kg = {value = 0.470878, sigma = 0.0, unit = "kg", source = "kitchen scales"}'
    rig = parse_rig(text.replace("mass_kg = 0.470878", row), "rig.toml", Path())
    assert rig.platform.mass_kg.sigma == 0.0
    assert rig.platform.mass_kg.source == "kitchen scales"


def test_a_missing_file_names_the_remedy(tmp_path: Path) -> None:
    with pytest.raises(RigFileError, match=r"(?s)no rig file.*remedy"):
        load_rig(tmp_path / "absent.toml")


def test_lines_are_found_in_arrays_of_tables_and_their_sub_tables() -> None:
    text = "[a]\nx = 1\n[[b]]\ny = 1\n[[b]]\ny = 2\n[b.c]\nz = 3\n"
    lines = key_lines(text)
    assert lines["a", "x"] == 2
    assert lines["b", 0, "y"] == 4
    assert lines["b", 1, "y"] == 6
    assert lines["b", 1, "c", "z"] == 8
