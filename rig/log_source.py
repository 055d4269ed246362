"""Where the lines of another program's log come from: a growing file, or a TCP connection."""

import socket
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Protocol

from cdpr8.errors import DataError, DeviceError

LOOK_EVERY_S = 0.02
"""A log is looked at this often: how late a line may be noticed."""

CONNECT_S = 3.0
RECONNECT_EVERY_S = 1.0
HEADING_BYTES = 65536
"""Of a file that is there before the run, so much is read for its column names."""


class LineSource(Protocol):
    """Where lines come from."""

    @property
    def name(self) -> str:
        """What a user calls it."""
        ...

    def heading(self) -> Sequence[bytes]:
        """Lines that were there before the run."""
        ...

    def read(self, now_s: float) -> bytes:
        """Bytes that have come; raises `OSError` where the source is lost."""
        ...

    def close(self) -> None:
        """Give it back."""
        ...


class GrowingFile:
    """A file that another program appends to; it may appear after the run has begun.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    DataError
        Its folder is not there, or it cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.name = str(path)
        self._path = path
        self._heading: list[bytes] = []
        self._at = 0
        if not path.resolve().parent.is_dir():
            raise DataError(
                "its folder is not there", where=self.name, remedy="check --command-log"
            )
        if not path.exists():
            return
        try:
            with path.open("rb") as file:
                self._heading = file.read(HEADING_BYTES).split(b"\n")[:-1]
                # The recording begins at the next whole line.
                end = file.seek(0, 2)
                file.seek(max(0, end - HEADING_BYTES))
                begun = file.read()
                self._at = end - len(begun) + begun.rfind(b"\n") + 1
        except OSError as error:
            raise DataError(f"cannot be read: {error.strerror}", where=self.name) from None

    def heading(self) -> Sequence[bytes]:
        """Lines that were there before the run."""
        return self._heading

    def read(self, now_s: float) -> bytes:
        """What was appended; a file that was begun anew is read from its start."""
        del now_s
        try:
            size = self._path.stat().st_size
        except FileNotFoundError:
            return b""
        if size < self._at:
            self._at = 0
        if size == self._at:
            return b""
        with self._path.open("rb") as file:
            file.seek(self._at)
            data = file.read()
        self._at += len(data)
        return data

    def close(self) -> None:
        """Nothing is held open."""


class TcpLines:
    """Lines that another program sends; a lost connection is tried again once a second.

    Parameters
    ----------
    host, port
        Where it listens.

    Raises
    ------
    DeviceError
        Nobody listens there.
    """

    def __init__(self, host: str, port: int) -> None:
        self.name = f"tcp://{host}:{port}"
        self._address = (host, port)
        self._retry_s = 0.0
        try:
            self._socket: socket.socket | None = self._connect(CONNECT_S)
        except OSError as error:
            raise DeviceError(
                f"nobody sends a command log at {self.name}: {error.strerror or error}",
                remedy="start the winch controller's log first, or leave --command-log out",
            ) from None

    def heading(self) -> Sequence[bytes]:
        """None is known."""
        return ()

    def read(self, now_s: float) -> bytes:
        """What was sent.

        Raises
        ------
        OSError
            The connection is lost.
        """
        if self._socket is None:
            if now_s < self._retry_s:
                return b""
            self._retry_s = now_s + RECONNECT_EVERY_S
            self._socket = self._connect(LOOK_EVERY_S)
        data, fault = b"", OSError("the other side closed the connection")
        try:
            while chunk := self._socket.recv(65536):
                data += chunk
        except BlockingIOError:
            return data
        except OSError as error:
            fault = error
        if data:
            return data  # the fault is still there at the next look
        self.close()
        self._socket = None
        self._retry_s = now_s + RECONNECT_EVERY_S
        raise fault

    def close(self) -> None:
        """Close the connection."""
        if self._socket is not None:
            with suppress(OSError):
                self._socket.close()

    def _connect(self, timeout_s: float) -> socket.socket:
        connected = socket.create_connection(self._address, timeout_s)
        connected.setblocking(False)
        return connected
