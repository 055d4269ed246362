"""The live view of a recording on standard error; it may stall or fail without harm to the data."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from cdpr8.rigfile import Rig
from rig.tally import Tally

if TYPE_CHECKING:
    from rich.table import Table

BAR = 20

SHOW_EVERY_S = 0.25
"""Often enough for an eye, and little work."""


@contextmanager
def live_view(
    rig: Rig, duration_s: float, folder: Path | None = None
) -> Iterator[Callable[[Tally, float], None] | None]:
    """A table that follows the counts; None where standard error is no terminal.

    Parameters
    ----------
    rig
        For names and the cells' nominal forces.
    duration_s
        Of the whole recording.
    folder
        Of the run: the disk it is on.
    """
    import sys

    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.live import Live

    with Live(console=Console(stderr=True), transient=True, auto_refresh=False) as live:
        shown_s = -SHOW_EVERY_S

        def show(tally: Tally, now_s: float) -> None:
            nonlocal shown_s
            if now_s - shown_s < SHOW_EVERY_S:
                return
            shown_s = now_s
            live.update(_table(rig, duration_s, tally, now_s, folder), refresh=True)

        yield show


def _table(rig: Rig, duration_s: float, tally: Tally, now_s: float, folder: Path | None) -> "Table":
    from rich.table import Table

    lost = ", ".join(f"{what} {count}" for what, count in tally.lost.items()) or "nothing lost"
    left_s = max(0.0, duration_s - now_s)
    table = Table(
        title=f"{max(0.0, now_s):.1f} of {duration_s:g} s ({left_s:.0f} s left), "
        f"{tally.frames} frames, {lost}",
        caption=f"{tally.last_event}   {_disk_left(folder)}",
    )
    for heading in ("cable", "rate 1/s", "tension N", ""):
        table.add_column(heading, justify="left" if heading in ("cable", "") else "right")
    for number, cable in enumerate(rig.cable, start=1):
        tension_n = tally.tension_n.get(number)
        nominal_n = cable.amplifier.nominal_force_n if cable.amplifier else 1.0
        filled = 0 if tension_n is None else round(BAR * min(1.0, abs(tension_n) / nominal_n))
        table.add_row(
            f"{number} {cable.name}",
            f"{tally.samples[number] / now_s:.1f}" if now_s > 0 else "",
            "" if tension_n is None else f"{tension_n:.3f}",
            _bar(filled),
        )
    return table


def _bar(filled: int) -> str:
    """Of the cell's range; the last tenth is drawn otherwise."""
    warn = round(0.9 * BAR)
    return "".join(
        ("!" if place >= warn else "#") if place < filled else "." for place in range(BAR)
    )


def _disk_left(folder: Path | None) -> str:
    import shutil

    if folder is None or not folder.exists():
        return ""
    return f"disk {shutil.disk_usage(folder).free / 1e9:.1f} GB left"
