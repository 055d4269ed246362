"""A diagnosis in words that a student understands, with numbers and their uncertainty.

Everything is told from the statement (`diagnose.json`) alone, so that a page can be made again
without diagnosing again.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from analysis.diagnosis import proposing
from analysis.diagnosis.fit_words import falls, far_from_noise, improvement
from analysis.diagnosis.guesses import in_words as guesses_in_words
from analysis.diagnosis.phrases import phrase
from analysis.diagnosis.policies import FRICTIONS
from analysis.diagnosis.sides import in_words as which_side
from analysis.diagnosis.spelling import cables, listed, odds, percent, sentence
from analysis.diagnosis.titles import parameter_name, short

RULED_OUT = 3.0
"""Logarithm of odds, 20 to 1."""

TOLD_RIVALS = 4
"""Rivals that are named in a sentence."""

MOVED_SIGMAS = 2.0
"""A parameter that moved further than this is told."""

SIDE = "On which side it is"

Statement = Mapping[str, Any]


def paragraph(said: Statement) -> str:
    """What was found, in one paragraph."""
    causes = (_cause(one) for one in said["causes"])
    return " ".join([headline(said), *_not_ruled_out(said), *causes,
                     *_laws_of_one_thing(said), *improvement(said), *_remains(said)])  # fmt: skip


def sections(said: Statement) -> list[tuple[str, str]]:
    """The paragraph and what belongs beside it: (heading, text), those with nothing left out."""
    found = [
        ("What was found", paragraph(said)),
        (SIDE, which_side(said)),
        (proposing.HEADING, proposing.in_words(said)),
        ("What was ruled out", ruled_out(said)),
        ("The paper's own guesses", guesses_in_words(said)),
        ("What would change this verdict", change(said)),
    ]
    return [(heading, text) for heading, text in found if text]


def headline(said: Statement) -> str:
    """The verdict in one sentence."""
    causes = said["causes"]
    names = listed([short(one["effect"]) for one in causes])
    verdict = said["verdict"]
    if verdict == "none":
        until_s = said["remains"].get("foretold_until_s")
        first = "Nothing" if until_s is None else f"Up to {until_s:.1f} s nothing"
        return (
            f"{first} was left out that these runs show: simulation and recording agree once the "
            "rig file's numbers move within what is known of them."
        )
    if verdict == "parameter":
        return (
            f"A number of the rig file is wrong, not the physics: {names}. Moved by more than its "
            "stated uncertainty allows, it removes the mismatch."
        )
    if verdict == "explained":
        return _explained(said, names)
    if verdict == "ambiguous":
        return _ambiguous(causes)
    if verdict == "unexplained":
        return _unexplained(said)
    return (
        f"Recording and simulation differ in {len(said['located'])} places beyond the noise; "
        "causes were not asked for."
        if said["located"]
        else "Nowhere do recording and simulation differ beyond the noise."
    )


def _not_ruled_out(said: Statement) -> list[str]:
    """What may be there though nothing is named."""
    likely = [
        f"{short(one['effect'])} ({percent(one['probability'])})"
        for one in said.get("not_ruled_out") or []
    ]
    return [f"Too faint to be named, and not ruled out: {listed(likely)}."] if likely else []


def _ambiguous(causes: Sequence[Statement]) -> str:
    if not any(one["indistinguishable_from"] for one in causes):
        names = listed([short(one["effect"]) for one in causes])
        return f"Something was left out, most likely {names}; these runs do not make it sure."
    return (
        "Something was left out, and these runs cannot settle what it is: "
        f"{listed([_set(one) for one in causes], 'and beside it')}."
    )


def _explained(said: Statement, names: str) -> str:
    it = _it(said["causes"])
    if said["remains"].get("shown"):
        return (
            f"The simulation left out {names}. The samples show it by themselves; the simulation "
            f"does not follow the recording with {it} either."
        )
    how = "follows"
    if far_from_noise(said):
        how = "comes nearer" if falls(said) else "comes no nearer to"
    return f"The simulation left out {names}, and with {it} it {how} the recording."


def _unexplained(said: Statement) -> str:
    causes, remains = said["causes"], said["remains"]
    if not causes and (at_s := remains.get("begins_s")) is not None:
        return (
            f"Nothing was left out up to {at_s:.1f} s; then something begins at once, loudest in "
            f"{remains['begins_in']}, that nothing in the library of effects explains: a clamp or "
            "an anchor that slipped, a blow, or a sensor that jumped."
        )
    if not causes and (until_s := remains.get("foretold_until_s")) is not None:
        return (
            f"Something was left out: parameters alone do not foretell the first {until_s:.1f} s, "
            "and nothing in the library of effects foretells the rest. In that part it does too "
            "little to be told."
        )
    if not causes and not remains["significant"]:
        return (
            "In steady motion the simulation agrees with the recording, but no parameters within "
            "what is known of them follow how the platform rings, and nothing in the library of "
            "effects says why."
        )
    near = listed([_set(one) for one in causes], "with")
    return "The simulation does not follow the recording, and nothing in the library of " + (
        f"effects brings it to the noise. Nearest comes {near}, more likely wrong than right."
        if causes
        else "effects says why."
    )


def _it(causes: Sequence[Statement]) -> str:
    return "it" if len(causes) == 1 else "them"


def _set(cause: Statement) -> str:
    names = [cause["effect"], *cause["indistinguishable_from"]]
    return listed([short(one) for one in names], "or")


def _cause(cause: Statement) -> str:
    text = phrase(cause)
    where = cause["where"]
    rivals = cause.get("rivals", [])
    if rivals:
        others = [
            f"{short(one['effect'])} ({percent(one['probability'])})"
            for one in rivals[:TOLD_RIVALS]
        ]
        more = f" and {len(rivals) - TOLD_RIVALS} more" if len(rivals) > TOLD_RIVALS else ""
        text = (
            f"If it is {short(cause['effect'])} ({percent(cause['probability'])}): "
            f"{text[0].lower()}{text[1:]} The same recording could come from "
            f"{listed(others, 'or')}{more}."
        )
    else:
        text += f" The probability that it is this is {percent(cause['probability'])}."
    if where.get("or_cables"):
        places = listed([cables(one) for one in where["or_cables"]], "or")
        text += f" It could as well be in {places}: these data hardly tell."
    if where.get("when") and where["when"] != "throughout the motion":
        text += f" It shows {_when(where['when'])}."
    if cause.get("implausible"):
        text += (
            f" Beware: {listed(cause['implausible'])} came out at the edge of the plausible range, "
            "so the law may be another one than this."
        )
    return text


def _when(words: str) -> str:
    first = words.split(maxsplit=1)[0]
    return words if first in ("after", "slowly,", "growing", "from") else f"at {words}"


def _laws_of_one_thing(said: Statement) -> list[str]:
    """Two laws of friction found together are one friction that is neither."""
    rubbing = [one for one in said["causes"] if one["effect"] in FRICTIONS]
    rubbing = [one for one in rubbing if "coulomb_n" in one["parameters"]]
    if len(rubbing) < 2:
        return []
    total = friction_of_cables(said)
    parts = [f"{value:.2f} N in cable {cable}" for cable, value in sorted(total.items())]
    return [
        "These are laws of one thing: the true friction is rather one law that is neither. "
        f"Together, well away from reversal, they make {listed(parts)}."
    ]


def friction_of_cables(said: Statement) -> dict[int, float]:
    """Friction of each cable while it slides, all laws of it together, N."""
    total: dict[int, float] = {}
    for cause in said["causes"]:
        if cause["effect"] in FRICTIONS:
            for cable, value in cause["parameters"].get("coulomb_n", {}).get("cables", {}).items():
                total[int(cable)] = total.get(int(cable), 0.0) + float(value)
    return total


def _remains(said: Statement) -> list[str]:
    remains = said["remains"]
    told = []
    if (until_s := remains.get("foretold_until_s")) is not None:
        told = [f"What was recorded after {until_s:.1f} s, nothing foretells: it did not count."]
    if (at_s := remains.get("begins_s")) is not None and said["causes"]:
        told.append(f"At {at_s:.1f} s something begins at once that nothing explains.")
    if aside := remains.get("not_followed"):
        told += [
            f"With this, {listed(aside)} could not be followed to the end and did not count: there "
            "the law is not what the machine does."
        ]
    if not remains["significant"]:
        return told
    place = f", strongest in {remains['where']}" if remains.get("where") else ""
    return [*told, f"Something beyond noise and the laws' own uncertainty remains{place}."]


def ruled_out(said: Statement) -> str:
    """What was ruled out, and by how much."""
    out = said.get("ruled_out") or []
    if said["verdict"] in ("not asked", "") or not out:
        return ""
    fitted = [one for one in out if one["how"] != "screened" and -one["log_odds"] > RULED_OUT]
    texts = []
    null = next((-one["log_odds"] for one in said.get("ranking", []) if not one["effects"]), None)
    if said["causes"] and null is not None and null > RULED_OUT:
        texts.append(f"That nothing was left out is ruled out, {odds(null)}.")
    instead = [one for one in fitted if one["how"] == "instead"]
    if instead:
        parts = [
            f"{short(one['effect'])} {odds(-one['log_odds'])}" for one in instead[:TOLD_RIVALS]
        ]
        texts.append(f"Odds against what could stand in its place: {listed(parts)}.")
    beside = [one for one in fitted if one["how"] == "beside"]
    if beside:
        parts = [f"{short(one['effect'])} {odds(-one['log_odds'])}" for one in beside[:TOLD_RIVALS]]
        texts.append(f"Nothing more is asked for beside it; odds against: {listed(parts)}.")
    near = [one for one in out if one["how"] != "screened" and one not in fitted]
    if near:
        names = listed([short(one["effect"]) for one in near[:TOLD_RIVALS]])
        texts.append(f"Not ruled out as a part of it, though nothing asks for it: {names}.")
    count = sum(one["how"] == "screened" for one in out)
    if count:
        what = "effects" if count > 1 else "effect"
        texts.append(f"{count} more {what} of the library fell out in screening.")
    return " ".join(texts)


def change(said: Statement) -> str:
    """What would change the verdict: the nearest rival, the next experiment, taps and logs."""
    texts = []
    moved_far = [one for one in said.get("parameters", []) if abs(one["sigmas"]) > MOVED_SIGMAS]
    if moved_far and said["verdict"] != "parameter":
        parts = [
            f"{parameter_name(one['parameter'])} ({one['sigmas']:+.1f} sigma)"
            for one in moved_far[:TOLD_RIVALS]
        ]
        texts.append(
            f"The fit moved {listed(parts)}: measure {'it' if len(moved_far) == 1 else 'these'} "
            "independently."
        )
    sets = [one for one in said["causes"] if one["indistinguishable_from"]]
    for one in sets:
        texts.append(f"A run that tells {_set(one)} apart would narrow the set.")
    experiment = said.get("next_experiment")
    if experiment:
        command = f" (`{experiment['command']}`)" if experiment.get("command") else ""
        texts.append(sentence(f"next: {experiment['what']}{command}"))
    texts += [sentence(one) for one in (said.get("missing") or {}).values()]
    if said["verdict"] == "none":
        texts.append(
            "Effects that this motion hardly stirs would go unseen: another amplitude or frequency "
            "would show more."
        )
    return " ".join(texts)
