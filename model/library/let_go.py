"""What the memory of an effect makes of what the platform gains at once as the motion starts."""

from model.library.effect import Parameter

LET_GO = Parameter(
    "let_go_share",
    "1",
    1.0,
    0.0,
    1.0,
    "of X_p0, X*'(0): 1, the machine was held there, moved so; 0, it jumps, memory behind",
    per_cable=False,
)
"""Of an effect whose states rest where the elongation is. The paper says X_p0 (Section 4.1) and a
start in the commanded state, and not how they came about; a wheel that has yet to follow takes a
part of the energy."""
