"""One simulated amplifier: the AED node as a state machine (protocol note, sections 2 to 7)."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from rig.amplifier.frame import (
    BINARY_BASES,
    BUS_MODE,
    DIGITS_PER_MV_PER_V,
    POWER_ON_STREAM,
    WITHOUT_CRLF,
    FrameFormat,
)
from rig.amplifier.message import ACCEPTED, BROADCAST, REFUSED
from rig.amplifier.node import PASSWORD
from rig.amplifier.profile import FIT, Profile
from rig.amplifier.text_frame import DIGITS_PER_MV_PER_V as TEXT_DIGITS_PER_MV_PER_V
from rig.amplifier.text_frame import TextFormat, formats_of
from rig.simulated.registers import REGISTERS, factory_settings
from rig.simulated.signal import NodeSignal

COMMAND_S = 0.002
"""Answer time of ordinary commands; documented is "below 15 ms"."""

TURNAROUND_S = 20e-6
"""From the end of a request to the start of a value in bus mode."""

RESTART_S = 2.0
"""How long a node is deaf after RES."""

TEXT_PER_DIGIT = TEXT_DIGITS_PER_MV_PER_V / DIGITS_PER_MV_PER_V[4]
TEXT_SEPARATORS_FROM = 128

_COMMAND = re.compile(r'([A-Z]{3})(\?)?([^"]*(?:"[^"]*")?)$')

_EXECUTION_ERROR = 16
_COMMAND_ERROR = 32


class Selection(Enum):
    """Who a node takes the next command to be for."""

    OTHER = "another node"
    THIS = "this node"
    ALL = "all nodes: obey, do not answer"


@dataclass(frozen=True, slots=True)
class Answer:
    """What a node sends, and how long after the request its first bit starts."""

    data: bytes
    delay_s: float


class SimulatedNode:
    """One node.

    Parameters
    ----------
    signal
        Its cell and converter.
    address, serial_number
        As stored in its EEPROM and on its label.
    baud, parity
        As stored in its EEPROM; parity 0 none, 1 even.
    profile, type_name
        Its dialect and what it says in `IDN?`.
    crlf_in_bus_mode
        Whether binary values in bus mode carry CR LF: real ones differ.
    crlf_in_stream
        The same under `MSV?0;`.
    """

    def __init__(
        self,
        signal: NodeSignal,
        address: int,
        serial_number: str,
        *,
        baud: int = 115200,
        parity: int = 1,
        profile: Profile = FIT,
        type_name: str = "FIT/5",
        crlf_in_bus_mode: bool = True,
        crlf_in_stream: bool = True,
    ) -> None:
        self.signal = signal
        self.profile = profile
        self.serial_number = serial_number
        self.powered = True
        self._type_name = type_name
        self._crlf_in_bus_mode = crlf_in_bus_mode
        self._crlf_in_stream = crlf_in_stream
        self._eeprom = factory_settings() | {"ADR": address, "BAUD": baud, "PARITY": parity}
        self.power_on(0.0)

    def power_on(self, ready_s: float) -> None:
        """Start from the EEPROM; deaf until `ready_s`."""
        self.settings = dict(self._eeprom)
        self.measuring = False
        self.remaining = 0
        self._unlocked = False
        self._errors = 0
        self._ready_s = ready_s
        # A node is active as if selected, unless it streams from power-on (section 3).
        streams = self.settings["COF"] >= POWER_ON_STREAM
        self._selection = Selection.OTHER if streams else Selection.THIS
        self._last_number = -1
        if streams:
            self._measure(None, ready_s)

    def brown_out(self, now_s: float) -> None:
        """Lose the supply for a moment: factory settings, as after a worn-out EEPROM."""
        self._eeprom = factory_settings()
        self.power_on(now_s)

    def hears(self, baud: int, parity: int, now_s: float) -> bool:
        """Whether it understands a line of these settings now."""
        ours = (self.settings["BAUD"], self.settings["PARITY"])
        return self.powered and now_s >= self._ready_s and ours == (baud, parity)

    @property
    def in_bus_mode(self) -> bool:
        """Whether `Sxx;` is answered with the newest value."""
        return bool(self.settings["COF"] & BUS_MODE) and self.measuring

    @property
    def streaming(self) -> bool:
        """Whether it sends values unasked."""
        return self.measuring and not self.settings["COF"] & BUS_MODE

    def select(self, address: int, now_s: float) -> Answer | None:
        """Take `Sxx;`."""
        if address == BROADCAST:
            self._selection = Selection.ALL
            return None
        mine = address == self.settings["ADR"]
        self._selection = Selection.THIS if mine else Selection.OTHER
        if mine and self.in_bus_mode:
            number = self.signal.number_at(now_s + TURNAROUND_S, self.settings["ICR"])
            return Answer(self.frame(number), TURNAROUND_S)
        return None

    def obey(self, text: str, now_s: float) -> Answer | None:
        """Take one command other than S, without its terminator."""
        if self._selection is Selection.OTHER:
            return None
        answer = self._execute(text, now_s)
        return answer if self._selection is Selection.THIS else None

    def frame(self, number: int) -> bytes:
        """A measured value in the format that is set."""
        settings = self.settings
        digits, status = self.signal.value(number, settings["ICR"], settings["ASF"])
        if settings["TAS"] == 0:
            digits -= settings["TAV"]
        if settings["NOV"]:
            digits = round(digits * settings["NOV"] / (2 * DIGITS_PER_MV_PER_V[4]))
        cof = settings["COF"]
        base = cof % BUS_MODE
        if base not in BINARY_BASES:
            return self._text(digits, status)
        if cof & BUS_MODE:
            crlf = self._crlf_in_bus_mode
        else:
            crlf = self._crlf_in_stream or not self.measuring
        crlf = crlf and not cof & WITHOUT_CRLF
        format_ = FrameFormat.of_output_format(cof, settings["CSM"], crlf)
        if format_.data_bytes == 2 and settings["NOV"] == 0:
            digits >>= 8
        limit = format_.full_scale
        return format_.encode(max(-limit - 1, min(limit, digits)), status)

    def next_streamed(self) -> tuple[float, bytes]:
        """Time and bytes of the next value sent unasked."""
        icr = self.settings["ICR"]
        number = self._last_number + 1
        return self.signal.sampled_s(number, icr), self.frame(number)

    def streamed(self) -> None:
        """That value is on its way."""
        self._last_number += 1
        if self.remaining:
            self.remaining -= 1
            self.measuring = self.remaining > 0

    def _execute(self, text: str, now_s: float) -> Answer | None:
        match = _COMMAND.match(text)
        if match is None:
            return self._refuse(_COMMAND_ERROR)
        name, asked, parameters = match.groups()
        if name in REGISTERS:
            return self._show(name) if asked else self._write(name, parameters)
        if name not in _METHODS:
            return self._refuse(_COMMAND_ERROR)
        method: Callable[[bool, str, float], Answer | None] = getattr(self, f"_{name.lower()}")
        return method(bool(asked), parameters, now_s)

    def _stp(self, _: bool, __: str, ___: float) -> None:
        self.measuring = False

    def _res(self, _: bool, __: str, now_s: float) -> None:
        self.power_on(now_s + RESTART_S)

    def _msv(self, asked: bool, parameters: str, now_s: float) -> Answer | None:
        if not asked:
            return self._refuse(_COMMAND_ERROR)
        return self._measure(parameters or None, now_s)

    def _measure(self, count: str | None, now_s: float) -> Answer | None:
        icr = self.settings["ICR"]
        self._last_number = self.signal.number_at(now_s, icr)
        if count is None and not self.settings["COF"] & BUS_MODE:
            number = self._last_number + 1
            return Answer(self.frame(number), max(0.0, self.signal.sampled_s(number, icr) - now_s))
        if count is not None and not count.isdecimal():
            return self._refuse(_EXECUTION_ERROR)
        self.remaining = int(count or 0)
        self.measuring = True
        return None

    def _show(self, name: str) -> Answer:
        value, width = self.settings[name], REGISTERS[name].width
        return Answer(f"{value:0{width}d}\r\n".encode(), COMMAND_S)

    def _write(self, name: str, parameters: str) -> Answer:
        register = REGISTERS[name]
        words = parameters.split(",", 1)
        try:
            value = int(float(words[0]))
        except ValueError:
            return self._refuse(_COMMAND_ERROR)
        high = register.high
        if name == "ASF":
            high = len(self.profile.cut_offs_hz) - 1
        bus_mode_text = name == "COF" and value & BUS_MODE and value % BUS_MODE not in BINARY_BASES
        locked = register.locked and not self._unlocked
        if not register.low <= value <= high or bus_mode_text or locked:
            return self._refuse(_EXECUTION_ERROR)
        if name == "ADR" and len(words) > 1 and words[1].strip('"') != self.serial_number:
            return self._refuse(_EXECUTION_ERROR)
        self.settings[name] = value
        return Answer(ACCEPTED, COMMAND_S)

    def _idn(self, asked: bool, _: str, __: float) -> Answer:
        if not asked:
            return self._refuse(_COMMAND_ERROR)
        text = f'HBM,"{self._type_name:<15}","{self.serial_number:<7}",P20\r\n'
        return Answer(text.encode(), COMMAND_S)

    def _bdr(self, asked: bool, parameters: str, _: float) -> Answer:
        settings = self.settings
        if not asked:
            try:
                baud, parity = (int(word) for word in parameters.split(","))
            except ValueError:
                return self._refuse(_COMMAND_ERROR)
            if baud not in self.profile.bauds or parity not in (0, 1):
                return self._refuse(_EXECUTION_ERROR)
            settings["BAUD"], settings["PARITY"] = baud, parity
            return Answer(ACCEPTED, COMMAND_S)
        return Answer(f"{settings['BAUD']},{settings['PARITY']}\r\n".encode(), COMMAND_S)

    def _spw(self, _: bool, parameters: str, __: float) -> Answer:
        self._unlocked = parameters.strip('"') == PASSWORD
        return Answer(ACCEPTED, COMMAND_S) if self._unlocked else self._refuse(_EXECUTION_ERROR)

    def _tdd(self, _: bool, parameters: str, __: float) -> Answer:
        line = {name: self.settings[name] for name in ("BAUD", "PARITY")}
        if parameters == "0":
            self.settings = factory_settings() | line
        elif parameters == "1":
            self._eeprom = dict(self.settings)
        elif parameters == "2":
            self.settings = dict(self._eeprom) | line
        else:
            return self._refuse(_EXECUTION_ERROR)
        return Answer(ACCEPTED, COMMAND_S)

    def _tar(self, _: bool, __: str, now_s: float) -> Answer:
        icr = self.settings["ICR"]
        number = self.signal.number_at(now_s, icr) + 1
        self.settings["TAV"] = self.signal.value(number, icr, self.settings["ASF"])[0]
        self.settings["TAS"] = 0
        return Answer(ACCEPTED, 2.0 * self.signal.period_s(icr) + COMMAND_S)

    def _esr(self, _: bool, __: str, ___: float) -> Answer:
        errors, self._errors = self._errors, 0
        return Answer(f"{errors:03d}\r\n".encode(), COMMAND_S)

    def _refuse(self, error: int) -> Answer:
        self._errors |= error
        return Answer(REFUSED, COMMAND_S)

    def _text(self, digits: int, status: int) -> bytes:
        """COF 1, 3, 9 and 11: value, address and status as text (section 5)."""
        (format_,) = formats_of(self.settings["COF"], 0, self.settings["ADR"])
        assert isinstance(format_, TextFormat)
        frame = format_.encode(round(digits * TEXT_PER_DIGIT), status)
        return frame.replace(b",", bytes([self.settings["TEX"] % TEXT_SEPARATORS_FROM]))


_METHODS = frozenset({"STP", "RES", "MSV", "IDN", "BDR", "SPW", "TDD", "TAR", "ESR"})
