"""Where runs live: a name is looked up in ., ./runs and the packaged sample_data."""

import os
from pathlib import Path

from cdpr8.errors import DataError


def sample_data_folder() -> Path:
    """The packaged sample runs: the folder beside the packages, installed or checked out."""
    return Path(__file__).resolve().parents[2] / "sample_data"


def find_run(name: str) -> Path:
    """The folder of a run.

    Parameters
    ----------
    name
        A path, or a name looked up in ``.``, ``./runs`` and the packaged sample_data.

    Raises
    ------
    DataError
        Nothing of that name is there; the message lists the runs that are.
    """
    places = (Path(), Path("runs"), sample_data_folder())
    for place in places:
        if (place / name).is_dir():
            return place / name
    known = sorted({start.parent.name for place in places for start in place.glob("*/start.json")})
    raise DataError(
        f"no run {name!r} in ., ./runs or the packaged sample_data",
        allowed="a folder, or one of: " + (", ".join(known) or "(no runs here yet)"),
        remedy="`rig record` makes one",
    )


def results_folder(run: Path) -> Path:
    """Where results of a run go: beside it, or ./results/RUN where it is packaged or read-only."""
    packaged = run.resolve().is_relative_to(sample_data_folder().resolve())
    if packaged or not os.access(run, os.W_OK):
        return Path("results") / run.resolve().name
    return run / "results"
