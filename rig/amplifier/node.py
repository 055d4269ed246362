"""The client of one amplifier: select it, identify it, set it and read every setting back."""

from dataclasses import dataclass

from cdpr8.errors import DeviceError
from rig.amplifier import message
from rig.amplifier.dialogue import TRIES, Dialogue
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

    def identify(self, *, tries: int = TRIES) -> Identity:
        """Select the node and read who it is, asking `tries` times at most.

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
        request = message.command(mnemonic, *parameters)
        answer = self._dialogue.ask(request, message.is_acknowledgement)
        if answer != message.ACCEPTED:
            raise self._fault(
                f"{request.decode()} was answered with {answer.decode('ascii', 'replace').strip()}",
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

    def configure(self, settings: Settings) -> dict[str, str]:
        """Write the settings, read each back, and return what was read.

        Raises
        ------
        DeviceError
            A setting is refused, or reads back as something else.
        """
        found = {"COF": self.read("COF")}
        self.write("SPW", PASSWORD)
        found["NOV"] = self.read("NOV")
        if message.parse_integer(found["NOV"].encode(), "NOV?") != 0:
            # The scaling on the host stands on the factory curve: NOV=0 (section 6).
            self._set("NOV", 0, found)
        for mnemonic, value in settings.commands():
            self._set(mnemonic, value, found)
        return found

    def _set(self, mnemonic: str, value: int, found: dict[str, str]) -> None:
        self.write(mnemonic, value)
        found[mnemonic] = self.read(mnemonic)
        if message.parse_integer(found[mnemonic].encode(), f"{mnemonic}?") != value:
            raise self._fault(
                f"{mnemonic} reads {found[mnemonic]} after {value} was accepted", allowed=str(value)
            )

    def _fault(self, what: str, *, allowed: str) -> DeviceError:
        return DeviceError(
            what,
            allowed=allowed,
            where=f"amplifier {self.address:02d} on {self._dialogue.transport.name}",
            remedy="the amplifier is of another kind than the rig file's [bus] section assumes, "
            "or locked by another password",
        )
