"""`analysis challenge score`: the seal is opened, answers are held against the truth."""

import csv
import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from analysis.challenge.bars import Row, rows, stated
from analysis.challenge.grade import Grade, grade
from analysis.challenge.plants import FIRST
from analysis.challenge.run import REPORTS, answers_of
from analysis.challenge.seal import open_seal

NOTHING = "nothing"


@dataclass(frozen=True)
class Score:
    """What a challenge came to.

    Parameters
    ----------
    seed, version, digest
        Of the challenge: seed, toolkit that made it, SHA-256 of the truth.
    grades
        Of each case.
    rows
        The table.
    limits
        Of each effect: hits by strength and how small it can be seen.
    confusion
        (concealed, named) -> how often.
    failures
        Of the cases that went wrong, the worst first: what was there, what was said, where.
    plant
        Which made the runs.
    """

    seed: int
    version: str
    digest: str
    grades: tuple[Grade, ...]
    rows: tuple[Row, ...]
    limits: tuple[dict[str, Any], ...]
    confusion: dict[tuple[str, str], int]
    failures: tuple[dict[str, Any], ...]
    plant: str = FIRST

    @property
    def met(self) -> bool:
        """Whether no bar is missed."""
        return all(row.met is not False for row in self.rows)

    @property
    def seconds(self) -> dict[str, float]:
        """Median time of a diagnosis, by kind of case."""
        found = {}
        for kind in ("single", "campaign"):
            times = [one.seconds for one in self.grades if one.kind == kind and one.seconds > 0.0]
            if times:
                found[kind] = float(np.median(times))
        return found


def score(folder: Path) -> Score:
    """Grade every case of a challenge; those not diagnosed yet are left out of its figures.

    Parameters
    ----------
    folder
        Of the challenge.

    Raises
    ------
    DataError
        The seal is missing or broken.
    """
    truth, digest = open_seal(folder)
    answers = answers_of(folder)
    grades = [grade(case, answers.get(case["case"])) for case in truth["cases"]]
    done = [one for one in grades if one.verdict != "missing"]
    return Score(
        seed=truth["seed"],
        version=truth["version"],
        digest=digest,
        grades=tuple(grades),
        rows=tuple(rows(done)),
        limits=tuple(limits(done)),
        confusion=confusion(done),
        failures=tuple(failures(grades)),
        plant=truth.get("plant", FIRST),
    )


def confusion(grades: Sequence[Grade]) -> dict[tuple[str, str], int]:
    """What was concealed against what was named, one count for each visible effect.

    An effect counts as named where a reported set holds it; else as what was named first, else as
    the verdict. Cases that conceal nothing to be seen count as "nothing".
    """
    found: Counter[tuple[str, str]] = Counter()
    for one in grades:
        said = one.causes[0].effect if one.causes else one.verdict
        if not one.visible:
            found[NOTHING, NOTHING if one.verdict == "none" else said] += 1
        for effect in one.visible:
            name = str(effect["effect"])
            missed = NOTHING if said == "none" else said
            found[name, name if name in one.reported else missed] += 1
    return dict(found)


def limits(grades: Sequence[Grade]) -> list[dict[str, Any]]:
    """Of each effect: hits of cases by strength, the size at which it can be seen, and was."""
    by_name: dict[str, list[tuple[Grade, Any]]] = {}
    for one in grades:
        for effect in one.truth:
            by_name.setdefault(effect["effect"], []).append((one, effect))
    found = []
    for name, entries in sorted(by_name.items()):
        row: dict[str, Any] = {"effect": name, "unit": entries[0][1]["unit"]}
        row["size"] = entries[0][1]["size_name"]
        for kind in ("single", "campaign"):
            known = [
                e["detection_limit"]
                for one, e in entries
                if one.kind == kind and e["detection_limit"] is not None
            ]
            row[f"limit_{kind}"] = float(np.median(known)) if known else None
        for strength in ("limit", "typical", "strong"):
            chosen = [(one, e) for one, e in entries if e["strength"] == strength]
            hits = sum(_found(one, e) for one, e in chosen)
            row[strength] = [hits, len(chosen)]
        sizes = [abs(e["size"]) for one, e in entries if e["effect"] in one.reported]
        row["smallest_found"] = min(sizes) if sizes else None
        found.append(row)
    return found


def _found(one: Grade, effect: Any) -> bool:
    """Whether an effect was named, or rightly left alone."""
    if effect["effect"] in one.reported:
        return True
    return not effect["visible"] and one.right


def failures(grades: Sequence[Grade]) -> list[dict[str, Any]]:
    """Cases that went wrong, worst first: crashes, then what was surest and clearest."""
    wrong = [one for one in grades if not one.right and one.verdict != "missing"]

    def badness(one: Grade) -> tuple[bool, float, float]:
        sure = max((cause.probability or 0.0 for cause in one.causes), default=0.0)
        clear = max((effect["stands_out"] for effect in one.truth), default=0.0)
        return one.error is not None, sure if not one.truth else 0.0, clear

    return [
        {
            "case": one.case,
            "kind": one.kind,
            "concealed": [
                f"{e['effect']} {e['size']:.3g}{_unit(e['unit'])}, {e['strength']}, stands out "
                f"{e['stands_out']:.3g}"
                for e in one.truth
            ],
            "verdict": one.verdict,
            "named": [sorted(cause.set) for cause in one.causes],
            "error": one.error,
            "report": f"{REPORTS}/{one.case}",
        }
        for one in sorted(wrong, key=badness, reverse=True)
    ]


def _unit(unit: str) -> str:
    return "" if unit == "1" else f" {unit}"


def as_dictionary(score: Score) -> dict[str, Any]:
    """The score as JSON holds it."""
    return {
        "plant": score.plant,
        "seed": score.seed,
        "version": score.version,
        "sealed_sha256": score.digest,
        "cases": len(score.grades),
        "diagnosed": sum(one.verdict != "missing" for one in score.grades),
        "seconds": score.seconds,
        "table": [vars(row) | {"met": row.met} for row in score.rows],
        "limits": list(score.limits),
        "stated": stated(score.grades),
        "failures": list(score.failures),
    }


def write_score(score: Score, folder: Path) -> list[Path]:
    """Write score.json, confusion.csv, limits.csv and the figures.

    Returns
    -------
    list of Path
        The files.
    """
    from analysis.challenge.figures import draw_calibration, draw_confusion

    paths = [folder / name for name in ("score.json", "confusion.csv", "limits.csv")]
    paths[0].write_text(json.dumps(as_dictionary(score), indent=1) + "\n", encoding="utf-8")
    with paths[1].open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["concealed", "named", "cases"])
        writer.writerows([*pair, count] for pair, count in sorted(score.confusion.items()))
    with paths[2].open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(score.limits[0] if score.limits else ["effect"])
        for row in score.limits:
            writer.writerow(
                "/".join(map(str, v)) if isinstance(v, list) else v for v in row.values()
            )
    paths += draw_confusion(score.confusion, folder / "confusion")
    pairs = stated(score.grades)
    if pairs:
        paths += draw_calibration(pairs, folder / "calibration")
    return paths
