"""Every test of properties tries the same examples each time."""

import os

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")


def pytest_xdist_auto_num_workers() -> int:
    """A process for each core and one more: many tests wait for lines and clocks."""
    return (os.cpu_count() or 1) + 1
