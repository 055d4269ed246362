"""A cable with length to spare: it pulls late, and not at all when it hangs slack."""

from typing import Any

from model.library.effect import Acts, Effect, Parameter
from model.library.smooth import smooth_positive


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
        Parameter("switch_n", "N", 0.05, 1e-3, 1.0, "w"),
    ),
    pull=pull,
    longest_step_s=1.6e-3,
    cost="a tension of w/2 is left where the cable just hangs; twice the steps",
)
