"""Scored sets kept for good: of each case what was concealed and what was said, to be graded again.

A set's runs fill gigabytes, and are made again from its seed; what was answered is not.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from analysis.challenge.grade import Grade, grade
from analysis.challenge.plants import FIRST
from analysis.challenge.run import answers_of
from analysis.challenge.seal import open_seal
from cdpr8.errors import DataError

FORMAT = "cdpr8-challenge-kept/1"

SAID = ("verdict", "causes")
"""Of an answer, all that grading reads, beside the fit to held-out data."""


@dataclass(frozen=True)
class Kept:
    """One set.

    Parameters
    ----------
    plant, seed, digest
        Which made the runs, from what, and the SHA-256 of its truth.
    engine
        What diagnosed it, as whoever kept it says.
    grades
        Of its cases.
    """

    plant: str
    seed: int
    digest: str
    engine: str
    grades: tuple[Grade, ...]


def keep(folder: Path, path: Path, engine: str) -> None:
    """Write what grading needs of a challenge.

    Parameters
    ----------
    folder
        Of the challenge.
    path
        File to write.
    engine
        What diagnosed it: a commit, say.

    Raises
    ------
    DataError
        The seal is missing or broken.
    """
    truth, digest = open_seal(folder)
    answers = answers_of(folder)
    cases = [
        {
            "truth": {key: case[key] for key in ("case", "kind", "effects")},
            "row": _said(answers[case["case"]]) if case["case"] in answers else None,
        }
        for case in truth["cases"]
    ]
    head = {
        "format": FORMAT,
        "plant": truth.get("plant", FIRST),
        "seed": truth["seed"],
        "sealed_sha256": digest,
        "engine": engine,
    }
    lines = ",\n".join(json.dumps(case, sort_keys=True, allow_nan=False) for case in cases)
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(head)[:-1] + f', "cases": [\n{lines}\n]}}\n'
    path.write_text(text, encoding="utf-8")


def _said(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row of the answers without what grading does not read."""
    answer = row["answer"] or {}
    found = {key: answer[key] for key in SAID if key in answer}
    after = ((answer.get("fit") or {}).get("after") or {}).get("held_out")
    if after is not None:
        found["fit"] = {"after": {"held_out": after}}
    return {"answer": found or None, "error": row["error"], "seconds": row["seconds"]}


def read_kept(path: Path) -> Kept:
    """Read a set, and grade it as sets are graded now.

    Parameters
    ----------
    path
        Of a file of `keep`.

    Raises
    ------
    DataError
        It is no such file.
    """
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        if held["format"] != FORMAT:
            raise ValueError(held["format"])
        return Kept(
            plant=held["plant"],
            seed=held["seed"],
            digest=held["sealed_sha256"],
            engine=held["engine"],
            grades=tuple(grade(case["truth"], case["row"]) for case in held["cases"]),
        )
    except (OSError, ValueError, KeyError, TypeError) as fault:
        raise DataError(
            f"not a kept set of a challenge ({type(fault).__name__}: {fault})",
            where=str(path),
            remedy="write it: analysis challenge score FOLDER --keep FILE",
        ) from None
