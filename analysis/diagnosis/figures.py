"""The figures of a diagnosis, drawn from what it left in the results folder."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from analysis.diagnosis.figure_fit import fit, improvement
from analysis.diagnosis.figure_loops import loops, speeds
from analysis.diagnosis.figure_maps import residual_map
from analysis.diagnosis.figure_ranking import ranking_figure
from analysis.diagnosis.figure_states import states
from analysis.diagnosis.figure_story import story
from analysis.diagnosis.figure_style import LIGHT, Look
from analysis.diagnosis.pictures import Pictures
from cdpr8.crew import Crew

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Draw = Callable[[Look], "Figure"]


def drawings(said: Mapping[str, Any], pictures: Pictures | None) -> Iterator[tuple[str, Draw]]:
    """Each figure that can be drawn of a diagnosis: its name, and what draws it.

    Parameters
    ----------
    said
        The statement.
    pictures
        Its arrays; None: figures of the statement alone.
    """
    if pictures is not None:
        yield from _of_runs(said, pictures)
    if len(said.get("ranking", [])) > 1:
        yield "ranking", partial(ranking_figure, said)
    if any(said["fit"].get("before", {}).values()):
        yield "improvement", partial(improvement, said)


def _of_runs(said: Mapping[str, Any], pictures: Pictures) -> Iterator[tuple[str, Draw]]:
    for run in pictures.records:
        after = f"_{run.name}" if len(pictures.records) > 1 else ""
        if any(one.repeats for one in run.stretches):
            yield f"story{after}", partial(story, said, pictures, run.name)
            yield f"map{after}", partial(residual_map, pictures, run.name)
            if pictures.of(run.name, "tension"):
                yield f"loops{after}", partial(loops, pictures, run.name)
                yield f"speed{after}", partial(speeds, pictures, run.name)
                yield f"states{after}", partial(states, pictures, run.name)
        yield f"fit{after}", partial(fit, pictures, run.name)


def write_figures(
    said: Mapping[str, Any], pictures: Pictures, folder: Path, workers: int = 1
) -> list[Path]:
    """Write every figure as PNG and SVG.

    Parameters
    ----------
    said, pictures
        What to draw.
    folder
        Where; made if absent.
    workers
        Processes.

    Returns
    -------
    list of Path
        The files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    names = [name for name, _ in drawings(said, pictures)]
    crew: Crew[str, dict[str, bytes]] = Crew(_Drawer(said, pictures), workers)
    written = []
    for name, files in zip(names, crew.do(names), strict=True):
        for ending, content in files.items():
            path = folder / f"diagnose_{name}.{ending}"
            path.write_bytes(content)
            written.append(path)
    return written


@dataclass(frozen=True)
class _Drawer:
    """Draws figures of one diagnosis by their names."""

    said: Mapping[str, Any]
    pictures: Pictures

    def do(self, work: str) -> dict[str, bytes]:
        """Ending of a file -> its bytes."""
        return drawn(dict(drawings(self.said, self.pictures))[work], LIGHT, ("png", "svg"))


def drawn(
    draw: Draw, look: Look, endings: Sequence[str] = ("png",), dpi: int = 150
) -> dict[str, bytes]:
    """One figure as files: ending -> bytes."""
    import matplotlib as mpl

    found = {}
    with mpl.rc_context(look.style):
        figure = draw(look)
        for ending in endings:
            buffer = BytesIO()
            metadata = {"Date": None} if ending == "svg" else None
            figure.savefig(buffer, format=ending, dpi=dpi, metadata=metadata)
            # Laying it out takes as long as drawing it: the next file has it as it is.
            figure.set_layout_engine("none")
            found[ending] = buffer.getvalue()
    return found
