"""A diagnosis that is printed says what it came to."""

from analysis.engine import diagnose
from tests.analysis.engine.test_settled import Bent


def test_what_is_printed_holds_verdict_cause_number_and_proof() -> None:
    found = diagnose(Bent())
    first, cause, left, used, held, *rest = str(found).splitlines()
    assert found.judgement is not None
    (named,) = found.judgement.causes
    assert first == "line: explained"
    value, sigma = named.values["bend"], named.sigmas["bend"]
    assert cause == f"  bend, 0.95: bend {value:.4g} +- {sigma:.2g} V/s^2"
    assert left.endswith("no more than noise allows")
    proof = found.confirmation
    assert proof is not None
    for line, part in ((used, "used"), (held, "held_out")):
        (before,), (after,) = proof.before[part].values(), proof.after[part].values()
        assert line.endswith(f"{before:.3g} before, {after:.3g} after")
    assert rest == [f"  note: {one}" for one in found.notes]


def test_what_stopped_before_it_names_says_where_it_differs() -> None:
    found = diagnose(Bent(), stop_after="locate")
    said, where = str(found).splitlines()
    assert said == "line: nothing asked to be named"
    assert where.startswith("  differs most in x, ")
