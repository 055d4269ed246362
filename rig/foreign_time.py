"""Dates and times of day as other programs write them."""

from contextlib import suppress
from datetime import UTC, datetime

FORMATS = (
    "%d.%m.%Y %H:%M:%S.%f",
    "%d.%m.%Y %H:%M:%S",
    "%H:%M:%S.%f",
    "%H:%M:%S",
)
"""Beside ISO 8601. No month before the day, which could not be told from a day before the month."""


def date_s(cell: str) -> float | None:
    """Seconds of a date and time, or of a time of day; None where a text is neither.

    Parameters
    ----------
    cell
        ISO 8601, German, or a time of day; with a decimal point or comma. What names no zone is
        taken as UTC: only differences are of use.
    """
    if ":" not in cell:
        return None
    spelled = cell.strip().replace(",", ".")
    with suppress(ValueError):
        return _utc_s(datetime.fromisoformat(spelled))
    for form in FORMATS:
        with suppress(ValueError):
            return _utc_s(datetime.strptime(spelled, form))
    return None


def _utc_s(when: datetime) -> float:
    """Seconds since 1970, or since another year of no meaning."""
    return (when if when.tzinfo else when.replace(tzinfo=UTC)).timestamp()
