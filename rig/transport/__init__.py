"""The seam under the amplifier bus: bytes out, bytes in, deadlines, and nothing of the protocol."""

from rig.transport.line import LineSettings, Received, Transport
from rig.transport.memory import Chunk, FarEnd, MemoryTransport
from rig.transport.serial_port import SerialTransport, open_serial_port

__all__ = [
    "Chunk",
    "FarEnd",
    "LineSettings",
    "MemoryTransport",
    "Received",
    "SerialTransport",
    "Transport",
    "open_serial_port",
]
