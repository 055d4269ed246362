"""Which amplifier is on which cable, as the rig file says, and whether that can work."""

from cdpr8.errors import RigFileError
from cdpr8.rigfile.schema import Amplifier, Rig
from rig.amplifier.frame import BUS_MODE, POWER_ON_STREAM, FrameFormat
from rig.transport import LineSettings


def amplifiers(rig: Rig) -> dict[int, Amplifier]:
    """The amplifier of each cable, checked to be complete and apart from each other.

    Raises
    ------
    RigFileError
        A cable has none, two share an address, or the format is none of the bus mode.
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
    cof = rig.bus.output_format
    try:
        FrameFormat.of_output_format(cof, 0, crlf=True)
        in_bus_mode = bool(cof & BUS_MODE) and cof < POWER_ON_STREAM
    except ValueError:
        in_bus_mode = False
    if not in_bus_mode:
        raise RigFileError(
            f"[bus] output_format = {cof} gives no binary values in bus mode",
            where=rig.name,
            allowed="16, 18, 20, 22, 24 or 28 (and these + 32)",
            remedy="24: 4 bytes with status",
        )
    return found


def line_settings(rig: Rig) -> LineSettings:
    """Speed and framing of the rig file's bus."""
    return LineSettings(rig.bus.baud, rig.bus.parity)
