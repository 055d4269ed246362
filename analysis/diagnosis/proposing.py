"""Laws proposed for what the library does not explain, as the statement and its words have them."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from analysis.diagnosis.missing_force import missing_forces
from analysis.diagnosis.proposal import RESAMPLES, Chosen, propose
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.spelling import cables, listed, number, percent, sentence
from analysis.diagnosis.state_terms import TERMS

HEADING = "A law proposed for what is missing"

SEED = 0
"""Of the resamples: the same runs are told the same."""

MANY_SHARE = 0.95
"""A proposal that explains less of what is missing leaves something."""

Statement = Mapping[str, Any]


def asked(said: Statement) -> bool:
    """Whether something is left that a law could be proposed for."""
    named = said["verdict"] in ("explained", "ambiguous")
    return said["verdict"] == "unexplained" or (named and bool(said["remains"]["significant"]))


def proposals(
    said: Statement,
    recordings: Sequence[Recording],
    explained: Callable[[], Sequence[Recording] | None],
) -> list[dict[str, Any]]:
    """A law for each cable whose missing force has one; empty: none, or nothing is missing.

    Parameters
    ----------
    said
        The statement: its verdict and what remains.
    recordings
        The runs.
    explained
        Makes the runs as the causes make them: where these are sure, what they do is not missing.
    """
    if not asked(said):
        return []
    sure = said["verdict"] == "explained"
    missing = missing_forces(recordings, explained() if sure else None)
    generator = np.random.default_rng(SEED)
    found = [propose(one, generator) for one in missing]
    if len(missing) > 1 and all(one is not None for one in found):
        found = [propose(one, generator, everywhere=True) for one in missing]
    return [
        {
            "cables": [one.cable],
            "terms": [_term(term) for term in one.terms],
            "explains_share_held_out": one.explains,
            "stretches": one.blocks,
            "note": "a proposal, not a finding: no simulation was made with it; to check: "
            + "; ".join(dict.fromkeys(TERMS[term.term].check for term in one.terms)),
        }
        for one in found
        if one is not None
    ]


def _term(chosen: Chosen) -> dict[str, Any]:
    return {
        **_amount(chosen.term, chosen.value, chosen.sigma),
        "chosen_share": chosen.share,
        "alternatives": [_amount(*one) for one in chosen.alternatives],
    }


def _amount(term: int, value: float, sigma: float) -> dict[str, Any]:
    return {"term": TERMS[term].name, "value": value, "sigma": sigma, "unit": TERMS[term].unit}


def in_words(said: Statement) -> str:
    """What is proposed, or that nothing is; "": nothing is missing, or it was not looked for."""
    if "proposal" not in said or not asked(said):
        return ""
    groups: dict[tuple[str, ...], list[Statement]] = {}
    for one in said["proposal"]:
        groups.setdefault(tuple(term["term"] for term in one["terms"]), []).append(one)
    if not groups:
        return (
            "None: over the cables' measured state no term foretells, on stretches that it was not "
            "fitted to, more of the tensions beyond k ΔL than noise would; or the poses do not "
            "follow the motion of any run."
        )
    return " ".join(
        [
            "A proposal, not a finding: no simulation was made with it"
            + (", and what is named above was not taken off." if _unsure(said) else ".")
        ]
        + [_group(own) for own in groups.values()]
    )


def _unsure(said: Statement) -> bool:
    """Whether causes are told that may not be there."""
    return said["verdict"] != "explained" and bool(said["causes"])


def _group(own: Sequence[Statement]) -> str:
    """Cables of one law."""
    numbers = [cable for one in own for cable in one["cables"]]
    names = " + ".join(term["term"] for term in own[0]["terms"])
    each = listed([
        _coefficients(one) + (f" ({cables(one['cables'])})" if len(own) > 1 else "") for one in own
    ])  # fmt: skip
    least = min(term["chosen_share"] for one in own for term in one["terms"])
    share = percent(min(one["explains_share_held_out"] for one in own))
    several = "at least " if len(own) > 1 else ""
    texts = [
        f"The missing force of {cables(numbers)} goes as {names}: {each}. Chosen in {several}"
        f"{RESAMPLES * least:.0f} of {RESAMPLES} resamples, it explains "
        f"{several if share[0].isdigit() else ''}{share} of what is missing on stretches that it "
        "was not fitted to."
    ]
    alike = {other["term"]: None for one in own for term in one["terms"]
             for other in term["alternatives"]}  # fmt: skip
    if alike:
        where = "" if len(own) == 1 else ", in some of these cables"
        texts.append(f"As well in its place{where}: {listed(list(alike), 'or')}.")
    if any(one["explains_share_held_out"] < MANY_SHARE for one in own):
        texts.append("The rest has another form.")
    checks = dict.fromkeys(one["note"].partition("to check: ")[2] for one in own)
    return " ".join([*texts, *(sentence(f"to check: {one}") for one in checks)])


def _coefficients(one: Statement) -> str:
    """Of a cable's law, in the order of its terms."""
    values = [number("", term["value"], term["sigma"], term["unit"]) for term in one["terms"]]
    return listed(values)


def spelled(term: Statement) -> str:
    """A term with its coefficient."""
    return f"{term['term']}: {number('', term['value'], term['sigma'], term['unit'])}"
