"""`--until`: a time of day as a duration."""

from datetime import datetime, timedelta

from cdpr8.errors import UsageError


def seconds_until(text: str, now: datetime) -> float:
    """Seconds from now to the next time the clock shows it.

    Parameters
    ----------
    text
        HH:MM or HH:MM:SS.
    now
        In the user's zone.

    Raises
    ------
    UsageError
        It is no time of day.
    """
    for form in ("%H:%M", "%H:%M:%S"):
        try:
            time = datetime.strptime(text, form).time()
        except ValueError:
            continue
        then = now.replace(hour=time.hour, minute=time.minute, second=time.second, microsecond=0)
        if then <= now:
            then += timedelta(days=1)
        return (then - now).total_seconds()
    raise UsageError(f"--until {text!r} is no time of day", allowed="HH:MM or HH:MM:SS")
