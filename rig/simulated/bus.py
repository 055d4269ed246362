"""Simulated nodes on one line: framing of commands, line pacing, collisions."""

import re
from collections import deque
from collections.abc import Sequence

from rig.simulated.faults import LineFaults
from rig.simulated.memory import Answer
from rig.simulated.node import SimulatedNode
from rig.transport import Chunk, LineSettings

_SELECT = re.compile(rb"S(\d\d)$")
_TERMINATORS = re.compile(rb"([;\n])")
_IGNORED = bytes(range(0x21))
"""Bytes up to 0x20 are ignored inside a command (protocol note, section 2)."""

LONGEST_COMMAND = 64

BACKLOG = 2
"""Values that wait in a node while the line is taken."""


class SimulatedBus:
    """The far end of the line: eight nodes, or any number.

    Parameters
    ----------
    nodes
        On the bus.
    line
        What the master's port is set to; nodes set otherwise do not understand it.
    faults
        What the line does to bytes.
    echo
        Whether the master hears what it sends, as 2-wire adapters do.
    """

    def __init__(
        self,
        nodes: Sequence[SimulatedNode],
        line: LineSettings,
        faults: LineFaults | None = None,
        *,
        echo: bool = False,
    ) -> None:
        self._echo = echo
        self.nodes = tuple(nodes)
        self.line = line
        self.faults = faults
        self._buffer = b""
        self._buffer_damaged = False
        self._request_free_s = 0.0
        self._answer_free_s = 0.0
        self._outgoing: deque[Chunk] = deque()

    def hear(self, data: bytes, start_s: float) -> None:
        """Bytes from the master."""
        char_s = self.line.char_s
        start_s = max(start_s, self._request_free_s)
        self._request_free_s = start_s + len(data) * char_s
        if self._echo:
            self._send(data, start_s)
        damaged = False
        if self.faults is not None:
            data, damaged = self.faults.spoil(data, self.line.parity == "even")
        # Faults move bytes by a character at most: far less than anything that is timed.
        at_s = start_s
        for part in _TERMINATORS.split(data):
            at_s += len(part) * char_s
            if part not in (b";", b"\n"):
                self._buffer = (self._buffer + part)[-LONGEST_COMMAND:]
                self._buffer_damaged |= damaged
                continue
            text = self._buffer.translate(None, _IGNORED)
            selection = _SELECT.match(text.upper())
            if selection and part == b"\n":
                continue  # S takes a semicolon only
            ignored = self._buffer_damaged or damaged
            self._buffer, self._buffer_damaged = b"", False
            if text and not ignored:
                self._pass_on(text, selection, at_s)

    @property
    def streaming(self) -> bool:
        """Whether a node sends values unasked."""
        return any(node.powered and node.streaming for node in self.nodes)

    def speak(self, until_s: float) -> deque[Chunk]:
        """Answers under way, and what streaming nodes send up to `until_s`."""
        for node in self.nodes:
            while node.powered and node.streaming:
                at_s = node.next_streamed_s
                if at_s > until_s:
                    break
                frame = node.streamed()
                # A node skips values that its line is too slow for (status bit 7, section 5).
                if self._answer_free_s - at_s <= BACKLOG * len(frame) * self.line.char_s:
                    self._send(frame, at_s)
        return self._outgoing

    def _pass_on(self, text: bytes, selection: re.Match[bytes] | None, now_s: float) -> None:
        parity = 1 if self.line.parity == "even" else 0
        answers: list[Answer] = []
        command = "" if selection else _spoken(text)
        for node in self.nodes:
            if not node.hears(self.line.baud, parity, now_s):
                continue
            if selection:
                answer = node.select(int(selection.group(1)), now_s)
            else:
                answer = node.obey(command, now_s)
            # BDR is answered at the new speed, which the master does not understand yet.
            if answer is not None and node.hears(self.line.baud, parity, now_s):
                answers.append(answer)
        if len(answers) == 1:
            self._send(answers[0].data, now_s + answers[0].delay_s)
        elif answers:
            self._collide(answers, now_s)

    def _send(self, data: bytes, start_s: float, damaged: bool = False) -> None:
        char_s = self.line.char_s
        start_s = max(start_s, self._answer_free_s)
        self._answer_free_s = start_s + len(data) * char_s
        if self.faults is not None:
            data, spoiled = self.faults.spoil(data, self.line.parity == "even")
            damaged |= spoiled
        if data:
            self._outgoing.append(Chunk(data, start_s + char_s, char_s, damaged))

    def _collide(self, answers: Sequence[Answer], now_s: float) -> None:
        """Two drivers on one wire: a zero of either wins, and stop bits are lost."""
        longest = max(len(answer.data) for answer in answers)
        mixed = bytearray(b"\xff" * longest)
        for answer in answers:
            for place, byte in enumerate(answer.data):
                mixed[place] &= byte
        same = all(answer == answers[0] for answer in answers)
        self._send(bytes(mixed), now_s + answers[0].delay_s, damaged=not same)


def _spoken(text: bytes) -> str:
    """A command as text: mnemonics in capitals, what stands in quotes as it is."""
    spoken = text.decode("latin-1")
    return spoken[:3].upper() + spoken[3:]
