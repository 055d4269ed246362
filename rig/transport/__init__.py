"""The seam under the amplifier bus: bytes out, bytes in, deadlines, and nothing of the protocol."""

from rig.transport.line import LineLostError, LineSettings, Received, Transport
from rig.transport.memory import Chunk, FarEnd, MemoryTransport
from rig.transport.recorded import RecordedTransport, TracingTransport
from rig.transport.serial_port import SerialTransport, open_serial_port
from rig.transport.two_wire import TwoWire

__all__ = [
    "Chunk",
    "FarEnd",
    "LineLostError",
    "LineSettings",
    "MemoryTransport",
    "Received",
    "RecordedTransport",
    "SerialTransport",
    "TracingTransport",
    "Transport",
    "TwoWire",
    "open_serial_port",
]
