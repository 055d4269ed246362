"""Parity errors as a POSIX terminal marks them (PARMRK): FF 00 x for a bad byte x, FF FF for FF."""

MARK = 0xFF
BAD = 0x00


class ParityMarks:
    """Undoes the marking; a mark may be split between two reads."""

    def __init__(self) -> None:
        self._held = b""

    def undo(self, raw: bytes) -> tuple[bytes, bool]:
        """The bytes as they were on the line, and whether one came with a parity error."""
        raw = self._held + raw
        self._held = b""
        if MARK not in raw:
            return raw, False
        plain = bytearray()
        damaged = False
        at = 0
        while at < len(raw):
            if raw[at] != MARK:
                plain.append(raw[at])
                at += 1
                continue
            needs = 3 if raw[at + 1 : at + 2] == bytes([BAD]) else 2
            if at + needs > len(raw):
                self._held = raw[at:]
                break
            damaged |= needs == 3
            plain.append(raw[at + needs - 1])
            at += needs
        return bytes(plain), damaged
