"""The settings of a simulated node: ranges, widths of answers, factory values (section 4)."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Register:
    """One setting.

    Attributes
    ----------
    width
        Characters of its answer.
    low, high
        What it takes.
    factory
        Its value after TDD0.
    locked
        Whether it takes a password.
    """

    width: int
    low: int
    high: int
    factory: int
    locked: bool = False


REGISTERS = {
    "ADR": Register(2, 0, 31, 31),
    "COF": Register(3, 0, 255, 9),
    "TEX": Register(3, 0, 255, 172),
    "CSM": Register(1, 0, 1, 0),
    "ICR": Register(1, 0, 7, 0),
    "ASF": Register(2, 0, 10, 5),
    "FMD": Register(1, 0, 1, 0),
    "NOV": Register(7, 0, 1599999, 0, locked=True),
    "LDW": Register(8, -1599999, 1599999, 0, locked=True),
    "LWT": Register(8, -1599999, 1599999, 1_000_000, locked=True),
    "CWT": Register(8, 0, 1599999, 1_000_000, locked=True),
    "RSN": Register(3, 1, 100, 1),
    "TAS": Register(1, 0, 1, 1),
    "TAV": Register(8, -8388607, 8388607, 0),
    "ZSE": Register(1, 0, 4, 0),
    "ZTR": Register(1, 0, 1, 0),
    "MTD": Register(1, 0, 5, 0),
    "STR": Register(1, 0, 1, 0),
    "CRC": Register(8, -8388607, 8388607, 0),
}

CURVE = ("LDW", "LWT")
"""The user's characteristic curve: where it is 0 and where 1 000 000."""

LINEARISATION = {"LIC0": 0, "LIC1": 1_000_000, "LIC2": 0, "LIC3": 0}
"""Coefficients of the powers 0 to 3, in millionths, and their factory values."""

TRIGGER = {"TRC0": 0, "TRC1": 0, "TRC2": 0, "TRC3": 0, "TRC4": 0}
"""Parameters of the trigger: active, mode, level and two times (widths as a FIT answers)."""

TRIGGER_WIDTHS = (1, 1, 8, 2, 2)

FACTORY_BAUD = 9600
FACTORY_PARITY = 1


def factory_settings() -> dict[str, int]:
    """All settings as a node leaves the factory, with its line (BAUD, PARITY)."""
    settings = {name: register.factory for name, register in REGISTERS.items()}
    return settings | LINEARISATION | TRIGGER | {"BAUD": FACTORY_BAUD, "PARITY": FACTORY_PARITY}
