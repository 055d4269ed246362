"""Tension against target, cable by cable, while someone turns the winches."""

from dataclasses import dataclass

from cdpr8.rigfile import Rig


@dataclass(frozen=True)
class Against:
    """One cable.

    Attributes
    ----------
    cable, tension_n, target_n
        Measured (None where no value came) and wanted.
    met
        Whether it is within the tolerance.
    """

    cable: int
    tension_n: float | None
    target_n: float
    met: bool

    def sentence(self) -> str:
        """In words, with what to do."""
        if self.tension_n is None:
            return f"cable {self.cable}: no value"
        off = self.tension_n - self.target_n
        todo = "as wanted" if self.met else "pull" if off < 0 else "let go"
        return (
            f"cable {self.cable}: {self.tension_n:7.2f} N of {self.target_n:g} N "
            f"({off:+.2f} N): {todo}"
        )


def compare(rig: Rig, tension_n: dict[int, float], tolerance_percent: float) -> list[Against]:
    """Each cable against the rig file's pretension."""
    found = []
    for number, cable in enumerate(rig.cable, start=1):
        target = float(cable.pretension_n.value)
        value = tension_n.get(number)
        met = value is not None and abs(value - target) <= tolerance_percent / 100.0 * target
        found.append(Against(number, value, target, met))
    return found


def line(rows: list[Against]) -> str:
    """All cables on one line: number, tension, and + (pull), - (let go) or = (as wanted)."""
    words = []
    for row in rows:
        if row.tension_n is None:
            words.append(f"{row.cable}: ?")
            continue
        mark = "=" if row.met else "+" if row.tension_n < row.target_n else "-"
        words.append(f"{row.cable}: {row.tension_n:.2f} {mark}")
    return "  ".join(words)
