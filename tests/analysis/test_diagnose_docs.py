"""docs/diagnose.md states what the code does."""

from math import exp
from pathlib import Path

from analysis.diagnosis import nuisances, schema
from analysis.diagnosis.policies import LAW, LINEAR, NUMBER
from analysis.engine import evidence, hypothesis, judge, locate, weights

TEXT = (Path(__file__).parents[2] / "docs" / "diagnose.md").read_text(encoding="utf-8")


def test_its_numbers_are_those_of_the_code() -> None:
    assert f"{100 * NUMBER:g} % for a gain" in TEXT
    assert f"{100 * LINEAR:g} % for linear damping" in TEXT
    assert f"{100 * LAW:g} % for friction" in TEXT
    assert "averaged over five sizes" in TEXT
    assert len(evidence.FORM_SIZES) == 5
    assert f"one in {round(exp(-hypothesis.LOG_ODDS), -1):.0f} for any effect" in TEXT
    assert "Scores are halved" in TEXT
    assert weights.TEMPER == 2.0
    assert "less than one case of a hundred" in TEXT
    assert locate.SIGNIFICANT == 0.01
    assert "at least nine in ten" in TEXT
    assert judge.CERTAIN == 0.9
    assert f"known to {1e3 * nuisances.LATENCY_S:g} ms" in TEXT
    assert f"trust to {100 * nuisances.DRIVE_SHARE:g} %" in TEXT


def test_every_verdict_and_key_is_explained() -> None:
    for verdict in ("none", "parameter", "explained", "ambiguous", "unexplained"):
        assert f"| `{verdict}` |" in TEXT
    for key in schema.Statement.model_fields:
        assert f"`{key}" in TEXT
