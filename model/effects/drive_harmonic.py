"""The drive distorts: a harmonic of the commanded sine."""

from typing import TYPE_CHECKING

from model.library.effect import Acts, Effect, Parameter

if TYPE_CHECKING:
    from model.motion import Motion


def command(
    motion: "Motion", harmonic_share: float, order: float, harmonic_phase_rad: float
) -> "Motion":
    """X* + e A w sin(n 2 pi f tau + phi), about the same axis; other motions have no harmonic."""
    from model.altered import Distorted

    return Distorted(motion, harmonic_share, round(order), harmonic_phase_rad)


EFFECT = Effect(
    name="drive_harmonic",
    title="harmonic of the drive",
    acts=Acts.DRIVE,
    equation="X* + e A w(tau) sin(2 pi n f tau + phi)",
    source="design, section 4",
    signature="a line at n f in pose and in every cable through the Jacobian",
    parameters=(
        Parameter("harmonic_share", "1", 0.02, -0.2, 0.2, "e", False, True),
        Parameter("order", "1", 2.0, 2.0, 5.0, "n, rounded to a whole number", False),
        Parameter("harmonic_phase_rad", "rad", 0.0, -3.1416, 3.1416, "phi", False),
    ),
    command=command,
)
