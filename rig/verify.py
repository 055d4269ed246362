"""The health of a recorded run: rates, gaps, skew, jitter, overloads, stuck values, clocks."""

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from cdpr8 import CABLES
from cdpr8.runfolder import UNKNOWN, EventKind, FrameFlag, Run, TensionStatus
from rig.amplifier.profile import Identity
from rig.concerns import by_cables, of_unknown_types
from rig.finding import Finding, Verdict
from rig.outcome import REASONS, in_words
from rig.verify_command import command_log

if TYPE_CHECKING:
    import pandas as pd

GAP_INTERVALS = 5.0
"""An interval longer than this many median ones is a gap."""

MOST_LOST = 0.01
MOST_DRIFT_PPM = 200.0
CLOCK_STEP_S = 0.1


def verify(run: Run) -> list[Finding]:
    """Look at everything that can be told from the run folder."""
    return [
        *_ending(run),
        *_cables(run),
        *_skew(run),
        *_amplifiers(run),
        *_filter(run),
        *_losses(run),
        *_overloads(run),
        *_frames(run),
        *command_log(run),
        *_clocks(run),
    ]


def _ending(run: Run) -> Iterator[Finding]:
    if run.stop is None:
        yield Finding(Verdict.WARN, "ending", "no stop record: interrupted; what came is there")
    else:
        fault = run.stop.reason in ("device", "disk_full")
        words = f"{run.stop.t_s:.1f} s, ended by {REASONS[run.stop.reason]}"
        yield Finding(Verdict.FAIL if fault else Verdict.OK, "ending", words)
    for words in run.notes:
        if "stop.json" not in words:
            yield Finding(Verdict.WARN, "files", words)


def _cables(run: Run) -> Iterator[Finding]:
    end_s = _end_s(run)
    for cable in range(1, CABLES + 1):
        times = run.cable_tension(cable)["t_s"].to_numpy(dtype=float)
        if not len(times) and run.start.import_map is not None:
            yield Finding(Verdict.WARN, f"cable {cable}", "not in the imported table")
            continue
        if len(times) < 3:
            yield Finding(Verdict.FAIL, f"cable {cable}", f"{len(times)} good values")
            continue
        usual = float(np.median(np.diff(times)))
        # Silence at the beginning and at the end is missing as well.
        steps = np.diff(times, prepend=min(0.0, times[0]), append=max(end_s, times[-1]))
        gaps = steps[steps > GAP_INTERVALS * usual]
        stuck = _flagged(run, cable, TensionStatus.STALE)
        inner = np.diff(times)
        words = (
            f"{len(times) / float(steps.sum()):.1f}/s, usual interval {1e3 * usual:.2f} ms, "
            f"jitter {1e3 * float(np.std(inner[inner <= GAP_INTERVALS * usual])):.2f} ms"
        )
        if len(gaps):
            words += f", gaps: {len(gaps)}, the longest {gaps.max():.3f} s"
        if steps[-1] > GAP_INTERVALS * usual:
            words += f": none good from {times[-1]:.3f} s to the end"
        if stuck:
            words += f", stuck values: {stuck}"
        missing = float(gaps.sum()) / float(steps.sum())
        verdict = Verdict.OK
        if len(gaps) or stuck:
            verdict = Verdict.FAIL if missing > MOST_LOST or stuck else Verdict.WARN
        yield Finding(verdict, f"cable {cable}", words)


def _end_s(run: Run) -> float:
    """Until when values were due, in s of the run.

    The stop record comes later than that, by what the streams took to end.
    """
    told = run.events[~run.events["kind"].isin(_LAST_WORDS)]
    ends_s = [float(table["t_s"].max()) for table in (run.tension, told) if len(table)]
    newest_s = max(ends_s, default=0.0)
    if run.stop is None or run.stop.reason != "duration":
        return newest_s
    return max(newest_s, min(run.stop.t_s, run.start.excitation.duration_s))


_LAST_WORDS = (EventKind.INTERRUPTED.value, EventKind.DISK_FULL.value)
"""Events of the ending."""


def _skew(run: Run) -> Iterator[Finding]:
    first = run.cable_tension(1)["t_s"].to_numpy(dtype=float)
    if len(first) < 3:
        return
    spread = 0.0
    for cable in range(2, CABLES + 1):
        times = run.cable_tension(cable)["t_s"].to_numpy(dtype=float)
        if len(times) < 3:
            continue
        # Of sweeps in which both gave values.
        both = first[(first >= times[0]) & (first <= times[-1])]
        if not len(both):
            continue
        after = np.clip(np.searchsorted(times, both), 1, len(times) - 1)
        nearest = np.minimum(np.abs(times[after] - both), np.abs(times[after - 1] - both))
        spread = max(spread, float(np.median(nearest)))
    words = f"values of one sweep lie up to {1e3 * spread:.2f} ms apart; each has its own time"
    if run.start.sweep == "broadcast":
        period_s = max((node.output_period_s or 0.0 for node in run.start.nodes), default=0.0)
        words = f"triggered together: one time a sweep, measured within {1e3 * period_s:.2f} ms"
    yield Finding(Verdict.OK, "skew", words)


def _amplifiers(run: Run) -> Iterator[Finding]:
    """Which are of unknown type, and what all do to their digits themselves, as they answered."""
    asked = [node for node in run.start.nodes if node.found]
    if not asked:
        return
    told = of_unknown_types(
        (node.cable, Identity.parse(node.identity.encode()).type, node.output_period_s or 0.0)
        for node in asked
        if node.profile == UNKNOWN
    )
    told += by_cables((node.cable, node.settings, node.found) for node in asked)
    words = "; ".join(told) or "digits at the factory's curve, no tare in them"
    yield Finding(Verdict.WARN if told else Verdict.OK, "amplifiers", words)


def _filter(run: Run) -> Iterator[Finding]:
    """The delay that is taken off where the run is read, and where it comes from."""
    unknown = [str(node.cable) for node in run.start.nodes if node.filter_delay_from == UNKNOWN]
    if unknown:
        words = f"cable {', '.join(unknown)}: not known, and not taken off where the run is read"
        yield Finding(Verdict.WARN, "delay", words)
    told: dict[str, list[str]] = {}
    for node in run.start.nodes:
        if node.filter_delay_s is not None and node.filter_delay_from is not None:
            words = f"{1e3 * node.filter_delay_s:.2f}"
            if node.filter_delay_sigma_s is not None:
                words += f" ± {1e3 * node.filter_delay_sigma_s:.2f}"
            told.setdefault(f"{words} ms, {node.filter_delay_from}", []).append(str(node.cable))
    if told:
        alike = len(told) == 1 and not unknown
        words = "; ".join(
            each if alike else f"cable {', '.join(cables)}: {each}" for each, cables in told.items()
        )
        yield Finding(Verdict.OK, "delay", f"{words}; taken off where the run is read")


def _losses(run: Run) -> Iterator[Finding]:
    counts = Counter(run.events["kind"].astype(str))
    lost = dict(run.stop.lost) if run.stop is not None else {}
    for kind in (EventKind.BAD_FRAME, EventKind.NODE_LOST, EventKind.LINE_LOST, EventKind.PAUSE):
        if kind.value not in lost and counts[kind.value]:
            lost[kind.value] = counts[kind.value]
    total = sum(count for what, count in lost.items() if what not in ("flagged", "untimed"))
    share = total / max(1, len(run.tension))
    words = in_words(lost)
    if lost.get("untimed", 0) > MOST_LOST * len(run.tension):
        words += "; the computer was busy, or an adapter holds answers up (`rig doctor`)"
    verdict = Verdict.OK if not lost else Verdict.FAIL if share > MOST_LOST else Verdict.WARN
    yield Finding(verdict, "lost", words)


def _overloads(run: Run) -> Iterator[Finding]:
    over = [
        cable
        for cable in range(1, CABLES + 1)
        if _flagged(run, cable, TensionStatus.HOST_OVERLOAD | TensionStatus.ADC_OVERFLOW)
    ]
    if over:
        words = f"cables {', '.join(map(str, over))}: check the cells' zeros before the next run"
        yield Finding(Verdict.FAIL, "overload", words)
    else:
        yield Finding(Verdict.OK, "overload", "none")


def _frames(run: Run) -> Iterator[Finding]:
    if run.start.camera is None:
        return
    frames = run.frames
    if len(frames) < 2:
        yield Finding(Verdict.FAIL, "video", f"{len(frames)} frames")
        return
    steps = np.diff(frames["t_s"].to_numpy(dtype=float))
    flags = frames["flags"].to_numpy(dtype=int)
    dropped = int((flags & FrameFlag.DROPPED_BEFORE > 0).sum())
    repeated = int((flags & FrameFlag.REPEATED > 0).sum())
    words = (
        f"{len(frames)} frames, {1.0 / float(np.median(steps)):.2f}/s, "
        f"jitter {1e3 * float(np.std(steps)):.2f} ms"
    )
    if dropped or repeated:
        words += f", {dropped} after a dropped one, {repeated} repeated"
    yield Finding(Verdict.WARN if dropped or repeated else Verdict.OK, "video", words)


def _clocks(run: Run) -> Iterator[Finding]:
    anchors = [(run.start.clock_anchor.t_s, run.start.clock_anchor.wall.timestamp())]
    noted, unreadable = _anchors(run.events)
    anchors += noted
    if unreadable:
        yield Finding(
            Verdict.WARN, "files", f"events.csv: a clock_anchor is no date: {unreadable[0]!r}"
        )
    if run.stop is not None:
        anchors.append((run.stop.clock_anchor.t_s, run.stop.clock_anchor.wall.timestamp()))
    run_s, wall_s = np.array(anchors).T
    off_s = (wall_s - wall_s[0]) - (run_s - run_s[0])
    steps = np.abs(np.diff(off_s))
    if len(steps) and steps.max() > CLOCK_STEP_S:
        words = f"the wall clock was stepped by {steps.max():.2f} s; times of the run are not moved"
        yield Finding(Verdict.WARN, "clock", words)
    elif run_s[-1] - run_s[0] >= 60.0:
        ppm = 1e6 * float(np.polyfit(run_s, off_s, 1)[0])
        verdict = Verdict.OK if abs(ppm) < MOST_DRIFT_PPM else Verdict.WARN
        yield Finding(verdict, "clock", f"wall against run {ppm:+.1f} ppm")
    else:
        yield Finding(Verdict.OK, "clock", "no step (a run of 60 s also tells the drift)")


def _anchors(events: "pd.DataFrame") -> tuple[list[tuple[float, float]], list[str]]:
    """Times of the run with their wall times in s, and what stands where a date should."""
    from datetime import datetime

    found, unreadable = [], []
    if len(events):
        rows = events[events["kind"] == EventKind.CLOCK_ANCHOR.value]
        for t_s, words in zip(rows["t_s"], rows["detail"], strict=True):
            try:
                found.append((float(t_s), datetime.fromisoformat(str(words)).timestamp()))
            except ValueError:
                unreadable.append(str(words))
    return found, unreadable


def _flagged(run: Run, cable: int, bits: TensionStatus) -> int:
    rows = run.tension["cable"] == cable
    return int(((run.tension["status"][rows].to_numpy(dtype=int) & int(bits)) != 0).sum())
