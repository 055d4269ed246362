"""Candidates with what samples show of them by themselves, before anything is fitted."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analysis.engine.array import Array
from analysis.engine.candidate import Candidate

HANGS_NOWHERE = 0.5
"""Of how likely slack is otherwise: where no tension comes to zero, a cable that is too long is
rather one that was tightened less: both move alike."""


def as_seen(candidate: Candidate, slack: Sequence[int]) -> Candidate:
    """A candidate with what samples show of it: cables that hang slack."""
    if candidate.name != "cable_slack":
        return candidate
    shown = tuple(f"slack_m@{cable}" for cable in slack)
    return replace(candidate, shown=shown, prior=1.0 if slack else HANGS_NOWHERE)


def as_clipped(candidate: Candidate, above_n: Array) -> Candidate:
    """Clipping cells, each looked for where it shows no more: so far below what is simulated."""
    if candidate.name != "cell_saturation":
        return candidate
    terms = tuple(
        replace(one, step=float(np.clip(above, one.step, one.high)) if above < np.inf else one.step)
        for one, above in zip(candidate.terms, above_n, strict=True)
    )
    return replace(candidate, terms=terms)


def as_lost(candidate: Candidate, lost_s: Sequence[float]) -> Candidate:
    """Dropped frames, of which poses tell when they were lost: then, and at no other time.

    Parameters
    ----------
    candidate
        Dropped frames.
    lost_s
        When a frame was lost, s; not empty.
    """
    first = lost_s[0]
    # More at one moment than one number holds are lost again just then.
    most = next(round(one.high) for one in candidate.shapes if one.name == "count")
    at_once = min(sum(1 for at in lost_s if at == first), most)
    told = {"count": float(at_once), "moment": first}
    told |= {f"again_{k}_s": at for k, at in enumerate(lost_s[at_once:], start=1)}
    shapes = tuple(
        replace(one, default=told[one.name], grid=(told[one.name],), finest=0.0)
        if one.name in told
        else one
        for one in candidate.shapes
    )
    return replace(candidate, shapes=shapes)
