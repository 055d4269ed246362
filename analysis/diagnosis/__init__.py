"""`analysis diagnose`: the engine on runs of CDPR-8."""

from typing import Any

__all__ = ["diagnose_recordings", "diagnose_runs", "prepare"]


def __getattr__(name: str) -> Any:
    """Open a door when it is used, so that ``--help`` does not wait for NumPy."""
    if name not in __all__:
        raise AttributeError(f"module 'analysis.diagnosis' has no attribute {name!r}")
    if name == "prepare":
        from analysis.diagnosis.prepare import prepare

        return prepare
    from analysis.diagnosis import run

    return getattr(run, name)
