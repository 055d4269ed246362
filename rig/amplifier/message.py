"""Commands and answers as text: three letters, parameters, a semicolon (sections 2 and 3)."""

import re

from cdpr8.errors import DeviceError

END = b";"
"""Ends a command; alone, it clears a node's input buffer."""

ACCEPTED = b"0\r\n"
REFUSED = b"?\r\n"
LINE_END = b"\r\n"

_NUMBERS = re.compile(rb" *[+-]?\d+(, *[+-]?\d+)*\r\n")

BROADCAST = 98
"""`S98;` addresses every node, and none answers."""

ADDRESSES = range(32)


TRIGGER = b"S98;MSV?;"
"""Has every node measure its next value and hold it until it is selected (section 9)."""

MEASURE = b"MSV?0;"
"""Has the node that is selected measure all the time: send it, unless it is in bus mode."""

ALL_MEASURE = b";S98;MSV?0;"
"""Has every node measure all the time."""

ALL_STOP = b";S98;STP;"


def command(mnemonic: str, *parameters: int | str) -> bytes:
    """A command: numbers as they are, texts in double quotes (section 2)."""
    spelled = (f'"{item}"' if isinstance(item, str) else str(item) for item in parameters)
    return (mnemonic + ",".join(spelled)).encode("ascii") + END


def query(mnemonic: str) -> bytes:
    """A question."""
    return mnemonic.encode("ascii") + b"?" + END


def select(address: int) -> bytes:
    """`Sxx;`: the node listens until another S; in bus mode it answers with its newest value."""
    return f"S{address:02d}".encode("ascii") + END


def next_value(address: int, nobody: int) -> bytes:
    """What asks one node for a value where it gives none when it is selected.

    Parameters
    ----------
    address
        Of the node.
    nobody
        An address that no node has. It is selected before: where `Sxx;` is lost on the line, the
        node that was asked before would answer in its place.
    """
    return select(nobody) + select(address) + query("MSV")


def is_line(answer: bytes) -> bool:
    """Whether an answer came to its end."""
    return answer.endswith(LINE_END)


def is_acknowledgement(answer: bytes) -> bool:
    """Whether an answer can be that to a setting."""
    return answer in (ACCEPTED, REFUSED)


def is_value(answer: bytes) -> bool:
    """Whether an answer can be that to the question for a setting: numbers, or refused."""
    return answer == REFUSED or _NUMBERS.fullmatch(answer) is not None


def is_identity(answer: bytes) -> bool:
    """Whether an answer can be that to `IDN?`: no other has letters and three commas."""
    return answer.count(b",") >= 3


def parse_integer(answer: bytes, asked: str) -> int:
    """The number in an answer of whatever width.

    Raises
    ------
    DeviceError
        The answer is no number.
    """
    try:
        return int(answer.removesuffix(LINE_END))
    except ValueError:
        raise DeviceError(
            f"{asked} was answered with {answer!r}", allowed="a whole number and CR LF"
        ) from None
