"""What the memory of an effect makes of the disturbance X_p0, which acts as the motion starts."""

from model.library.effect import Parameter

LET_GO = Parameter(
    "let_go_share",
    "1",
    1.0,
    0.0,
    1.0,
    "of X_p0: 1, the platform was held there and is let go; 0, it jumps there, memory behind",
    per_cable=False,
)
"""Of an effect whose states rest where the elongation is. The paper says X_p0 (Section 4.1), and
not how it came about; a wheel that has yet to follow takes a part of the energy."""
