"""The library of left-out physics: one file an effect (design, section 6).

A file holds an `EFFECT`, and that is all there is to adding one: the solver, ``model effects``,
``docs/effects.md`` and the tests that hold for all effects find it.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from model.library.discovery import library as library
    from model.library.effect import Effect as Effect
    from model.library.selection import ActiveEffect as ActiveEffect

_DOORS = {
    "ActiveEffect": "model.library.selection",
    "Effect": "model.library.effect",
    "library": "model.library.discovery",
}

__all__ = ["ActiveEffect", "Effect", "library"]


def __getattr__(name: str) -> Any:
    """Open a door when it is used: the effects themselves stand on what it leads to."""
    if name not in _DOORS:
        raise AttributeError(f"module 'model.effects' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_DOORS[name]), name)
