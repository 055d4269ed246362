"""`analysis report`: one page that shows what was found."""

from pathlib import Path
from typing import Annotated

import typer

from cdpr8.terminal import note, say


def report(
    run: Annotated[str, typer.Argument(help="a run folder, or its name", show_default=False)],
    out: Annotated[
        Path | None, typer.Option(help="the page; default: report.html among the run's results")
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="processes, where it must be diagnosed")] = 2,
) -> None:
    """Write one self-contained HTML page: the verdict, its figures, and the paper's table.

    It uses what `analysis diagnose` and `analysis compare` left, and runs what is missing.

    Example: analysis report run01
    """
    from analysis.page.gather import gather
    from analysis.page.page import page
    from cdpr8.runfolder import find_run, results_folder

    folder = find_run(run)
    material = gather(folder, workers=workers, say=note)
    path = out or results_folder(folder) / "report.html"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page(material), encoding="utf-8")
    say(str(path))
