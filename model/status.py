"""How a simulation ended: well, with a slack cable, or in a blow-up. A status, never a NaN."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from cdpr8 import CABLES
from model.kernel import PLATFORM_STATES

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
        Fraction of the steps with a slack cable.
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
                f"{100 * self.slack_share:.2g} % of the steps; tensions there are clamped at 0"
            )
        return (
            f"blow_up: {self.what} at {self.time_s:.3f} s, and the run ends there; "
            "try a shorter step (--step) or another frequency"
        )


def outcome(
    point_s: NDArray[np.float64],
    *,
    culprit: int,
    culprit_point: int,
    slack_point: int,
    slack_cable: int,
    slack_points: int,
) -> Outcome:
    """Read what the kernel returns.

    Parameters
    ----------
    point_s
        Times of the integrator's points.
    culprit, culprit_point
        Index of the state that blew up, -1 for none, and where.
    slack_point, slack_cable, slack_points
        The first point with a slack cable, its index, -1 for none, and how many there were.
    """
    share = slack_points / max(1, len(point_s) - 1)
    if culprit >= 0:
        vibration = culprit - PLATFORM_STATES
        cable = vibration % CABLES + 1 if 0 <= vibration < 2 * CABLES else None
        what = f"cable {cable}" if cable else PLATFORM_QUANTITIES[culprit % 6]
        return Outcome(Status.BLOW_UP, what, cable, float(point_s[culprit_point]), share)
    if slack_cable >= 0:
        number = slack_cable + 1
        return Outcome(Status.SLACK, f"cable {number}", number, float(point_s[slack_point]), share)
    return Outcome(Status.OK)
