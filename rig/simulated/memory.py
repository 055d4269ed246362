"""What a simulated amplifier remembers: its settings, their EEPROM copy, lock and error status."""

from collections.abc import Mapping
from dataclasses import dataclass

from rig.amplifier.frame import BINARY_BASES, BUS_MODE
from rig.amplifier.message import ACCEPTED, LINE_END, REFUSED
from rig.amplifier.node import PASSWORD
from rig.amplifier.profile import Profile
from rig.simulated.registers import (
    CURVE,
    LINEARISATION,
    REGISTERS,
    TRIGGER,
    TRIGGER_WIDTHS,
    factory_settings,
)

COMMAND_S = 0.002
"""Answer time of ordinary commands; documented is "below 15 ms"."""

EXECUTION_ERROR = 16
COMMAND_ERROR = 32


@dataclass(frozen=True, slots=True)
class Answer:
    """What a node sends, and how long after the request its first bit starts."""

    data: bytes
    delay_s: float


class NodeMemory:
    """The settings of one node, asked for and written (protocol note, section 4).

    Parameters
    ----------
    profile
        Its dialect.
    serial_number
        On its label.
    settings
        In its EEPROM.
    """

    def __init__(self, profile: Profile, serial_number: str, settings: Mapping[str, int]) -> None:
        self.profile = profile
        self.serial_number = serial_number
        self._eeprom = dict(settings)
        self.reload()

    def reload(self) -> None:
        """Start from the EEPROM: locked, no errors."""
        self.settings = dict(self._eeprom)
        self._unlocked = False
        self._errors = 0

    def _show(self, name: str) -> Answer:
        value, width = self.settings[name], REGISTERS[name].width
        return Answer(f"{value:0{width}d}\r\n".encode(), COMMAND_S)

    def _write(self, name: str, parameters: str) -> Answer:
        register = REGISTERS[name]
        words = parameters.split(",", 1)
        try:
            value = int(float(words[0]))
        except ValueError:
            return self._refuse(COMMAND_ERROR)
        high = register.high
        if name == "ASF":
            high = len(self.profile.cut_offs_hz) - 1
        bus_mode_text = name == "COF" and value & BUS_MODE and value % BUS_MODE not in BINARY_BASES
        locked = register.locked and not self._unlocked
        if not register.low <= value <= high or bus_mode_text or locked:
            return self._refuse(EXECUTION_ERROR)
        if name == "ADR" and len(words) > 1 and words[1].strip('"') != self.serial_number:
            return self._refuse(EXECUTION_ERROR)
        self.settings[name] = value
        if name in CURVE:
            self.settings["TAV"] = 0
        return Answer(ACCEPTED, COMMAND_S)

    def _lic(self, asked: bool, parameters: str, _: float) -> Answer:
        if asked:
            words = (f"{self.settings[name]:08d}" for name in LINEARISATION)
            return Answer(",".join(words).encode() + LINE_END, COMMAND_S)
        return self._write_part(LINEARISATION, parameters, locked=not self._unlocked)

    def _trc(self, asked: bool, parameters: str, _: float) -> Answer:
        if asked:
            values = zip(TRIGGER, TRIGGER_WIDTHS, strict=True)
            words = (f"{self.settings[name]:0{width}d}" for name, width in values)
            return Answer(",".join(words).encode() + LINE_END, COMMAND_S)
        try:
            numbers = [int(word) for word in parameters.split(",")]
        except ValueError:
            return self._refuse(COMMAND_ERROR)
        self.settings.update(zip(TRIGGER, numbers, strict=False))
        return Answer(ACCEPTED, COMMAND_S)

    def _write_part(self, names: Mapping[str, int], parameters: str, *, locked: bool) -> Answer:
        """One of several numbers of a setting: its index and its value."""
        try:
            index, value = (int(word) for word in parameters.split(","))
        except ValueError:
            return self._refuse(COMMAND_ERROR)
        if locked or not 0 <= index < len(names):
            return self._refuse(EXECUTION_ERROR)
        self.settings[tuple(names)[index]] = value
        return Answer(ACCEPTED, COMMAND_S)

    def _bdr(self, asked: bool, parameters: str, _: float) -> Answer:
        settings = self.settings
        if not asked:
            try:
                baud, parity = (int(word) for word in parameters.split(","))
            except ValueError:
                return self._refuse(COMMAND_ERROR)
            if baud not in self.profile.bauds or parity not in (0, 1):
                return self._refuse(EXECUTION_ERROR)
            settings["BAUD"], settings["PARITY"] = baud, parity
            return Answer(ACCEPTED, COMMAND_S)
        return Answer(f"{settings['BAUD']},{settings['PARITY']}\r\n".encode(), COMMAND_S)

    def _spw(self, _: bool, parameters: str, __: float) -> Answer:
        self._unlocked = parameters.strip('"') == PASSWORD
        return Answer(ACCEPTED, COMMAND_S) if self._unlocked else self._refuse(EXECUTION_ERROR)

    def _tdd(self, _: bool, parameters: str, __: float) -> Answer:
        line = {name: self.settings[name] for name in ("BAUD", "PARITY")}
        if parameters == "0":
            self.settings = factory_settings() | line
        elif parameters == "1":
            self._eeprom = dict(self.settings)
        elif parameters == "2":
            self.settings = dict(self._eeprom) | line
        else:
            return self._refuse(EXECUTION_ERROR)
        return Answer(ACCEPTED, COMMAND_S)

    def _esr(self, _: bool, __: str, ___: float) -> Answer:
        errors, self._errors = self._errors, 0
        return Answer(f"{errors:03d}\r\n".encode(), COMMAND_S)

    def _refuse(self, error: int) -> Answer:
        self._errors |= error
        return Answer(REFUSED, COMMAND_S)
