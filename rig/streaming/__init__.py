"""One serial port per amplifier: values come unasked, up to 1200 a second each (`MSV?0;`)."""

from rig.streaming.port import StreamPort, open_ports
from rig.streaming.stream import StreamingStream

__all__ = ["StreamPort", "StreamingStream", "open_ports"]
