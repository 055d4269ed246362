"""The health of a recorded command log."""

from collections.abc import Iterator

import numpy as np

from cdpr8.runfolder import Run
from rig.finding import Finding, Verdict

MOST_LOG_RATE_ERROR = 0.1
"""A command log that is tied by arrival, over a second or more, is no farther off than this."""


def command_log(run: Run) -> Iterator[Finding]:
    """Its rows, rate, lateness, what was lost of it, and whether its clock counts seconds."""
    if run.command is None:
        return
    rows = run.command
    times = np.unique(rows["t_s"].to_numpy(dtype=float))
    if len(times) < 3:
        yield Finding(Verdict.WARN, "command", f"{len(rows)} rows of the winch controller")
        return
    steps = np.diff(times)
    words = (
        f"{len(rows)} rows of {rows['cable'].nunique()} cables, "
        f"{1.0 / float(np.median(steps)):.1f}/s, the longest gap {steps.max():.3f} s"
    )
    # What was written while the amplifiers were being set up comes at once when the run begins.
    rows = rows[~(rows["arrived_s"] <= rows["arrived_s"].min())]
    late_s = (rows["arrived_s"] - rows["t_s"]).dropna()
    if len(late_s):
        words += f", noticed up to {1e3 * float(late_s.max()):.0f} ms late"
    lost = {} if run.stop is None else run.stop.lost
    timed = rows[["log_s", "arrived_s"]].dropna().to_numpy(dtype=float)
    if len(timed) > 2 and np.ptp(timed[:, 0]) > 0.0 and np.ptp(timed[:, 1]) > 1.0:
        rate = float(np.ptp(timed[:, 0]) / np.ptp(timed[:, 1]))
        if abs(rate - 1.0) > MOST_LOG_RATE_ERROR:
            words += f"; its clock runs {rate:.4g} times as fast as the run's: is it in s?"
            yield Finding(Verdict.FAIL, "command", words)
            return
    unread, gone = lost.get("command_line", 0), lost.get("command_log_lost", 0)
    if unread or gone:
        words += f", {unread} lines not understood, {gone} times gone"
    yield Finding(Verdict.WARN if unread or gone else Verdict.OK, "command", words)
