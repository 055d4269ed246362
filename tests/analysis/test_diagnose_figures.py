"""The figures of a diagnosis, on arrays made by hand."""

from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from diagnosis_stand_ins import FRICTION_N, NOISE_N, pictures, result, statement

from analysis.diagnosis.figure_maps import PHASES, by_harmonic, by_phase
from analysis.diagnosis.figure_states import force_map
from analysis.diagnosis.figure_story import improved, mean_cycle, shown_channel
from analysis.diagnosis.figure_style import DARK, LIGHT, Look, most_off
from analysis.diagnosis.figures import drawings, drawn, write_figures
from analysis.diagnosis.pictures import Pictures
from analysis.diagnosis.results import read, write
from cdpr8.errors import DataError

NAMES = ["story", "map", "loops", "speed", "states", "fit", "ranking", "improvement"]


def test_all_of_them_are_there() -> None:
    assert [name for name, _ in drawings(statement(), pictures())] == NAMES


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("look", [LIGHT, replace(DARK, narrow=True)], ids=["screen", "phone"])
def test_each_is_drawn_in_its_colours_and_width(name: str, look: Look) -> None:
    from matplotlib.image import imread

    image = imread(BytesIO(drawn(dict(drawings(statement(), pictures()))[name], look)["png"]))
    assert image.shape[1] == pytest.approx(150 * look.width, abs=1)
    paper = [int(look.paper[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    assert np.allclose(image[-1, -1, :3], paper, atol=0.01)
    assert (np.abs(image[..., :3] - paper).max(axis=-1) > 0.1).mean() > 0.005


@pytest.mark.parametrize("name", ["story", "map"])
def test_a_channel_with_fewer_harmonics_has_blanks(name: str) -> None:
    whole = pictures()
    first, *others = whole.channels
    fewer = replace(first, harmonics_before=first.harmonics_before[:3], harmonics_after=np.zeros(0))
    lines = by_harmonic((fewer, *others), "before")
    assert np.array_equal(lines[0, :3], first.harmonics_before[:3])
    assert np.isnan(lines[0, 3:]).all()
    assert np.isfinite(lines[1:]).all()
    drawing = dict(drawings(statement(), replace(whole, channels=(fewer, *others))))[name]
    assert drawn(drawing, LIGHT)["png"]


def test_nothing_named_has_nothing_after() -> None:
    unnamed = replace(pictures(), named=False)
    said = statement("none", [])
    for name, draw in drawings(said, unnamed):
        assert drawn(draw, LIGHT)["png"], name


def test_friction_stands_out_by_phase_as_a_square_and_is_gone_after() -> None:
    before = by_phase(pictures(), "hand", "before")[0]
    assert before.shape == (PHASES,)
    stretching = np.cos(2.0 * np.pi * (np.arange(PHASES) + 0.5) / PHASES) > 0.3
    assert before[stretching] == pytest.approx(FRICTION_N / NOISE_N, rel=0.1)
    assert np.abs(by_phase(pictures(), "hand", "after")[0]).max() < 2.0


def test_friction_is_two_bands_of_the_force_map_and_no_more() -> None:
    channel = pictures().of("hand", "tension")[0]
    _, speed, force = force_map(channel, pictures().record("hand"))
    middle = 0.5 * (speed[1:] + speed[:-1])
    fast = np.abs(middle) > 0.3 * np.abs(middle).max()
    bands = np.nanmean(force[fast], axis=1)
    assert np.abs(bands) == pytest.approx(FRICTION_N, rel=0.1)
    assert (np.sign(bands) == np.sign(middle[fast])).all() or (
        np.sign(bands) == -np.sign(middle[fast])
    ).all()


def test_the_story_shows_the_tension_farthest_off_for_its_swing() -> None:
    first, second = pictures().of("hand", "tension")
    stiffer = replace(first, recorded=3.0 * first.recorded, before=3.0 * first.recorded + 0.1)
    assert shown_channel((stiffer, second)).cable == 2
    assert most_off((stiffer, second)) is not None


def test_the_storys_mean_cycle_has_the_friction_and_the_noise_about_it() -> None:
    one = pictures().of("hand", "tension")[0]
    run = pictures().record("hand")
    at, mean, spread = mean_cycle(run, one.t_s, one.recorded - one.before)
    assert np.all((at > 0.0) & (at < 1.0))
    sliding = np.cos(2.0 * np.pi * at)
    assert mean[sliding > 0.3] == pytest.approx(FRICTION_N, abs=0.02)
    assert mean[sliding < -0.3] == pytest.approx(-FRICTION_N, abs=0.02)
    assert np.median(spread) == pytest.approx(NOISE_N, rel=0.3)


def test_the_storys_numbers_are_those_of_held_out_data_where_there_are_any() -> None:
    said = statement()
    assert improved(said) == (
        "On held-out data, rms residual in units of the noise: tensions 26 → 1.04."
    )
    said["fit"]["before"]["held_out"] = {}
    assert improved(said).startswith("On the data used, ")
    assert improved(statement("none", [])) == ""


def test_a_run_that_does_not_repeat_has_no_story() -> None:
    own = pictures()
    still = replace(own.records[0], stretches=own.records[0].stretches[:1])
    assert not any(
        name.startswith("story")
        for name, _ in drawings(statement(), replace(own, records=(still,)))
    )


def test_the_cable_farthest_off_is_the_one_shown() -> None:
    own = pictures()
    first, second = own.of("hand", "tension")
    assert most_off((first, replace(second, before=second.before + 5.0 * second.rate_m_per_s)))
    assert most_off(()) is None
    doubled = replace(second, recorded=2.0 * second.recorded)
    chosen = most_off((first, doubled))
    assert chosen is not None
    assert chosen.cable == 2


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    made = result()
    write(made, tmp_path)
    found = read(tmp_path)
    assert found is not None
    assert found.statement == made.statement
    assert found.pictures is not None
    assert found.pictures.records == pictures().records
    for one, other in zip(found.pictures.channels, pictures().channels, strict=True):
        assert np.allclose(one.recorded, other.recorded, rtol=1e-6)
        assert np.array_equal(one.t_s, other.t_s)
    assert "# Diagnosis of hand" in (tmp_path / "diagnose.md").read_text(encoding="utf-8")


def test_nothing_there_is_nothing_and_a_torn_file_is_told(tmp_path: Path) -> None:
    assert read(tmp_path) is None
    (tmp_path / "diagnose.json").write_text('{"verdict": ')
    with pytest.raises(DataError, match="cannot be read"):
        read(tmp_path)


def test_files_have_the_figures_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    two = {name: draw for name, draw in drawings(statement(), pictures()) if name in NAMES[-2:]}
    monkeypatch.setattr("analysis.diagnosis.figures.drawings", lambda *_: two.items())
    written = write_figures(statement(), pictures(), tmp_path)
    assert {path.name for path in written} == {
        f"diagnose_{name}.{ending}" for name in NAMES[-2:] for ending in ("png", "svg")
    }


def test_a_campaign_has_figures_of_every_run() -> None:
    own = pictures()
    other = replace(own.records[0], name="second")
    more = tuple(replace(one, record="second") for one in own.channels)
    both = Pictures((*own.records, other), (*own.channels, *more), True)
    names = [name for name, _ in drawings(statement(), both)]
    assert "map_hand" in names
    assert "fit_second" in names
