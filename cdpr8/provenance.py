"""What a result came from: versions of the toolkit and its libraries, and hashes of inputs."""

import platform
from importlib import metadata

RECORDED_PACKAGES = ("cdpr8", "numpy", "scipy", "numba", "pandas", "av", "pyserial")
OPENCV_PACKAGES = (
    "opencv-contrib-python-headless",
    "opencv-contrib-python",
    "opencv-python-headless",
    "opencv-python",
)


def versions() -> dict[str, str]:
    """Versions of Python, the toolkit and the libraries that shape its numbers."""
    found = {"python": platform.python_version()}
    for name in RECORDED_PACKAGES + OPENCV_PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found
