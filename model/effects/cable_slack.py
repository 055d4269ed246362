"""A cable with length to spare: it pulls late, and not at all when it hangs slack."""

from dataclasses import replace
from typing import Any

from model.library.effect import Acts, Effect, Parameter
from model.library.smooth import smooth_positive


def reckoned(machine: Any, drive_pushes: Any) -> Any:
    """A drive made for cables that push where they would have to."""
    return replace(machine, least_pull=-float("inf")) if round(drive_pushes) else machine


def pull(slack_m: Any, switch_n: Any, elastic: Any, stiffness: Any) -> Any:
    """max(0, T - k d) - T, the corner rounded over w; nothing for d = 0."""
    width = switch_n * slack_m / (slack_m + 1e-12)
    return smooth_positive(elastic - stiffness * slack_m, width) - smooth_positive(elastic, 0.0)


EFFECT = Effect(
    name="cable_slack",
    title="slack of the cable",
    acts=Acts.CABLE,
    equation="T = max(0, T - k d), the corner rounded over w",
    source="unilateral spring; Pott, Cable-Driven Parallel Robots (2018), Section 3.2",
    signature="mean tension lost, a flat bottom at zero, strong even harmonics, in this cable only",
    parameters=(
        Parameter("slack_m", "m", 2e-3, 0.0, 2e-2, "d", magnitude=True),
        Parameter("switch_n", "N", 1e-4, 1e-5, 1.0, "w"),
        Parameter(
            "drive_pushes", "1", 1.0, 0.0, 1.0,
            "whether the drive reckons with T_0 + k dL below zero", False,
        ),
    ),
    pull=pull,
    reckoned=reckoned,
    longest_step_s=1.6e-3,
    cost="twice the steps",
)  # fmt: skip
