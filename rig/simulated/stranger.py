"""A simulated amplifier of a type that nobody knows: it gives text, and refuses much else."""

from rig.amplifier.profile import Profile
from rig.amplifier.text_frame import TEXT_BASES
from rig.simulated.memory import COMMAND_ERROR, EXECUTION_ERROR, Answer
from rig.simulated.node import TURNAROUND_S, SimulatedNode
from rig.simulated.signal import NodeSignal

STRANGE = Profile(
    name="strange",
    types=(),
    rates_per_s=(200.0, 100.0, 50.0, 25.0, 12.5, 6.25, 3.125, 1.5625),
    cut_offs_hz=(None, 30.0, 12.0, 6.0, 2.5, 1.0, 0.6, 0.3, 0.1),
    bauds=(9600, 19200, 38400, 57600, 115200),
    overflow_mv_per_v=3.2,
    source="made up: rates, filters and overflow of no amplifier that a Profile is written for",
)

TYPE = "AD112"


class StrangeNode(SimulatedNode):
    """One node of unknown type: no binary values, no bus mode, no checksum.

    Parameters
    ----------
    signal, address, serial_number, baud, parity
        As of `SimulatedNode`; the signal has the profile `STRANGE`, or another.
    profile
        The signal's.
    refuses
        Commands that it answers with ``?``, whether asked or written.
    gives_newest
        Whether ``MSV?;`` is answered at once with the newest value; otherwise with the next.
    """

    def __init__(
        self,
        signal: NodeSignal,
        address: int,
        serial_number: str,
        *,
        baud: int = 115200,
        parity: int = 1,
        profile: Profile = STRANGE,
        refuses: tuple[str, ...] = ("CSM", "RSN", "TRC"),
        gives_newest: bool = False,
    ) -> None:
        super().__init__(
            signal, address, serial_number, baud=baud, parity=parity, profile=profile,
            type_name=TYPE,
        )  # fmt: skip
        self.refuses = refuses
        self.gives_newest = gives_newest
        # Somebody set its filter, from its manual, and saved it.
        self._eeprom["ASF"] = self.settings["ASF"] = 0

    def _execute(self, text: str, now_s: float) -> Answer | None:
        if text[:3] in self.refuses:
            return self._refuse(COMMAND_ERROR)
        return super()._execute(text, now_s)

    def _write(self, name: str, parameters: str) -> Answer:
        if name == "COF" and parameters not in map(str, TEXT_BASES):
            return self._refuse(EXECUTION_ERROR)
        return super()._write(name, parameters)

    def _measure(self, count: str | None, now_s: float) -> Answer | None:
        answer = super()._measure(count, now_s)
        if count is None and answer is not None and self.gives_newest:
            number = self.signal.number_at(now_s + TURNAROUND_S, self.settings["ICR"])
            return Answer(self.frame(number), TURNAROUND_S)
        return answer
