"""How a simulation ended: well, with a slack cable, or in a blow-up. A status, never a NaN."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from model.kernel import PLATFORM_STATES, STATES

Array = NDArray[np.float64]

PLATFORM_QUANTITIES = ("x", "y", "z", "roll", "pitch", "yaw")


class Status(StrEnum):
    """In one word."""

    OK = "ok"
    SLACK = "slack"
    BLOW_UP = "blow_up"


@dataclass(frozen=True)
class Outcome:
    """A status with which and when.

    Parameters
    ----------
    status
        In one word. Slack: some tension was clamped at zero and the run went on; blow-up: the run
        ended there.
    what
        The cable or the platform's coordinate, as a user reads it; empty where all is well.
    cable
        Number of the cable, 1 to 8; None where it is the platform.
    time_s
        When it first happened.
    slack_share
        Fraction of the outputs with a slack cable.
    """

    status: Status
    what: str = ""
    cable: int | None = None
    time_s: float | None = None
    slack_share: float = 0.0

    def sentence(self) -> str:
        """One line with the remedy."""
        if self.status is Status.OK:
            return "ok: every cable taut, nothing diverged"
        if self.status is Status.SLACK:
            return (
                f"slack: {self.what} first at {self.time_s:.3f} s, some cable in "
                f"{100 * self.slack_share:.2g} % of the outputs; tensions there are clamped at 0"
            )
        return (
            f"blow_up: {self.what} at {self.time_s:.3f} s, and the run ends there; "
            "try a shorter step (--step) or another frequency"
        )


def outcome(time_s: Array, tension_n: Array, *, culprit: int, end_s: float) -> Outcome:
    """How a run ended.

    Parameters
    ----------
    time_s, tension_n
        The outputs, shapes (n,) and (n, 8).
    culprit, end_s
        Index of the state that blew up, -1 for none, and when.
    """
    slack = tension_n <= 0.0
    rows = slack.any(axis=1)
    share = float(rows.mean()) if rows.size else 0.0
    if culprit >= 0:
        vibration = culprit - PLATFORM_STATES
        cable = vibration % CABLES + 1 if 0 <= vibration < 2 * CABLES else None
        what = f"cable {cable}" if cable else _platform_or_effect(culprit)
        return Outcome(Status.BLOW_UP, what, cable, end_s, share)
    if share > 0.0:
        first = int(rows.argmax())
        number = int(slack[first].argmax()) + 1
        return Outcome(Status.SLACK, f"cable {number}", number, float(time_s[first]), share)
    return Outcome(Status.OK)


def _platform_or_effect(culprit: int) -> str:
    if culprit >= STATES:
        return "a left-out effect's own state"
    return PLATFORM_QUANTITIES[culprit % 6]
