"""One simulated amplifier: the AED node as a state machine (protocol note, sections 2 to 7)."""

import re
from collections.abc import Callable
from enum import Enum

from rig.amplifier.frame import (
    BINARY_BASES,
    BUS_MODE,
    DIGITS_PER_MV_PER_V,
    POWER_ON_STREAM,
    WITHOUT_CRLF,
    FrameFormat,
)
from rig.amplifier.message import ACCEPTED, BROADCAST
from rig.amplifier.profile import FIT, Profile
from rig.amplifier.text_frame import DIGITS_PER_MV_PER_V as TEXT_DIGITS_PER_MV_PER_V
from rig.amplifier.text_frame import TextFormat, formats_of
from rig.simulated.conversion import FACTORY_SPAN, MILLION, converted
from rig.simulated.memory import (
    COMMAND_ERROR,
    COMMAND_S,
    EXECUTION_ERROR,
    Answer,
    NodeMemory,
)
from rig.simulated.registers import CURVE, REGISTERS, factory_settings
from rig.simulated.signal import NodeSignal

TURNAROUND_S = 20e-6
"""From the end of a request to the start of a value in bus mode."""

CURVE_S = 4.0
"""How long LDW and LWT take to measure; documented is up to 4.2 s."""

RESTART_S = 2.0
"""How long a node is deaf after RES."""

ZERO_RANGES = (0.0, 0.02, 0.05, 0.1, 0.2)
"""Parts of the nominal value within which ZSE takes a zero (section 4)."""

TEXT_PER_DIGIT = TEXT_DIGITS_PER_MV_PER_V / DIGITS_PER_MV_PER_V[4]
TEXT_SEPARATORS_FROM = 128

_COMMAND = re.compile(r'([A-Z]{3})(\?)?([^"]*(?:"[^"]*")?)$')


class Selection(Enum):
    """Who a node takes the next command to be for."""

    OTHER = "another node"
    THIS = "this node"
    ALL = "all nodes: obey, do not answer"


class SimulatedNode(NodeMemory):
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
        line = {"ADR": address, "BAUD": baud, "PARITY": parity}
        super().__init__(profile, serial_number, factory_settings() | line)
        self.powered = True
        self._type_name = type_name
        self._crlf_in_bus_mode = crlf_in_bus_mode
        self._crlf_in_stream = crlf_in_stream
        self.power_on(0.0)

    def power_on(self, ready_s: float) -> None:
        """Start from the EEPROM; deaf until `ready_s`."""
        self.reload()
        self.measuring = False
        self.remaining = 0
        self._ready_s = ready_s
        # A node is active as if selected, unless it streams from power-on (section 3).
        streams = self.settings["COF"] >= POWER_ON_STREAM
        self._selection = Selection.OTHER if streams else Selection.THIS
        self._last_number = -1
        # Number and time of a value that a broadcast trigger had it measure, until it is fetched.
        self._held: tuple[int, float] | None = None
        self._zero = 0
        if self.settings["ZSE"]:
            self._set_zero(ready_s)
        if streams:
            self._measure(None, ready_s)

    def _set_zero(self, now_s: float) -> None:
        """Take off what the cell gives at power-on, where it is within the range of ZSE."""
        icr = self.settings["ICR"]
        digits, _ = self.signal.value(self.signal.number_at(now_s, icr), icr, self.settings["ASF"])
        nominal = FACTORY_SPAN / 2  # of a 1 mV/V cell: NOV is 0
        if abs(digits) <= ZERO_RANGES[self.settings["ZSE"]] * nominal:
            self._zero = digits

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
        return self.measuring and not self.settings["COF"] & BUS_MODE and not self.settings["TRC0"]

    def select(self, address: int, now_s: float) -> Answer | None:
        """Take `Sxx;`."""
        if address == BROADCAST:
            self._selection = Selection.ALL
            return None
        mine = address == self.settings["ADR"]
        self._selection = Selection.THIS if mine else Selection.OTHER
        if mine and self._held is not None:
            number, ready_s = self._held
            if now_s < ready_s:
                return None  # asked too early: what real ones do then is not documented
            self._held = None
            return Answer(self.frame(number), TURNAROUND_S)
        if mine and self.in_bus_mode and not self.settings["TRC0"]:
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
        digits = converted(digits - self._zero, settings)
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

    @property
    def next_streamed_s(self) -> float:
        """When the next value sent unasked is ready."""
        return self.signal.sampled_s(self._last_number + 1, self.settings["ICR"])

    def streamed(self) -> bytes:
        """The next value sent unasked, which is on its way then."""
        self._last_number += 1
        frame = self.frame(self._last_number)
        if self.remaining:
            self.remaining -= 1
            self.measuring = self.remaining > 0
        return frame

    def _execute(self, text: str, now_s: float) -> Answer | None:
        match = _COMMAND.match(text)
        if match is None:
            return self._refuse(COMMAND_ERROR)
        name, asked, parameters = match.groups()
        if name in REGISTERS:
            if name in CURVE and not (asked or parameters):
                return self._measure_curve(name, now_s)
            return self._show(name) if asked else self._write(name, parameters)
        if name not in _METHODS:
            return self._refuse(COMMAND_ERROR)
        method: Callable[[bool, str, float], Answer | None] = getattr(self, f"_{name.lower()}")
        return method(bool(asked), parameters, now_s)

    def _stp(self, _: bool, __: str, ___: float) -> None:
        self.measuring = False

    def _res(self, _: bool, __: str, now_s: float) -> None:
        self.power_on(now_s + RESTART_S)

    def _msv(self, asked: bool, parameters: str, now_s: float) -> Answer | None:
        if not asked:
            return self._refuse(COMMAND_ERROR)
        return self._measure(parameters or None, now_s)

    def _measure(self, count: str | None, now_s: float) -> Answer | None:
        icr = self.settings["ICR"]
        self._last_number = self.signal.number_at(now_s, icr)
        if count is None and not self.settings["COF"] & BUS_MODE:
            number = self._last_number + 1
            ready_s = self.signal.sampled_s(number, icr)
            if self._selection is Selection.ALL:
                self._held = (number, ready_s)
                return None
            return Answer(self.frame(number), max(0.0, ready_s - now_s))
        if count is not None and not count.isdecimal():
            return self._refuse(EXECUTION_ERROR)
        self.remaining = int(count or 0)
        self.measuring = True
        return None

    def _measure_curve(self, name: str, now_s: float) -> Answer:
        """LDW or LWT without a value: the present input is the point of the curve."""
        if not self._unlocked:
            return self._refuse(EXECUTION_ERROR)
        icr = self.settings["ICR"]
        digits, _ = self.signal.value(self.signal.number_at(now_s, icr), icr, self.settings["ASF"])
        self.settings[name] = round(MILLION * digits / FACTORY_SPAN)
        self.settings["TAV"] = 0
        return Answer(ACCEPTED, CURVE_S)

    def _idn(self, asked: bool, _: str, __: float) -> Answer:
        if not asked:
            return self._refuse(COMMAND_ERROR)
        text = f'HBM,"{self._type_name:<15}","{self.serial_number:<7}",P20\r\n'
        return Answer(text.encode(), COMMAND_S)

    def _tar(self, _: bool, __: str, now_s: float) -> Answer:
        icr = self.settings["ICR"]
        number = self.signal.number_at(now_s, icr) + 1
        self.settings["TAV"] = self.signal.value(number, icr, self.settings["ASF"])[0]
        self.settings["TAS"] = 0
        return Answer(ACCEPTED, 2.0 * self.signal.period_s(icr) + COMMAND_S)

    def _text(self, digits: int, status: int) -> bytes:
        """COF 1, 3, 9 and 11: value, address and status as text (section 5)."""
        (format_,) = formats_of(self.settings["COF"], 0, self.settings["ADR"])
        assert isinstance(format_, TextFormat)
        frame = format_.encode(round(digits * TEXT_PER_DIGIT), status)
        return frame.replace(b",", bytes([self.settings["TEX"] % TEXT_SEPARATORS_FROM]))


_METHODS = frozenset({"STP", "RES", "MSV", "IDN", "BDR", "SPW", "TDD", "TAR", "ESR", "LIC", "TRC"})
