"""The client of one amplifier: select it, identify it, set it and read every setting back."""

from dataclasses import dataclass, field

from cdpr8.errors import DeviceError
from rig.amplifier import message, own_scaling
from rig.amplifier.dialogue import Dialogue
from rig.amplifier.profile import Identity

PASSWORD = "AED"
"""Factory password; commands marked "pw" in section 4 need it."""


VALUE_AS_TEXT = 3
"""The output format of sign, seven digits and CR LF (section 5)."""

SLOWEST_VALUE_S = 1.1
"""A value is waited for: at the slowest output rate for a second (section 8)."""


@dataclass(frozen=True)
class Settings:
    """What a node is set to before a run; everything else is left as it is.

    Attributes
    ----------
    cof
        Output format.
    icr
        Index of the output rate.
    asf
        Index of the filter.
    csm
        1: checksum instead of status in the last byte of a value.
    """

    cof: int
    icr: int
    asf: int
    csm: int = 0

    def commands(self) -> tuple[tuple[str, int], ...]:
        """Mnemonics and values in the order they are written; the format comes last.

        FMD0: the standard filter, whose delay is known. TAS1: gross, so that no tare hides in the
        values. ZTR0: no zero tracking, which would eat slow drifts of tension. TEX172: the
        factory's separator.
        """
        return (
            ("FMD", 0),
            ("ASF", self.asf),
            ("ICR", self.icr),
            ("TAS", 1),
            ("ZTR", 0),
            ("TEX", 172),
            ("CSM", self.csm),
            ("COF", self.cof),
        )


AS_TEXT = {"NOV": 0, "TAS": 1, "ZTR": 0, "TEX": 172, "COF": VALUE_AS_TEXT}
"""What one of unknown type is set to, where it has the setting and it is another; the format comes
last, and that it must have.
"""

LEFT_ALONE = ("FMD", "ASF", "ICR")
"""What their numbers mean is another thing in each dialect: of an unknown one they are told."""


@dataclass(frozen=True)
class State:
    """A node as it stands before a run; equal to another where it gives the same values.

    Attributes
    ----------
    settings
        Command -> answer: what was written, read back, and what the node does to its digits.
    found
        What `own_scaling.AS_FOUND` answered before anything was written.
    """

    settings: dict[str, str]
    found: dict[str, str] = field(compare=False)


class NodeClient:
    """One amplifier on the bus.

    Parameters
    ----------
    dialogue
        Of the bus.
    address
        0..31.
    """

    def __init__(self, dialogue: Dialogue, address: int) -> None:
        self._dialogue = dialogue
        self.address = address

    def identify(self, *, tries: int | None = None) -> Identity:
        """Select the node and read who it is, asking `tries` times at most (`Dialogue.ask`).

        Raises
        ------
        NoAnswerError
            Nobody has this address.
        DeviceError
            The answer is no identity.
        """
        # The selection goes out with the question: a lone terminator first, so that nothing
        # half-sent stands before it (section 2).
        request = message.END + message.select(self.address) + message.query("IDN")
        return Identity.parse(self._dialogue.ask(request, message.is_identity, tries=tries))

    def read(self, mnemonic: str) -> str:
        """The answer to a query, without its line end; the node must be selected."""
        answer = self._dialogue.ask(message.query(mnemonic), message.is_value)
        return answer.removesuffix(message.LINE_END).decode("ascii", "replace")

    def write(self, mnemonic: str, *parameters: int | str) -> None:
        """Write one setting; the node must be selected.

        Raises
        ------
        DeviceError
            The node refuses it.
        """
        if not self._accepts(mnemonic, *parameters):
            raise self._fault(
                f"{message.command(mnemonic, *parameters).decode()} was answered with ?",
                allowed="0 (accepted)",
            )

    def measure(self) -> int:
        """What it measures now, as text gives it (`text_frame.DIGITS_PER_MV_PER_V` at NOV=0).

        Its output must be stopped. The format is put back; nothing is saved.
        """
        format_ = message.parse_integer(self.read("COF").encode(), "COF?")
        self.write("COF", VALUE_AS_TEXT)
        try:
            answer = self._dialogue.ask(
                message.query("MSV"), message.is_value, margin_s=SLOWEST_VALUE_S
            )
        finally:
            self.write("COF", format_)
        return message.parse_integer(answer, "MSV?")

    def configure(self, settings: Settings) -> State:
        """Write the settings, read each back, and return what was read.

        Raises
        ------
        DeviceError
            A setting is refused, or reads back as something else; or the node has a scaling of its
            own, with which its digits would be another force.
        """
        own, found = self._as_found()
        read: dict[str, str] = {"NOV": found["NOV"]}
        if message.parse_integer(found["NOV"].encode(), "NOV?") != 0:
            # The scaling on the host stands on the factory curve: NOV=0 (section 6).
            self._set("NOV", 0, read)
        for mnemonic, value in settings.commands():
            self._set(mnemonic, value, read)
        return State(read | own, found)

    def configure_as_text(self) -> State:
        """Have one of unknown type give values as text, and leave all else as it is.

        Raises
        ------
        DeviceError
            It does not give text, keeps a scaling or a tare of its own, or does not acknowledge.
        """
        own, found = self._as_found()
        read = {mnemonic: self.read(mnemonic) for mnemonic in (*LEFT_ALONE, *AS_TEXT)}
        for mnemonic, value in AS_TEXT.items():
            told = own_scaling.numbers(read[mnemonic])
            if told != (value,) and (told or mnemonic == "COF"):
                self._set(mnemonic, value, read)
        return State(read | own, found)

    def _as_found(self) -> tuple[dict[str, str], dict[str, str]]:
        """What the node does to its digits itself, and what is told of it."""
        # Before the password, which lets a question that loses its ? change what it asks for.
        own = {mnemonic: self.read(mnemonic) for mnemonic in own_scaling.JUDGED}
        found = {mnemonic: self.read(mnemonic) for mnemonic in own_scaling.AS_FOUND}
        self._require_factory_curve(own)
        return own, found

    def _require_factory_curve(self, own: dict[str, str]) -> None:
        wrong = own_scaling.deviations(own)
        if wrong:
            raise DeviceError(
                "its digits would be scaled wrong: " + "; ".join(wrong.values()),
                allowed=own_scaling.allowed(wrong),
                where=self._where,
                remedy=own_scaling.remedy(own, self.address, PASSWORD),
            )

    def _set(self, mnemonic: str, value: int, read: dict[str, str]) -> None:
        if not self._accepts(mnemonic, value):
            # Given only where something needs it: it stays given until the node is switched off.
            self.write("SPW", PASSWORD)
            self.write(mnemonic, value)
        read[mnemonic] = self.read(mnemonic)
        if message.parse_integer(read[mnemonic].encode(), f"{mnemonic}?") != value:
            raise self._fault(
                f"{mnemonic} reads {read[mnemonic]} after {value} was accepted", allowed=str(value)
            )

    def _accepts(self, mnemonic: str, *parameters: int | str) -> bool:
        request = message.command(mnemonic, *parameters)
        answer = self._dialogue.ask(request, message.is_acknowledgement)
        return answer == message.ACCEPTED

    @property
    def _where(self) -> str:
        return f"amplifier {self.address:02d} on {self._dialogue.transport.name}"

    def _fault(self, what: str, *, allowed: str) -> DeviceError:
        return DeviceError(
            what,
            allowed=allowed,
            where=self._where,
            remedy="the amplifier is of another kind than the rig file's [bus] section assumes, "
            "or locked by another password",
        )
