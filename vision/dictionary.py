"""Marker dictionaries: which bit patterns are markers, by OpenCV's names."""

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
        One of `dictionary_names`.
    where
        What named it, for the message.

    Raises
    ------
    DataError
        There is none of that name; the message lists those there are.
    """
    import cv2

    names = dictionary_names()
    if name not in names:
        raise DataError(
            f"no marker dictionary {name!r}", where=where, allowed="one of " + ", ".join(names)
        )
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))


def modules_across(book: Book) -> int:
    """Modules along a marker's side, its black border included."""
    return int(book.markerSize) + 2


def marker_count(book: Book) -> int:
    """Markers in a dictionary; ids run from 0 to one less."""
    return len(book.bytesList)
