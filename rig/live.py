"""The live view of a recording on standard error; it may stall or fail without harm to the data."""

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from cdpr8.rigfile import Rig
from rig.outcome import in_words
from rig.tally import Tally

if TYPE_CHECKING:
    from rich.table import Table

BAR = 20

SHOW_EVERY_S = 0.25
"""Often enough for an eye, and little work."""

RATE_OVER_S = 2.0
"""The rate shown is that of so long: a cable that falls silent is seen to."""


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

    rates = RecentRates()
    with Live(console=Console(stderr=True), transient=True, auto_refresh=False) as live:
        shown_s = -SHOW_EVERY_S

        def show(tally: Tally, now_s: float) -> None:
            nonlocal shown_s
            if now_s - shown_s < SHOW_EVERY_S:
                return
            shown_s = now_s
            recent = rates.at(now_s, tally.samples)
            live.update(live_table(rig, duration_s, tally, recent, now_s, folder), refresh=True)

        yield show


class RecentRates:
    """Values a second of each cable over the last `RATE_OVER_S`."""

    def __init__(self) -> None:
        self._seen: deque[tuple[float, dict[int, int]]] = deque()

    def at(self, now_s: float, counts: Mapping[int, int]) -> dict[int, float]:
        """The rates now, where so many values have come; empty at the first look."""
        self._seen.append((now_s, dict(counts)))
        while len(self._seen) > 2 and self._seen[1][0] <= now_s - RATE_OVER_S:
            self._seen.popleft()
        since_s, before = self._seen[0]
        if now_s <= since_s:
            return {}
        return {
            cable: (count - before.get(cable, 0)) / (now_s - since_s)
            for cable, count in counts.items()
        }


def live_table(
    rig: Rig,
    duration_s: float,
    tally: Tally,
    recent_per_s: Mapping[int, float],
    now_s: float,
    folder: Path | None,
) -> "Table":
    """Rate against what is expected, tension and bar of each cable; loss, last event, disk, time.

    Parameters
    ----------
    rig, duration_s, folder
        As for `live_view`.
    tally
        The counts so far.
    recent_per_s
        Cable -> values a second just now; a cable without any is silent, and its last tension is
        not shown as if it were the present one.
    now_s
        The time of the run.
    """
    from rich.table import Table

    left_s = max(0.0, duration_s - now_s)
    table = Table(
        title=f"{max(0.0, now_s):.1f} of {duration_s:g} s ({left_s:.0f} s left), "
        f"{tally.frames} frames; lost: {in_words(tally.lost)}",
        caption=f"{tally.last_event}   {_disk_left(folder)}",
    )
    for heading in ("cable", "rate 1/s", "of", "tension N", "of N", ""):
        table.add_column(heading, justify="left" if heading in ("cable", "") else "right")
    for number, cable in enumerate(rig.cable, start=1):
        rate, expected = recent_per_s.get(number), tally.expected_per_s.get(number)
        tension_n = tally.tension_n.get(number)
        nominal_n = cable.amplifier.nominal_force_n if cable.amplifier else 1.0
        silent = rate == 0.0
        shown = "" if tension_n is None else f"{tension_n:.3f}"
        table.add_row(
            f"{number} {cable.name}",
            "" if rate is None else f"{rate:.1f}",
            "" if expected is None else f"{expected:.0f}",
            "silent" if silent else shown,
            f"{nominal_n:g}",
            _bar(0 if silent or tension_n is None else abs(tension_n) / nominal_n),
        )
    return table


def _bar(part: float) -> str:
    """Of the cell's range; the last tenth is drawn otherwise."""
    filled, warn = round(BAR * min(1.0, part)), round(0.9 * BAR)
    return "".join(
        ("!" if place >= warn else "#") if place < filled else "." for place in range(BAR)
    )


def _disk_left(folder: Path | None) -> str:
    import shutil

    if folder is None or not folder.exists():
        return ""
    return f"disk {shutil.disk_usage(folder).free / 1e9:.1f} GB left"
