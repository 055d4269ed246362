"""A diagnosis in words: every effect has its sentence, every verdict an honest one."""

import re
from typing import Any

import pytest
from diagnosis_stand_ins import cause, statement

from analysis.diagnosis.guesses import in_words as guesses
from analysis.diagnosis.phrases import PHRASES, phrase
from analysis.diagnosis.schema import Statement, statement_schema
from analysis.diagnosis.spelling import listed, number, odds, percent
from analysis.diagnosis.tables import markdown, tables
from analysis.diagnosis.titles import SHORT, parameter_name
from analysis.diagnosis.words import headline, paragraph, ruled_out, sections
from cdpr8.terminal import say_table
from model.library.discovery import library

RIVAL = {"effect": "cable_viscous", "probability": 0.3}

BESIDE_THE_LIBRARY: dict[str, dict[str, Any]] = {
    "cell_saturation": {"clipped_n": (0.4, "N")},
    "frames_dropped": {"count": (2.0, "1"), "moment": (1003.25, "s")},
}
"""Numbers that the diagnosis fits in place of the library's."""


def caused(name: str) -> dict[str, Any]:
    """An effect with the numbers that a diagnosis would tell."""
    effect = library()[name]
    own = {
        one.name: ((one.default or one.high / 4.0), one.unit) for one in effect.parameters
    } | BESIDE_THE_LIBRARY.get(name, {})
    per_cable = any(one.per_cable for one in effect.parameters)
    parameters = {
        key: {"value": value, "sigma": abs(value) / 20.0, "unit": unit}
        for key, (value, unit) in own.items()
    }
    where = {"side": effect.acts.side, "cables": [3, 5] if per_cable else [], "when": "",
             "harmonics": []}  # fmt: skip
    return cause(name, parameters=parameters, where=where)


@pytest.mark.parametrize("name", sorted(library()))
def test_every_effect_has_a_sentence_with_its_cables_and_numbers(name: str) -> None:
    said = phrase(caused(name))
    assert re.fullmatch(r"[A-Z].*\.", said)
    assert "not told" not in said
    assert "_" not in said
    assert re.search(r"\d", said)
    assert ("3 and 5" in said) == any(one.per_cable for one in library()[name].parameters)
    if name not in ("cell_swapped", "frames_dropped"):
        assert "±" in said


def test_frames_that_were_lost_one_by_one_are_told_one_by_one() -> None:
    one = caused("frames_dropped")
    one["parameters"]["count"]["value"] = 1.0
    for k, at_s in enumerate((4.25, 6.5, 0.0, 0.0, 0.0), start=1):
        one["parameters"][f"again_{k}_s"]["value"] = at_s
    said = phrase(one)
    assert said.startswith("Three frames of the video are missing")
    assert "from 3.25, 4.25 and 6.50 s on" in said


def test_there_is_no_sentence_for_what_is_no_effect() -> None:
    assert set(PHRASES) == set(SHORT) == set(library())


def test_cables_that_differ_are_told_apart() -> None:
    one = cause()
    one["where"]["cables"] = [1, 2, 4]
    entry = one["parameters"]["coulomb_n"]
    entry["cables"] = {"1": 0.21, "2": 0.212, "4": 0.56}
    entry["sigma_cables"] = {"1": 0.01, "2": 0.01, "4": 0.02}
    said = phrase(one)
    assert said.startswith("Cables 1, 2 and 4 lose 0.211 ± 0.010 N (cables 1 and 2) and 0.56")
    assert "at each reversal" in said


def test_a_sign_is_a_word() -> None:
    one = caused("cell_gain")
    one["parameters"]["gain_share"]["value"] = -0.02
    assert "2.00 ± 0.10 % too low" in phrase(one)


@pytest.mark.parametrize(
    ("name", "value", "sigma", "unit", "said"),
    [
        ("coulomb_n", 0.2067, 0.0213, "N", "0.21 ± 0.02 N"),
        ("coulomb_n", 0.2067, 0.0123, "N", "0.207 ± 0.012 N"),
        ("gain_share", 0.0213, 0.0031, "1", "2.1 ± 0.3 %"),
        ("weight_share", 1.3, 0.2, "1", "1.3 ± 0.2"),
        ("latency_s", 0.0071, 0.0004, "s", "7.1 ± 0.4 ms"),
        ("creep_s", 12.0, 3.0, "s", "12 ± 3 s"),
        ("play_m", 2e-4, 3e-5, "m", "0.20 ± 0.03 mm"),
        ("cubic_n_per_m3", 5e6, 1e6, "N/m3", "0.0050 ± 0.0010 N/mm³"),
        ("drift_ppm", 212.0, 34.0, "ppm", "210 ± 30 ppm"),
        ("coulomb_n", 0.2, 0.0, "N", "0.2 N"),
    ],
)
def test_no_digit_is_told_that_is_not_known(
    name: str, value: float, sigma: float, unit: str, said: str
) -> None:
    assert number(name, value, sigma, unit) == said


def test_lists_odds_and_probabilities_read_as_english() -> None:
    assert listed([1, 2, 4]) == "1, 2 and 4"
    assert listed([1]) == "1"
    assert odds(3.0) == "20 to 1"
    assert odds(0.3) == "about even"
    assert odds(40.0) == "more than a million to 1"
    assert percent(0.9999) == "above 99 %"
    assert percent(0.97) == "97 %"


@pytest.mark.parametrize(
    ("verdict", "causes", "wanted"),
    [
        ("none", [], "Nothing was left out that these runs show"),
        ("parameter", [caused("stiffness")], "A number of the rig file is wrong, not the physics"),
        ("explained", None, "left out Coulomb friction at the pulleys"),
        ("ambiguous", [cause(indistinguishable_from=["cable_viscous"], rivals=[RIVAL])],
         "cannot settle what it is: Coulomb friction at the pulleys or viscous damping"),
        ("unexplained", [], "nothing in the library of effects says why"),
        ("not asked", [], "causes were not asked for"),
    ],
)  # fmt: skip
def test_every_verdict_is_told_as_what_it_is(verdict: str, causes: Any, wanted: str) -> None:
    said = statement(verdict, causes)
    assert wanted in headline(said)
    assert paragraph(said).startswith(headline(said))
    assert markdown(said, sections(said), "hand").startswith("# Diagnosis of hand\n")


def test_nothing_is_not_said_without_what_is_too_faint_to_be_named() -> None:
    said = statement("none", [], not_ruled_out=[{"effect": "mass", "probability": 0.43}])
    assert (
        "Too faint to be named, and not ruled out: a wrong mass of the platform (43 %)."
        in paragraph(said)
    )
    assert "ruled out" not in paragraph(statement("none", []))


def test_a_ring_that_nothing_follows_is_not_called_a_motion_that_nothing_follows() -> None:
    said = statement("unexplained", [])
    for significant, wanted in (
        (False, "follow how the platform rings"),
        (True, "not follow the rec"),
    ):
        said["remains"] = {**said["remains"], "significant": significant}
        assert wanted in headline(said)


def test_the_paragraph_has_the_numbers() -> None:
    said = paragraph(statement())
    assert "Cables 1 and 2 lose 0.25 ± 0.02 N to friction at their pulleys" in said
    assert "from 26 to 1.04 for tensions" in said
    assert "the fit did not use" in said
    assert "above the noise" not in said


def test_runs_that_did_not_count_are_told() -> None:
    said = statement()
    said["remains"] = {**said["remains"], "not_followed": ["run03", "run07"]}
    assert "run03 and run07 could not be followed to the end and did not count" in paragraph(said)
    assert "did not count" not in paragraph(statement())


def test_what_nothing_foretells_is_told_to_have_not_counted() -> None:
    said = statement("none", [])
    assert "foretells" not in paragraph(said)
    assert headline(said).startswith("Nothing was left out")
    said["remains"] = {**said["remains"], "foretold_until_s": 6.3}
    assert headline(said).startswith("Up to 6.3 s nothing was left out")
    assert "What was recorded after 6.3 s, nothing foretells: it did not count." in paragraph(said)
    Statement.model_validate(said)


def test_what_a_cause_alone_foretells_a_part_of_was_left_out() -> None:
    said = statement("unexplained", [])
    said["remains"] = {**said["remains"], "foretold_until_s": 2.06, "significant": False}
    assert headline(said).startswith(
        "Something was left out: parameters alone do not foretell the first 2.1 s"
    )
    Statement.model_validate(said)


def test_what_begins_at_once_is_told_with_when_and_where() -> None:
    said = statement("unexplained", [])
    late = {"foretold_until_s": 4.5, "begins_s": 5.17, "begins_in": "tension 4"}
    said["remains"] = {**said["remains"], **late}
    assert headline(said).startswith(
        "Nothing was left out up to 5.2 s; then something begins at once, loudest in tension 4"
    )
    Statement.model_validate(said)
    beside = statement()
    beside["remains"] = {**beside["remains"], **late}
    assert "At 5.2 s something begins at once that nothing explains." in paragraph(beside)


def test_nothing_is_not_ruled_out_where_it_is_about_as_likely() -> None:
    said = statement()
    assert "That nothing was left out is ruled out" in ruled_out(said)
    ranking = [
        {**one, "log_odds": one["log_odds"] if one["effects"] else -0.3} for one in said["ranking"]
    ]
    assert "That nothing was left out" not in ruled_out({**said, "ranking": ranking})


def test_an_error_that_stays_what_it_was_does_not_fall() -> None:
    fit = statement()["fit"]
    fit["after"] = {
        part: {kind: 0.998 * value for kind, value in kinds.items()}
        for part, kinds in fit["before"].items()
    }
    assert "falls" not in paragraph(statement(fit=fit))


def test_a_fit_far_from_the_noise_is_not_told_as_if_it_were_good() -> None:
    fit = statement()["fit"]
    fit["after"] = {"used": {"tension": 14.0}, "held_out": {"tension": 15.0}}
    assert "still well above the noise" in paragraph(statement(fit=fit))


def test_a_fit_that_does_not_fall_is_not_told_to_fall() -> None:
    fit = statement()["fit"]
    fit["after"] = {
        part: {kind: 1.1 * value for kind, value in kinds.items()}
        for part, kinds in fit["before"].items()
    }
    told = paragraph(statement(fit=fit))
    assert "comes no nearer to" in told
    assert "falls" not in told
    assert "show it by themselves" not in told


def test_an_error_that_falls_for_poses_and_rises_for_tensions_does_not_fall() -> None:
    fit = statement()["fit"]
    fit["before"] = {"held_out": {"tension": 1.14, "pose": 1.09}}
    fit["after"] = {"held_out": {"tension": 1.5, "pose": 1.06}}
    told = paragraph(statement(fit=fit))
    assert "goes from 1.14 to 1.5 for tensions and from 1.09 to 1.06 for poses" in told


def test_what_samples_show_is_told_as_that() -> None:
    said = statement()
    said["remains"] = {**said["remains"], "shown": True}
    Statement.model_validate(said)
    assert "show it by themselves" in paragraph(said)


def test_a_set_is_told_as_a_set_with_what_would_split_it() -> None:
    said = statement("ambiguous", [cause(indistinguishable_from=["cable_viscous"], rivals=[RIVAL])])
    assert "viscous damping of the cables (30 %)" in paragraph(said)
    said["next_experiment"] = {"what": "record roll", "command": "rig record --rig next_1.toml"}
    told = dict(sections(said))["What would change this verdict"]
    assert "Coulomb friction at the pulleys or viscous damping of the cables apart" in told
    assert "Next: record roll (`rig record --rig next_1.toml`)." in told


def test_an_implausible_number_is_a_warning() -> None:
    assert "Beware: coulomb_n" in paragraph(statement(causes=[cause(implausible=["coulomb_n"])]))


def test_other_cables_that_are_as_likely_are_told() -> None:
    one = cause()
    one["where"] = {**one["where"], "or_cables": [list(range(1, 9)), [2]]}
    told = paragraph(statement(causes=[one]))
    assert "It could as well be in all cables or cable 2: these data hardly tell." in told
    assert "as well be in" not in paragraph(statement(causes=[cause()]))


def test_what_was_ruled_out_is_told_with_its_odds() -> None:
    said = ruled_out(statement())
    assert "That nothing was left out is ruled out, more than a million to 1." in said
    assert "hysteresis of the cables 1,100 to 1" in said
    assert "odds against: drag of the air 49 to 1" in said
    assert "1 more effect of the library" in said


def test_the_papers_guesses_are_weighed() -> None:
    said = guesses(statement())
    assert "2.030 deg would read 2.020 deg, against 1.920 deg recorded" in said
    assert "the rate makes 9 % of the difference, so it is not the reason" in said
    assert "A long exposure instead is ruled out" in said
    assert "Friction is in the best explanation" in said
    assert "hysteresis of the cables without friction is 1,100 to 1 behind it" in said


@pytest.mark.parametrize(
    ("simulated_deg", "share", "words"),
    [
        (1.923, 0.9, "there is no difference to explain."),
        (1.90, -2.2, "the measured angle is the larger one, which no rate makes it."),
        (2.03, -0.4, "the rate makes none of the difference, so it is not the reason."),
        (2.03, 0.9, "the rate makes 90 % of the difference."),
    ],
)
def test_no_share_of_a_difference_is_told_where_there_is_none(
    simulated_deg: float, share: float, words: str
) -> None:
    said = statement()
    camera = {**said["paper_guesses"]["camera_rate"], "simulated_deg": simulated_deg}
    said["paper_guesses"]["camera_rate"] = {**camera, "share": share}
    assert f"against 1.920 deg recorded: {words}" in guesses(said)


def test_what_a_tap_would_have_told_is_said() -> None:
    assert "No run carries a tap." in dict(sections(statement()))["What would change this verdict"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stiffness stiffness_share@3", "stiffness, cable 3"),
        ("geometry base_x_m@8", "geometry base x, cable 8"),
        ("camera_axis axis_roll_deg", "camera axis roll"),
        ("pose zero 4", "place of the plate, pitch"),
        ("pretension of run01@3", "pretension of run01, cable 3"),
    ],
)
def test_parameters_have_names_in_words(name: str, words: str) -> None:
    assert parameter_name(name) == words


def test_tables_can_be_printed(capsys: pytest.CaptureFixture[str]) -> None:
    for table in tables(statement()):
        say_table(table.printed())
    printed = capsys.readouterr().out
    for wanted in ("coulomb_n 0.25 ± 0.02 N", "1 and 2", "97 %", "nothing left out", "-400.0",
                   "tension, held out", "1.04",
                   "tension of each cable beyond k ΔL", "stiffness, cable 3", "+5 %"):  # fmt: skip
        assert wanted in printed


def test_the_statement_fits_its_schema() -> None:
    import jsonschema

    said = statement()
    Statement.model_validate(said)
    jsonschema.validate(said, statement_schema())
    del said["causes"][0]["where"]["side"]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(said, statement_schema())
