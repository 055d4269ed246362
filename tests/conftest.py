"""Every test of properties tries the same examples each time; what waits stands beside what works.

Tests are dealt out a module at a time (`./lab test`). Those of `rig` wait for lines and clocks, the
others keep a core busy: one after the other of each kind, all cores are busy to the end, and the
longest modules begin first, for what begins last ends last.
"""

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")

FIRST = ("analysis/challenge", "vision", "validation", "analysis")
"""Folders whose modules take longest."""

WAITS = "rig"
"""The folder whose tests wait."""


def pytest_xdist_auto_num_workers() -> int:
    """A process for each core and one more: many tests wait for lines and clocks."""
    return (os.cpu_count() or 1) + 1


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Modules of `FIRST` first, and those that wait spread among the others."""
    here = Path(__file__).parent
    modules: dict[str, list[pytest.Item]] = {}
    for item in items:
        modules.setdefault(item.path.relative_to(here).as_posix(), []).append(item)
    waiting = [name for name in modules if name.startswith(WAITS)]
    working = sorted((name for name in modules if not name.startswith(WAITS)), key=_place)
    items[:] = [item for name in _spread(working, waiting) for item in modules[name]]


def _place(name: str) -> int:
    """Where a module's folder stands in `FIRST`; behind all of them, where it does not."""
    return next((i for i, folder in enumerate(FIRST) if name.startswith(folder)), len(FIRST))


def _spread(*kinds: list[str]) -> list[str]:
    """All modules, those of each kind at even distances and in their order."""
    placed = ((i / len(kind), name) for kind in kinds for i, name in enumerate(kind))
    return [name for _, name in sorted(placed, key=lambda one: one[0])]
