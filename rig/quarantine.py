"""Which nodes are silent, and when each is tried again: the others must keep their rate."""

from dataclasses import dataclass, field

FAILURES_TO_LOSE = 3
"""Failures in a row after which a node counts as lost (protocol note, section 10)."""

BACK_OFF_S = (1.0, 2.0, 5.0, 10.0)
"""Waits before a lost node is tried again; the last one repeats."""


@dataclass
class _Absence:
    since_s: float
    retry_s: float
    retries: int = 0


@dataclass
class Quarantine:
    """Failures and absences, by cable."""

    _failures: dict[int, int] = field(default_factory=dict)
    _absent: dict[int, _Absence] = field(default_factory=dict)

    def holds(self, cable: int) -> bool:
        """Whether the node is lost."""
        return cable in self._absent

    def due(self, cable: int, now_s: float) -> bool:
        """Whether a lost node is to be tried now."""
        return now_s >= self._absent[cable].retry_s

    def next_retry_s(self) -> float:
        """When the first of the lost nodes is to be tried."""
        return min(absence.retry_s for absence in self._absent.values())

    def failed(self, cable: int, now_s: float) -> bool:
        """Count a failure; True where it makes the node lost."""
        self._failures[cable] = self._failures.get(cable, 0) + 1
        if self._failures[cable] < FAILURES_TO_LOSE:
            return False
        self.lose(cable, now_s)
        return True

    def lose(self, cable: int, now_s: float, retry_after_s: float | None = None) -> None:
        """The node is lost, whatever it answered before; one lost already keeps its beginning."""
        wait_s = BACK_OFF_S[0] if retry_after_s is None else retry_after_s
        since_s = self._absent[cable].since_s if cable in self._absent else now_s
        self._absent[cable] = _Absence(since_s, now_s + wait_s)

    def answered(self, cable: int) -> None:
        """Forget the failures of a node that is not lost."""
        self._failures.pop(cable, None)

    def still_lost(self, cable: int, now_s: float) -> None:
        """A retry failed."""
        absence = self._absent[cable]
        absence.retries = min(absence.retries + 1, len(BACK_OFF_S) - 1)
        absence.retry_s = now_s + BACK_OFF_S[absence.retries]

    def back(self, cable: int) -> float:
        """The node is back; returns since when it had been lost."""
        self._failures.pop(cable, None)
        return self._absent.pop(cable).since_s
