"""Whether a board fits what a video shows; where it does not, what is wrong, in one message."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cdpr8.errors import DataError
from vision.tracker import Sighting

MISFIT_PX = 5.0
"""A median reprojection error past this is a board of another layout, not a bad lens."""


def check_board_fits(
    sightings: Sequence[Sighting],
    frames: int,
    ids_seen: set[int],
    path: Path,
    dictionary: str,
    ids: tuple[int, ...] | None,
) -> None:
    """Refuse a video that shows nothing of the board, or a board that it does not fit.

    Parameters
    ----------
    sightings
        Of all frames.
    frames
        How many.
    ids_seen
        Markers of the dictionary that were seen, of the board or not.
    path
        The video, for messages.
    dictionary, ids
        The board's; None means every marker of the dictionary.

    Raises
    ------
    DataError
        No frame, no marker, none of the board's, or a layout that explains nothing.
    """
    if frames == 0:
        raise DataError("no frame that has a time", where=str(path))
    errors = [one.estimate.pose.reprojection_px for one in sightings if one.estimate]
    if not errors and not ids_seen:
        raise DataError(
            f"no marker of {dictionary} in any of {frames} frames",
            where=str(path),
            remedy="check the dictionary, that the markers have a white margin, focus and light; "
            "a marker needs about 20 px a side",
        )
    if not errors and not any(one.markers for one in sightings):
        raise DataError(
            f"the board does not fit: its markers are in none of {frames} frames, which show "
            f"{_listed(ids_seen)} of {dictionary}",
            where=str(path),
            allowed="markers " + _listed(ids or ()),
            remedy="correct the ids of the board",
        )
    if not errors:
        raise DataError(
            "the board does not fit: its markers are seen, and no pose puts them where they are",
            where=str(path),
            remedy="check the places of the markers: is the layout mirrored, or in another order?",
        )
    if float(np.median(errors)) > MISFIT_PX:
        raise DataError(
            f"the board does not fit: median reprojection error {np.median(errors):.1f} px",
            where=str(path),
            allowed=f"up to {MISFIT_PX:g} px (a fraction of a pixel is usual)",
            remedy="check marker sizes, gaps and places, and that the intrinsics are this camera's",
        )


def _listed(ids: set[int] | tuple[int, ...]) -> str:
    numbers = sorted(ids)
    return ", ".join(map(str, numbers[:20])) + (", ..." if len(numbers) > 20 else "")
