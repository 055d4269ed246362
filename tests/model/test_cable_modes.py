"""What further modes of a cable lose: to the air, or beside the line on which they hang."""

import numpy as np
import pytest

from model.effects import library
from tests.model.harness import call

EFFECT = library()["cable_modes"]
NAMES = [state.name for state in EFFECT.states]
NUMBERS = {"v2": 2, "v3": 3, "v4": 4, "h1": 1, "h2": 2, "h3": 3, "h4": 4}
LOSS_PER_S = 4.0


def rates(numbers: dict, anchor_velocity: np.ndarray, own: dict | None = None) -> dict:
    """Of all states of a cable along x, straight where `own` says nothing."""
    now = dict.fromkeys(NAMES, 0.0) | (own or {})
    now |= {f"direction_{axis}": float(axis == "x") for axis in "xyz"}
    now |= {f"anchor_velocity_{axis}": v for axis, v in zip("xyz", anchor_velocity, strict=True)}
    now |= {"tension": 12.0, "length": 1.7, "line_density": 9e-3, "axial_velocity": 0.0}
    now |= {"damping": LOSS_PER_S, **numbers}
    return dict(zip(NAMES, call(EFFECT.rates, now), strict=True))


def test_air_slows_a_cable_and_not_the_line_that_its_anchor_sweeps() -> None:
    moves = np.array([0.0, 0.3, -0.2])
    in_air = rates({"line_loss_share": 0.0, "loss_growth": 0.0}, moves)
    beside = rates({"line_loss_share": 1.0, "loss_growth": 0.0}, moves)
    for name in NUMBERS:
        # The shape leaves the line as fast as the line leaves it, and a cable at rest stays there.
        assert abs(in_air[name]) > 0.01
        assert in_air[f"{name}_rate"] == 0.0
        assert beside[f"{name}_rate"] == pytest.approx(-LOSS_PER_S * beside[name])


@pytest.mark.parametrize("growth", [0.0, 0.25, 1.0])
def test_a_higher_mode_may_lose_more(growth: float) -> None:
    own = {f"{name}_rate": 0.1 for name in NUMBERS}
    found = rates({"line_loss_share": 1.0, "loss_growth": growth}, np.zeros(3), own)
    for name, number in NUMBERS.items():
        lost = -LOSS_PER_S * (1.0 + growth * (number - 1)) * 0.1
        assert found[f"{name}_rate"] == pytest.approx(lost)
