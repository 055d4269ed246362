"""The inverse problem of the paper's missing Table I: which machine gives the published figures."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from model.reconstruct.layout import Layout as Layout
    from model.reconstruct.search import search as search

_DOORS = {"Layout": "model.reconstruct.layout", "search": "model.reconstruct.search"}

__all__ = ["Layout", "search"]


def __getattr__(name: str) -> Any:
    """Open a door when it is used, so that ``--help`` does not wait for NumPy."""
    if name not in _DOORS:
        raise AttributeError(f"module 'model.reconstruct' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_DOORS[name]), name)
