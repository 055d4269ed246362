"""A serial port or a pseudo-terminal, through pyserial."""

import errno
import math
import os
import select
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from cdpr8.clock import Clock
from cdpr8.errors import DeviceError
from rig.transport.end import LineEnd
from rig.transport.line import LineLostError, LineSettings, Received
from rig.transport.parity_marks import ParityMarks

if TYPE_CHECKING:
    import serial

MOST_READ = 256
"""How much one read takes at most where an answer is waited for."""

POLL_S = 0.005
"""How long one read of the port may block: deadlines are kept to within this."""


class SerialTransport(LineEnd):
    """A line behind pyserial.

    Parameters
    ----------
    port
        Open, with its timeout at `POLL_S`.
    line
        What the port was set to; parity may be kept by the far end only (pseudo-terminals).
    clock
        Stamps the bytes.
    marks
        Undoes the marking of parity errors, where the port marks them.

    Attributes
    ----------
    on_write
        Told when bytes are handed over: a simulated far end starts its line then, and not when
        its thread wakes up.
    """

    def __init__(
        self,
        port: "serial.Serial",
        line: LineSettings,
        clock: Clock,
        marks: ParityMarks | None = None,
    ) -> None:
        super().__init__(line, clock, str(port.port))
        self.on_write: Callable[[float], None] | None = None
        self._port = port
        self._marks = marks
        # What was read beyond what was asked for, whether some of it was damaged, and when.
        self._beyond, self._beyond_damaged, self._read_s = b"", False, -math.inf

    @property
    def marks_parity_errors(self) -> bool:
        """Whether the operating system tells which bytes came with a parity error."""
        return self._marks is not None

    def write(self, data: bytes) -> None:
        """Hand `data` to the operating system."""
        if self.on_write is not None:
            self.on_write(self.clock.monotonic_s())
        try:
            # Past pyserial's layers where that is possible: they cost tens of microseconds, and
            # the line waits for each request.
            sent = os.write(self._port.fileno(), data) if os.name == "posix" else 0
            if sent < len(data):
                self._port.write(data[sent:])
        except _LOST as error:
            raise self._lost(error) from None

    def read(self, count: int, deadline_s: float) -> Received:
        """Exactly `count` bytes, or what has come by `deadline_s`."""
        data, damaged = self._kept()
        last_s = self._read_s
        while len(data) < count:
            # All that is there: what else has come is known then, and need not be asked for.
            chunk, chunk_damaged = self._wait(MOST_READ)
            now_s = self.clock.monotonic_s()
            if chunk:
                data += chunk
                damaged |= chunk_damaged
                self._read_s = last_s = now_s
            if now_s >= deadline_s and len(data) < count:
                return Received(data, last_s if data else now_s, damaged)
        self._beyond, self._beyond_damaged = data[count:], damaged
        return Received(data[:count], last_s, damaged)

    def take(self) -> Received:
        """What has come and was not read."""
        data, damaged = self._kept()
        more, more_damaged = self._waiting()
        return Received(data + more, self.clock.monotonic_s(), damaged or more_damaged)

    def discard(self) -> bytes:
        """The bytes of `take`: this comes before each request, and the line waits for it.

        Where all that had come was read less than a character's time ago, it is not asked again.
        """
        just_read = self.clock.monotonic_s() - self._read_s < self.line.char_s
        data, _ = self._kept()
        return data if just_read else data + self._waiting()[0]

    def reopen(self) -> None:
        """Open the port of the same name again.

        Raises
        ------
        DeviceError
            It is not there yet, or refuses the settings.
        """
        self.close()
        self._kept()
        self._read_s = -math.inf
        self._port, self._marks = _open(self.name, self.line)

    def close(self) -> None:
        """Close the port."""
        with suppress(*_LOST):
            self._port.close()

    def _kept(self) -> tuple[bytes, bool]:
        """What was read beyond what was asked for, given away, and whether it was damaged."""
        data, damaged = self._beyond, self._beyond_damaged
        self._beyond, self._beyond_damaged = b"", False
        return data, damaged

    def _waiting(self) -> tuple[bytes, bool]:
        # Asked, not only read: a port that is gone reads as an empty one.
        try:
            waiting = self._port.in_waiting
        except _LOST as error:
            raise self._lost(error) from None
        return self._came(self._read, waiting) if waiting else (b"", False)

    def _wait(self, count: int) -> tuple[bytes, bool]:
        """At most `count` bytes within `POLL_S`, and whether one of them was damaged."""
        return self._came(self._read_soon, count)

    def _came(self, read: Callable[[int], bytes], count: int) -> tuple[bytes, bool]:
        """What a reading gives, and whether one of its bytes was damaged."""
        try:
            raw = read(count)
        except _LOST as error:
            raise self._lost(error) from None
        if self._marks is None:
            return raw, False
        return self._marks.undo(raw)

    def _read_soon(self, count: int) -> bytes:
        """At most `count` bytes, where any come within `POLL_S`."""
        if os.name == "posix" and not select.select((self._port.fileno(),), (), (), POLL_S)[0]:
            return b""
        return self._read(count)

    def _read(self, count: int) -> bytes:
        """At most `count` of the bytes that have come."""
        if os.name != "posix":
            return bytes(self._port.read(count))
        raw = os.read(self._port.fileno(), count)
        if not raw:
            raise OSError(errno.EIO, "ready to read, but nothing came")
        return raw

    def _lost(self, error: Exception) -> LineLostError:
        return LineLostError(
            f"the port is gone: {error}",
            where=self.name,
            remedy="check the cable and the adapter, then record again; what came is kept",
        )


def open_serial_port(path: str, line: LineSettings, clock: Clock) -> SerialTransport:
    """Open a serial port or pseudo-terminal for the bus.

    Parameters
    ----------
    path
        A device such as ``/dev/ttyUSB0`` or ``COM3``; best ``/dev/serial/by-id/...``.
    line
        Speed and framing.
    clock
        Stamps what comes.

    Raises
    ------
    DeviceError
        There is no such port, it is taken, or it refuses the settings.
    """
    port, marks = _open(path, line)
    return SerialTransport(port, line, clock, marks)


def _open(path: str, line: LineSettings) -> "tuple[serial.Serial, ParityMarks | None]":
    import serial

    # A pseudo-terminal has no parity: the kernel drops the bit, and glibc then reports EINVAL on
    # every second open (protocol note, pty facts). Its line speed and parity are the far end's.
    parity = "N" if line.parity == "none" or _is_pseudo_terminal(path) else "E"
    try:
        port = serial.Serial(
            path,
            baudrate=line.baud,
            parity=parity,
            timeout=POLL_S,
            write_timeout=1.0,
            xonxoff=False,  # binary values hold 0x11 and 0x13
            rtscts=False,
            exclusive=True if sys.platform != "win32" else None,
        )
    except _LOST as error:
        raise _not_opened(path, line, error) from None
    _ask_for_low_latency(port)
    marks = ParityMarks() if parity == "E" and _mark_parity_errors(port) else None
    return port, marks


def serial_ports() -> tuple[str, ...]:
    """Ports this machine has, by their lasting names where there are any.

    None where one vanishes while they are looked at.
    """
    from serial.tools import list_ports

    try:
        ports = sorted(list_ports.comports())
    except OSError:
        return ()
    by_id = sorted(Path("/dev/serial/by-id").glob("*"))
    lasting = {_resolved(link): str(link) for link in by_id}
    return tuple(lasting.get(_resolved(Path(port.device)), port.device) for port in ports)


def _resolved(path: Path) -> Path:
    """Where a name leads; the name where it vanishes while it is read: an adapter was unplugged."""
    try:
        return path.resolve()
    except OSError:
        return path


def _lost_types() -> tuple[type[Exception], ...]:
    """What an unplugged port raises; SerialException is an OSError, termios.error is not."""
    try:
        import termios
    except ImportError:
        return (OSError,)
    return (OSError, termios.error)


_LOST = _lost_types()


def _is_pseudo_terminal(path: str) -> bool:
    return str(_resolved(Path(path))).startswith("/dev/pts/")


def _ask_for_low_latency(port: "serial.Serial") -> None:
    """Deliver bytes as they come (FTDI's default waits 16 ms); best effort, ptys refuse it."""
    ask = getattr(port, "set_low_latency_mode", None)
    if ask is not None:
        try:
            ask(True)
        except (OSError, ValueError):
            return


def _mark_parity_errors(port: "serial.Serial") -> bool:
    """Have the operating system mark bytes that came with a parity error; pyserial does not."""
    try:
        import termios
    except ImportError:
        return False
    try:
        attributes = termios.tcgetattr(port.fileno())
        attributes[0] |= termios.INPCK | termios.PARMRK
        attributes[0] &= ~termios.IGNPAR
        termios.tcsetattr(port.fileno(), termios.TCSANOW, attributes)
    except _LOST:
        return False
    return True


def _not_opened(path: str, line: LineSettings, error: Exception) -> DeviceError:
    ports = serial_ports()
    code = getattr(error, "errno", None)
    if not Path(path).exists() and sys.platform != "win32":
        what = f"no serial port {path!r}"
    elif code in (11, 16):
        what = f"port {path!r} is in use by another program"
    elif code == 13:
        what = f"port {path!r} may not be opened by this user"
    elif not path:
        what = "[bus] port names no port"
    elif code in (errno.ENOTTY, errno.EISDIR, errno.ENOTDIR) or Path(path).is_file():
        what = f"{path!r} is no serial port"
    else:
        what = f"port {path!r} cannot be opened at {line}: {error}"
    remedy = 'correct [bus] port in the rig file; port = "simulated" needs no hardware'
    if code == 13:
        remedy = "join the group that owns the device (dialout on most systems), then log in again"
    return DeviceError(what, allowed="ports here: " + (", ".join(ports) or "none"), remedy=remedy)
