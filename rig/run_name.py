"""Where a run goes that is only given a name: the folder runs/NAME."""

from pathlib import Path

from cdpr8.errors import UsageError

RUNS = Path("runs")


def named_run(name: str) -> Path:
    """The folder of a run by its name.

    Parameters
    ----------
    name
        One folder name, as of `--name`.

    Raises
    ------
    UsageError
        It is a path: that would lead out of `runs`.
    """
    if name in ("", "..") or Path(name).name != name:
        raise UsageError(
            f"--name {name!r} is no name of a folder",
            allowed="one name, without / and not ..",
            remedy="rig record --out FOLDER records anywhere",
        )
    return RUNS / name
