"""What has been counted so far in a run: for the live table, the stop record and the summary."""

from dataclasses import dataclass, field

from cdpr8 import CABLES


@dataclass
class Tally:
    """Counts of one run; each field is written by one thread only.

    Attributes
    ----------
    samples, tension_n
        By cable: values written, and the newest good one.
    lost
        What was lost -> how often: ``bad_frame``, ``no_answer``, ``node_lost``,
        ``frame_dropped``, ``flagged`` (kept, but not to be used).
    frames
        Frames written.
    commands
        Rows of the command log.
    last_event
        The newest event, in words.
    expected_per_s
        By cable: how many values a second the line, or the amplifier, can give.
    """

    samples: dict[int, int] = field(default_factory=lambda: dict.fromkeys(range(1, CABLES + 1), 0))
    tension_n: dict[int, float] = field(default_factory=dict)
    lost: dict[str, int] = field(default_factory=dict)
    frames: int = 0
    commands: int = 0
    last_event: str = ""
    expected_per_s: dict[int, float] = field(default_factory=dict)

    def lose(self, what: str, count: int = 1) -> None:
        """Count what was lost."""
        self.lost[what] = self.lost.get(what, 0) + count
