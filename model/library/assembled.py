"""The functions of `model.library.assembly`, ready to be called or compiled."""

from collections.abc import Callable
from typing import Any

from model.kinematics import Vector
from model.library import assembly

TEXT = assembly.text()

RATED = assembly.rated()
"""Bits of the effects that `cable_rates` has something to do for."""

_functions: dict[str, Any] = {
    "__name__": __name__,
    **assembly.laws(),
}
exec(compile(TEXT, "<laws of model.effects>", "exec"), _functions)

cable_pull: Callable[..., tuple[float, float]] = _functions["cable_pull"]
cable_rates: Callable[..., Vector] = _functions["cable_rates"]
platform_wrench: Callable[..., Any] = _functions["platform_wrench"]
lane_pull: Callable[..., None] = _functions["lane_pull"]
lane_rates: Callable[..., None] = _functions["lane_rates"]
lane_wrench: Callable[..., None] = _functions["lane_wrench"]
