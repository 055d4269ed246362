"""The truth, sealed: what is published beside the runs is only its SHA-256."""

import json
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from cdpr8.errors import DataError

SEALED, DIGEST, INDEX = "sealed.json", "seal.sha256", "index.json"


def seal(folder: Path, truth: Mapping[str, Any]) -> str:
    """Write the truth and its digest.

    Parameters
    ----------
    folder
        Of the challenge.
    truth
        What a JSON file can hold.

    Returns
    -------
    str
        The SHA-256, in hexadecimal.
    """
    data = json.dumps(truth, indent=1, sort_keys=True, allow_nan=False).encode() + b"\n"
    digest = sha256(data).hexdigest()
    (folder / SEALED).write_bytes(data)
    (folder / DIGEST).write_text(f"{digest}  {SEALED}\n", encoding="utf-8")
    return digest


def open_seal(folder: Path) -> tuple[dict[str, Any], str]:
    """The truth and its digest.

    Parameters
    ----------
    folder
        Of the challenge.

    Raises
    ------
    DataError
        The seal is missing or broken: the truth is not the one that was published.
    """
    path = folder / SEALED
    try:
        data = path.read_bytes()
        published = (folder / DIGEST).read_text(encoding="utf-8").split()[0]
    except (OSError, IndexError):
        raise DataError(
            "no sealed truth here", where=str(folder), remedy="make it: analysis challenge make"
        ) from None
    digest = sha256(data).hexdigest()
    if digest != published:
        raise DataError(
            f"the seal is broken: the truth has SHA-256 {digest[:12]}..., published was "
            f"{published[:12]}...",
            where=str(path),
            remedy="make the challenge again with its seed",
        )
    return dict(json.loads(data)), digest


def read_index(folder: Path) -> dict[str, Any]:
    """The public list: seed, version, and of each case its kind and runs.

    Parameters
    ----------
    folder
        Of the challenge.

    Raises
    ------
    DataError
        The folder holds no challenge.
    """
    path = folder / INDEX
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        raise DataError(
            "no challenge here", where=str(path), remedy="make one: analysis challenge make OUT"
        ) from None
