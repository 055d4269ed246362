"""From digits to newtons, on the host: the electronics keep their factory curve (section 6)."""

from dataclasses import dataclass

from cdpr8.rigfile.schema import Amplifier
from rig.amplifier.frame import ValueFormat

OVERLOAD_FACTOR = 1.2
"""Host's own limit in nominal forces: the electronics flag a 1 mV/V cell at 2.5 times only."""

FINE_DIGITS = 100_000
"""With so many digits in its range a live cell never gives one value for half a second."""


@dataclass(frozen=True)
class Scaling:
    """F = sign F_nom (u - u_0) / C with u = digits / digits_per_mv_per_v.

    Attributes
    ----------
    nominal_force_n
        F_nom.
    sensitivity_mv_per_v
        C of the certificate: the cell's signal at its nominal force.
    sign
        1, or -1 where the cell gives tension as negative.
    digits_per_mv_per_v
        Of the format, at NOV=0.
    zero_mv_per_v
        u_0, measured and kept by the host.
    """

    nominal_force_n: float
    sensitivity_mv_per_v: float
    sign: int
    digits_per_mv_per_v: int
    zero_mv_per_v: float = 0.0

    @classmethod
    def of(
        cls, amplifier: Amplifier, format_: ValueFormat, zero_mv_per_v: float = 0.0
    ) -> "Scaling":
        """The scaling of one cable's cell as the rig file has it."""
        return cls(
            amplifier.nominal_force_n,
            amplifier.sensitivity_mv_per_v,
            amplifier.sign,
            format_.digits_per_mv_per_v,
            zero_mv_per_v,
        )

    def tension_n(self, digits: int) -> float:
        """Tension in N; positive pulls."""
        signal = digits / self.digits_per_mv_per_v - self.zero_mv_per_v
        return self.sign * self.nominal_force_n * signal / self.sensitivity_mv_per_v

    def digits(self, tension_n: float) -> float:
        """The digits, not rounded, that an amplifier gives for a tension: the inverse."""
        signal = self.sign * tension_n * self.sensitivity_mv_per_v / self.nominal_force_n
        return (signal + self.zero_mv_per_v) * self.digits_per_mv_per_v

    @property
    def fine(self) -> bool:
        """Whether noise always turns the last digit: not where 2 bytes hold the value."""
        return self.digits_per_mv_per_v * self.sensitivity_mv_per_v >= FINE_DIGITS

    def overloaded(self, tension_n: float) -> bool:
        """Whether the cell is loaded beyond what the host allows, in either direction."""
        return abs(tension_n) > OVERLOAD_FACTOR * self.nominal_force_n
