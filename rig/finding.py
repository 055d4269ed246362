"""One line of a run's health report."""

from dataclasses import dataclass
from enum import StrEnum


class Verdict(StrEnum):
    """What a check found."""

    OK = "ok"
    WARN = "warn"
    FAIL = "FAIL"


@dataclass(frozen=True)
class Finding:
    """One line of the report.

    Attributes
    ----------
    verdict, what, words
        How it stands, what was looked at, and the figures.
    """

    verdict: Verdict
    what: str
    words: str
