"""Marker dictionaries: which bit patterns are markers, by OpenCV's names or from a file."""

from pathlib import Path
from typing import Any

from cdpr8.errors import DataError

Book = Any
"""`cv2.aruco.Dictionary`, which carries no types."""


def dictionary_names() -> tuple[str, ...]:
    """The dictionaries OpenCV brings."""
    import cv2

    return tuple(sorted(name for name in dir(cv2.aruco) if name.startswith("DICT_")))


def open_dictionary(name: str, where: str = "") -> Book:
    """The dictionary of a name.

    Parameters
    ----------
    name
        One of `dictionary_names`, or a file (YAML) as OpenCV's own dictionaries are written to.
    where
        What named it, for the message.

    Raises
    ------
    DataError
        There is none of that name (the message lists those there are), or the file holds none.
    """
    import cv2

    if name.endswith((".yml", ".yaml")):
        return _read_dictionary(name, where)
    names = dictionary_names()
    if name not in names:
        raise DataError(
            f"no marker dictionary {name!r}", where=where, allowed="one of " + ", ".join(names)
        )
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))


def _read_dictionary(name: str, where: str) -> Book:
    import cv2

    allowed = "a YAML file with nmarkers, markersize and marker_0, marker_1, ... as bits"
    if not Path(name).is_file():
        raise DataError(f"no dictionary file {name!r}", where=where, allowed=allowed)
    book: Any = cv2.aruco.Dictionary()
    try:
        storage: Any = cv2.FileStorage(name, cv2.FILE_STORAGE_READ)
        read = book.readDictionary(storage.root())
    except cv2.error:
        read = False
    if not read or book.bytesList is None or len(book.bytesList) == 0:
        raise DataError("holds no marker dictionary", where=name, allowed=allowed)
    return book


def modules_across(book: Book) -> int:
    """Modules along a marker's side, its black border included."""
    return int(book.markerSize) + 2


def marker_count(book: Book) -> int:
    """Markers in a dictionary; ids run from 0 to one less."""
    return len(book.bytesList)
