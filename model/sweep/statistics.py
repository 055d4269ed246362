"""Rows to tables: every run, and median and range by frequency."""

from collections.abc import Iterable

import pandas as pd

from model.jobs import Row
from model.status import Status
from model.sweep.amplitudes import AMPLITUDES
from model.sweep.plan import takes_half_step


def table(rows: Iterable[tuple[int, Row]]) -> pd.DataFrame:
    """Every run, by frequency and repetition, whatever order the rows came in."""
    frame = pd.DataFrame([row for _, row in rows])
    frame[list(AMPLITUDES)] = frame[list(AMPLITUDES)].astype(float)
    return frame.sort_values(["frequency_hz", "repetition"], ignore_index=True)


def median_by_step(runs: pd.DataFrame, frequency_hz: float, name: str) -> tuple[float, float]:
    """Median of an amplitude over the runs with the sweep's step, and over those with half of it.

    Where they differ little beside the range, the statistics do not hang on the step, though no
    single run of a chaotic motion is independent of it.
    """
    there = runs[runs["frequency_hz"] == frequency_hz]
    halved = there["repetition"].map(takes_half_step)
    whole, half = there[~halved][name], there[halved][name]
    return float(whole.median()), float(half.median())


def by_frequency(runs: pd.DataFrame) -> pd.DataFrame:
    """Statistics over the runs at each frequency.

    Parameters
    ----------
    runs
        From `table`.

    Returns
    -------
    pandas.DataFrame
        A row each frequency: how many runs, and how many were ok, slack or blew up; then of each
        amplitude its value with the motion's own start, its median and its range (columns
        ``NAME``, ``NAME_median``, ``NAME_low``, ``NAME_high``). A run that blew up before the
        steady window has no amplitudes and is counted, not averaged.
    """
    groups = runs.groupby("frequency_hz", sort=True)
    columns: dict[str, pd.Series] = {"runs": groups.size()}
    for status in Status:
        of_status = runs["status"] == str(status)
        columns[str(status)] = of_status.groupby(runs["frequency_hz"]).sum()
    own = runs[runs["repetition"] == 0].set_index("frequency_hz")
    for name in AMPLITUDES:
        columns[name] = own[name]
        columns[f"{name}_median"] = groups[name].median()
        columns[f"{name}_low"] = groups[name].min()
        columns[f"{name}_high"] = groups[name].max()
    return pd.DataFrame(columns).reset_index()
