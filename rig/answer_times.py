"""When an answer on the bus began, told from what answers take (docs/decisions/0008)."""

from rig.station import Station
from rig.transport import LineSettings, Received

JITTER_S = 0.0005
"""How much the way to the node and back may vary, in adapters, without the computer's fault."""


class AnswerTimes:
    """The least time that each node has taken to answer, and what answers take beyond it.

    Parameters
    ----------
    line
        Speed and framing.
    """

    def __init__(self, line: LineSettings) -> None:
        self._char_s = line.char_s
        self._least_s: dict[int, float] = {}

    @property
    def least_s(self) -> float:
        """The least that any node has taken: the way there and back; 0 before the first answer."""
        return min(self._least_s.values(), default=0.0)

    def began(self, station: Station, asked_s: float, received: Received) -> tuple[float, float]:
        """When an answer began, and how long it was held up.

        One that waits for its value takes up to a period more by itself: what holds it up shows
        beyond that only.

        A node takes about the same time to answer always, and the line never less than the request
        needs: the least time that a node has taken is that of the line and of this program. What
        an answer takes beyond it was held up on the way there or on the way back, and nobody can
        tell which: in adapters, up to `JITTER_S`, both alike; in a computer that was busy, most
        likely on the way back.

        Parameters
        ----------
        station
            Who answered.
        asked_s
            Just before the request was written.
        received
            The whole answer.

        Returns
        -------
        tuple of float
            When it began, on the transport's clock, and how long it was held up, in s.
        """
        received_s = received.last_byte_s - len(received.data) * self._char_s
        took_s = received_s - asked_s - len(station.request) * self._char_s
        if station.pace is not None:
            # In a sweep that keeps step with it, all may wait alike.
            self._least_s.setdefault(station.address, station.pace.least_s)
        least_s = max(0.0, min(took_s, self._least_s.get(station.address, took_s)))
        self._least_s[station.address] = least_s
        held_up_s = max(0.0, took_s - least_s - station.waits_s)
        return received_s - held_up_s + min(held_up_s, JITTER_S) / 2.0, held_up_s
