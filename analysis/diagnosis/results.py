"""What `analysis diagnose` leaves in the results folder, and what can be made of it again."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analysis.diagnosis.guesses import guesses
from analysis.diagnosis.nuisances import DRIVE_SHARE, LATENCY_S
from analysis.diagnosis.one_thread import one_thread_each
from analysis.diagnosis.pictures import FILE, Pictures
from analysis.diagnosis.picturing import picture, with_causes
from analysis.diagnosis.proposing import proposals
from analysis.diagnosis.ranking import harmonics_of, ranking, ruled_out
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.run import RESULT, RunDiagnosis
from analysis.diagnosis.sides import sides
from analysis.diagnosis.tables import markdown
from analysis.diagnosis.words import sections
from cdpr8.errors import DataError
from cdpr8.provenance import versions
from cdpr8.runfolder import EventKind

PAGE = "diagnose.md"


@dataclass(frozen=True)
class Result:
    """A diagnosis as it lies in a results folder.

    Attributes
    ----------
    statement
        The JSON of design, section 6, with what the words and figures need beside it.
    pictures
        The arrays of the figures; None: they are not there.
    """

    statement: dict[str, Any]
    pictures: Pictures | None


def complete(found: RunDiagnosis) -> Result:
    """Add to a diagnosis what words and figures tell of it.

    Parameters
    ----------
    found
        The diagnosis.
    """
    with one_thread_each():
        drawn = picture(found.machine, found.diagnosis)
        proposed = proposals(
            found.statement,
            found.recordings,
            lambda: with_causes(found.machine, found.diagnosis),
        )
    ranked, out = ranking(found.diagnosis), ruled_out(found.diagnosis)
    said = dict(found.statement)
    said["fit"] = _with_parts(said["fit"])
    said["causes"] = [
        {
            **one,
            "where": {**one["where"], "harmonics": harmonics_of(found.diagnosis, one["effect"])},
        }
        for one in said["causes"]
    ]
    said["ranking"], said["ruled_out"] = ranked, out
    differs = said["verdict"] != "none"
    said["balance"] = sides(found.recordings, said["located"]) if differs else []
    said["proposal"] = proposed
    said["paper_guesses"] = guesses(drawn, ranked, out) if ranked else {}
    said["missing"] = missing(found.recordings)
    said["provenance"] = {
        "runs": [
            {
                "name": one.run.name,
                "id": one.run.start.id,
                "simulated": one.run.start.simulated,
                "reconstruction": one.run.start.reconstruction,
                "rig_sha256": one.run.start.rig_sha256,
                "excitation": one.excitation.model_dump(mode="json"),
            }
            for one in found.recordings
        ],
        "simulations": found.machine.simulated,
        "versions": versions(),
    }
    said["words"] = [{"heading": heading, "text": text} for heading, text in sections(said)]
    return Result(said, drawn)


def write(result: Result, folder: Path) -> list[Path]:
    """Write the statement, the page in Markdown and the arrays.

    Parameters
    ----------
    result
        What was found.
    folder
        Where; made if absent.
    """
    folder.mkdir(parents=True, exist_ok=True)
    said = result.statement
    text = json.dumps(said, indent=1, allow_nan=False)
    (folder / RESULT).write_text(text + "\n", encoding="utf-8")
    words = [(one["heading"], one["text"]) for one in said["words"]]
    (folder / PAGE).write_text(markdown(said, words, names(said)), encoding="utf-8")
    written = [folder / RESULT, folder / PAGE]
    if result.pictures is not None:
        written.append(result.pictures.save(folder))
    return written


def read(folder: Path) -> Result | None:
    """What `write` left; None: nothing.

    Raises
    ------
    DataError
        It cannot be read.
    """
    path = folder / RESULT
    if not path.is_file():
        return None
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
        drawn = Pictures.load(folder) if (folder / FILE).is_file() else None
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise DataError(
            f"what an earlier diagnosis left cannot be read: {error}",
            where=str(path),
            remedy="delete it, or run `analysis diagnose` again",
        ) from None
    return Result(said, drawn)


def names(said: dict[str, Any]) -> str:
    """The runs' names."""
    return ", ".join(one["name"] for one in said["provenance"]["runs"])


def missing(recordings: Sequence[Recording]) -> dict[str, str]:
    """What no run carries that would tell more, and what that costs, in words."""
    found = {}
    if not any(_has_tap(one) for one in recordings):
        stiffest = max(
            cable.stiffness_n_per_m.value for one in recordings for cable in one.rig.cable
        )
        found["tap"] = (
            "no run carries a tap that cells and camera both saw: their clocks are known to "
            f"{1e3 * LATENCY_S:g} ms only, and a camera late by that looks like viscous damping of "
            f"{stiffest * LATENCY_S:.2g} N s/m in the cables, so less than that cannot be named"
        )
    if all(one.run.command is None for one in recordings):
        found["command_log"] = (
            "no run carries a log of the commanded motion: that the drive moved as asked, to "
            f"{100.0 * DRIVE_SHARE:g} % of its amplitude and on time, is taken on trust"
        )
    return found


def _has_tap(one: Recording) -> bool:
    events = one.run.events
    return bool(len(events)) and bool((events["kind"] == EventKind.SYNC_TAP).any())


def _with_parts(fit: dict[str, Any]) -> dict[str, Any]:
    """Used and held-out data are told of, even where there is nothing to tell."""
    both = {
        stage: {part: dict(fit.get(stage, {}).get(part, {})) for part in ("used", "held_out")}
        for stage in ("before", "after")
    }
    return {**fit, **both}


def with_experiments(
    result: Result, following: dict[str, Any] | None, campaign: list[dict[str, Any]]
) -> Result:
    """With the next experiment, and a campaign of them, in the statement and in its words."""
    said = {**result.statement, "next_experiment": following, "campaign": campaign}
    said["words"] = [{"heading": heading, "text": text} for heading, text in sections(said)]
    return replace(result, statement=said)
