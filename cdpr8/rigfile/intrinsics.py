"""Camera intrinsics from a file: OpenCV's YAML or XML as written by calibration programs."""

from pathlib import Path
from typing import Any

from cdpr8.errors import DataError
from cdpr8.rigfile.schema import Intrinsics

ALLOWED = (
    "an OpenCV YAML or XML file with camera_matrix (3x3), distortion_coefficients, "
    "image_width and image_height"
)


def load_intrinsics(
    path: Path, *, image_size: tuple[int, int] | None = None, named_by: str = ""
) -> Intrinsics:
    """Read intrinsics from an OpenCV file.

    Parameters
    ----------
    path
        The file.
    image_size
        Width and height in px to take where the file states none.
    named_by
        What named the file, for messages.

    Raises
    ------
    DataError
        The file is missing, is no OpenCV file or holds no intrinsics.
    """
    where = f"{path} (named by {named_by})" if named_by else str(path)
    if not path.is_file():
        raise DataError("no such intrinsics file", where=where, allowed=ALLOWED)
    matrix, distortion, stated = _read(path, where)
    size = stated or image_size
    if matrix is None or matrix.shape != (3, 3) or distortion is None or size is None:
        lacking = "camera_matrix (3x3)" if matrix is None or matrix.shape != (3, 3) else ""
        lacking = lacking or ("distortion_coefficients" if distortion is None else "image size")
        raise DataError(f"holds no {lacking}", where=where, allowed=ALLOWED)
    try:
        return Intrinsics(
            width_px=size[0],
            height_px=size[1],
            fx_px=float(matrix[0, 0]),
            fy_px=float(matrix[1, 1]),
            cx_px=float(matrix[0, 2]),
            cy_px=float(matrix[1, 2]),
            distortion=tuple(float(value) for value in distortion.ravel()),
        )
    except ValueError as error:
        raise DataError(f"holds intrinsics of no camera: {error}", where=where) from None


def _read(path: Path, where: str) -> tuple[Any, Any, tuple[int, int] | None]:
    """Camera matrix, distortion and (width, height) as the file has them, None where absent."""
    import cv2

    log_level = cv2.utils.logging.getLogLevel()
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
        matrix = storage.getNode("camera_matrix").mat()
        distortion = storage.getNode("distortion_coefficients").mat()
        width = int(storage.getNode("image_width").real())
        height = int(storage.getNode("image_height").real())
        storage.release()
    except (cv2.error, SystemError):
        raise DataError("is no OpenCV file", where=where, allowed=ALLOWED) from None
    finally:
        cv2.utils.logging.setLogLevel(log_level)
    return matrix, distortion, (width, height) if width > 0 and height > 0 else None
