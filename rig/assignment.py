"""Which amplifier is on which cable, as the rig file says, and whether that can work."""

from cdpr8.errors import RigFileError
from cdpr8.rigfile.schema import Amplifier, Rig
from rig.amplifier.frame import BUS_MODE, POWER_ON_STREAM, FrameFormat
from rig.amplifier.text_frame import formats_of
from rig.transport import LineSettings


def amplifiers(rig: Rig) -> dict[int, Amplifier]:
    """The amplifier of each cable, checked to be complete and apart from each other.

    Raises
    ------
    RigFileError
        A cable has none, two share an address, or the format cannot be used.
    """
    found: dict[int, Amplifier] = {}
    for cable, entry in enumerate(rig.cable, start=1):
        if entry.amplifier is None:
            raise RigFileError(
                f"cable {cable} has no amplifier",
                where=rig.name,
                remedy="give it `amplifier = {address = ..., nominal_force_n = ...}`",
            )
        for other, taken in found.items():
            if taken.address == entry.amplifier.address and not rig.bus.streaming:
                raise RigFileError(
                    f"cables {other} and {cable} share amplifier address {taken.address}",
                    where=rig.name,
                    allowed="each address once, 0 to 31",
                )
        found[cable] = entry.amplifier
    _check_format(rig)
    return found


def line_settings(rig: Rig) -> LineSettings:
    """Speed and framing of the rig file's bus."""
    return LineSettings(rig.bus.baud, rig.bus.parity)


def _check_format(rig: Rig) -> None:
    cof = rig.bus.output_format
    found = formats_of(cof, 0, 0) if cof < POWER_ON_STREAM else ()
    if rig.bus.streaming:
        if not any(each.alignable for each in found):
            raise RigFileError(
                f"[bus] output_format = {cof} is no format of measured values",
                where=rig.name,
                allowed="8 or 12 (4 bytes), 0 or 4, 2 or 6 (2 bytes), 1, 3, 9 or 11 (text); "
                "+ 32 without CR LF; the bus mode's 16 does not matter where streaming = true",
                remedy="8: 4 bytes with a checksum, CR LF at the end",
            )
        return
    binary = any(isinstance(each, FrameFormat) for each in found)
    if rig.bus.sweep == "broadcast":
        if not binary:
            raise RigFileError(
                f'[bus] output_format = {cof} gives no binary values, and sweep = "broadcast"',
                where=rig.name,
                allowed="0, 2, 4, 6, 8 or 12 (and these + 32); the bus mode's 16 does not matter",
                remedy="24 or 8: 4 bytes with a checksum or status",
            )
    elif not (cof & BUS_MODE and binary):
        raise RigFileError(
            f"[bus] output_format = {cof} gives no binary values in bus mode",
            where=rig.name,
            allowed="16, 18, 20, 22, 24 or 28 (and these + 32)",
            remedy="24: 4 bytes with status",
        )
