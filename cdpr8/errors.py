"""What can go wrong, as exceptions that carry the sentence a user reads and the exit code.

An error is raised where the fact is known and caught once, by `cdpr8.terminal`.
"""

from enum import IntEnum


class ExitCode(IntEnum):
    """Exit codes of every command."""

    OK = 0
    CHECK_FAILED = 1
    USAGE = 2
    BAD_DATA = 3
    DEVICE = 4


class ToolkitError(Exception):
    """A fault a user can act on.

    Parameters
    ----------
    what
        What is wrong, with the offending value.
    allowed
        What would have been right.
    where
        File, line, key or column.
    remedy
        What to do about it.
    """

    exit_code = ExitCode.CHECK_FAILED

    def __init__(self, what: str, *, allowed: str = "", where: str = "", remedy: str = "") -> None:
        self.what, self.allowed, self.where, self.remedy = what, allowed, where, remedy
        super().__init__(self.sentence())

    def sentence(self) -> str:
        """The whole message on one to four lines."""
        lines = [f"{self.where}: {self.what}" if self.where else self.what]
        if self.allowed:
            lines.append(f"  allowed: {self.allowed}")
        if self.remedy:
            lines.append(f"  remedy:  {self.remedy}")
        return "\n".join(lines)


class CheckError(ToolkitError):
    """The data are readable and a check on them fails."""

    exit_code = ExitCode.CHECK_FAILED


class UsageError(ToolkitError):
    """The command line asks for something that cannot be."""

    exit_code = ExitCode.USAGE


class DataError(ToolkitError):
    """A recording or a video cannot be used as it is."""

    exit_code = ExitCode.BAD_DATA


class RigFileError(ToolkitError):
    """A rig file is wrong."""

    exit_code = ExitCode.BAD_DATA


class DeviceError(ToolkitError):
    """An amplifier, a port or a camera does not do what it must."""

    exit_code = ExitCode.DEVICE
