"""Video to pose: marker plates, corners, poses with their covariance, and `vision track`.

Units: px, m and rad inside; degrees in tables, where the name carries the unit. The camera frame is
OpenCV's (x right, y down, z forward), a plate's is x right, y up, z out of the print.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vision.board_file import load_board
    from vision.camera_model import CameraModel
    from vision.exposure import corrected_amplitude, exposure_attenuation
    from vision.plate import Plate, Singles
    from vision.tracked_run import track_run
    from vision.tracked_video import track_video

__all__ = [
    "CameraModel",
    "Plate",
    "Singles",
    "corrected_amplitude",
    "exposure_attenuation",
    "load_board",
    "track_run",
    "track_video",
]

_HOMES = {
    "CameraModel": "vision.camera_model",
    "Plate": "vision.plate",
    "corrected_amplitude": "vision.exposure",
    "exposure_attenuation": "vision.exposure",
    "Singles": "vision.plate",
    "load_board": "vision.board_file",
    "track_run": "vision.tracked_run",
    "track_video": "vision.tracked_video",
}


def __getattr__(name: str) -> Any:
    """Import a door when it is used: `vision --help` must not wait for NumPy and OpenCV."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'vision' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
