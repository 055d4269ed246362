"""Where a value begins in a stream of bytes (protocol note, section 5, "Trap").

A checksum alone does not tell: the XOR of a value stays right when all its bytes are shifted round,
and slow tensions repeat their high bytes. So every phase is scored, and a stream is aligned only
where exactly one of them passes and all others have failed.
"""

from dataclasses import dataclass

from rig.amplifier.frame import CRLF, BadFrameError, Check, FrameFormat, Reading, ValueFormat

VALUES_TO_LOCK = 8
"""Values in a row that one phase must pass."""

LONGEST_SEARCH = 64
"""Values' worth of bytes after which a search has failed: the stream must be started anew."""

UNUSUAL_STATUS = 0xF0
"""Status bits that are zero on an amplifier with no limit switch, trigger or overrun."""


@dataclass(frozen=True, slots=True)
class Framed:
    """One value in the stream.

    Attributes
    ----------
    reading
        Its digits.
    end
        How many bytes of the stream had come with its last one.
    follows
        Whether it came directly after the value before.
    """

    reading: Reading
    end: int
    follows: bool


class FrameLock:
    """Cuts a stream into values.

    Parameters
    ----------
    format_
        Of the values. Without CR LF and without a checksum the status byte alone tells where a
        value begins: its upper half must be zero (no limit switch, no trigger, nothing skipped).
    jump_digits
        Where values come without CR LF, a change by more than this is taken for a lost byte until
        the phases have been scored again; None where CR LF guards each value.
    """

    def __init__(self, format_: ValueFormat, jump_digits: float | None = None) -> None:
        self._format = format_
        self._jump_digits = jump_digits
        self._data = self._before = b""
        self._start = 0
        self._last: int | None = None
        self._follows = False
        self._damaged: list[tuple[int, int]] = []
        self._by_status = (
            isinstance(format_, FrameFormat) and format_.check is Check.STATUS and not format_.crlf
        )
        self.locked = False

    @property
    def unproven(self) -> bytes:
        """Bytes that have come and are neither values nor faults yet."""
        return self._data

    @property
    def failed(self) -> bool:
        """Whether a search went on for too long: more than one phase fits, or none."""
        return not self.locked and len(self._data) >= LONGEST_SEARCH * self._format.length

    def feed(self, data: bytes, damaged: bool = False) -> tuple[list[Framed], list[BadFrameError]]:
        """Values that are complete and proven now, and bytes that are none.

        Parameters
        ----------
        data
            What came.
        damaged
            Whether the receiver saw a parity error in it: then none of it is believed that no
            checksum guards.
        """
        if damaged and not self._format.guarded:
            end = self._start + len(self._data)
            self._damaged.append((end, end + len(data)))
        self._data += data
        values: list[Framed] = []
        faults: list[BadFrameError] = []
        while True:
            if not self.locked and not self._search(faults):
                return values, faults
            if not self._cut(values, faults):
                return values, faults

    def _cut(self, values: list[Framed], faults: list[BadFrameError]) -> bool:
        """Cut off values while they are good; False where more bytes are needed."""
        length, data = self._format.length, self._data
        whole = len(data) - len(data) % length
        for at in range(0, whole, length):
            raw = data[at : at + length]
            try:
                reading = self._decode(raw)
            except BadFrameError as fault:
                faults.append(fault)
                self._drop(at + 1)
                self.locked = self._follows = False
                return True
            if self._jumped(reading):
                self._drop(at)
                self.locked, self._last = False, None
                return True
            start = self._start + at
            if self._damaged and self._in_damaged(start, length):
                faults.append(BadFrameError("parity error", raw))
                self._follows = False
                continue
            values.append(Framed(reading, start + length, self._follows))
            self._last, self._follows = reading.digits, True
        self._drop(whole)
        return False

    def _decode(self, raw: bytes) -> Reading:
        reading = self._format.decode(raw)
        if self._by_status and reading.status & UNUSUAL_STATUS:
            raise BadFrameError(f"status byte is {reading.status:02X}", raw)
        return reading

    def _in_damaged(self, start: int, length: int) -> bool:
        """Whether one of so many bytes came with a parity error."""
        while self._damaged and self._damaged[0][1] <= start:
            del self._damaged[0]
        return bool(self._damaged) and self._damaged[0][0] < start + length

    def _jumped(self, reading: Reading) -> bool:
        if self._jump_digits is None or self._last is None:
            return False
        return abs(reading.digits - self._last) > self._jump_digits

    def _search(self, faults: list[BadFrameError]) -> bool:
        """Look for the one phase; True where it was found and stands at the front."""
        length = self._format.length
        if len(self._data) < (VALUES_TO_LOCK + 1) * length:
            return False
        runs = [self._run(phase) for phase in range(length)]
        passing = [phase for phase, (first, _) in enumerate(runs) if first is not None]
        if len(passing) != 1 or any(not failed for first, failed in runs if first is None):
            return False
        (phase,) = passing
        first, _ = runs[phase]
        if first is None:
            return False
        if not self._clean(first):
            first += length
        if first:
            faults.append(BadFrameError("no value", self._data[:first]))
            self._drop(first)
            self._follows = False
        self.locked = True
        return True

    def _clean(self, first: int) -> bool:
        """Whether a value can begin there whole.

        A byte that came between leaves a value whose later bytes stand where they should: without
        a checksum the first value after a fault is believed only behind a CR LF, or behind silence.
        """
        if self._format.guarded or self._start + first == 0:
            return True
        before = self._before + self._data[:first]
        return self._format.ends_in_crlf and before.endswith(CRLF)

    def _run(self, phase: int) -> tuple[int | None, bool]:
        """Where the values of a phase begin that pass up to the newest byte; and did any fail."""
        length = self._format.length
        first: int | None = None
        count, failed = 0, False
        for at in range(phase, len(self._data) - length + 1, length):
            try:
                self._decode(self._data[at : at + length])
            except BadFrameError:
                first, count, failed = None, 0, True
            else:
                first = at if first is None else first
                count += 1
        return (first if count >= VALUES_TO_LOCK else None), failed

    def _drop(self, count: int) -> None:
        self._before = (self._before + self._data[:count])[-len(CRLF) :]
        self._data = self._data[count:]
        self._start += count
