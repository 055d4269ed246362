"""Rig files: one file describes one machine (design, section 2)."""

from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.load import files_beside, find_rig_file, load_rig, packaged_rig_path, parse_rig
from cdpr8.rigfile.schema import Cable, Camera, Intrinsics, Plate, Rig

__all__ = [
    "Cable",
    "Camera",
    "Excitation",
    "Intrinsics",
    "Plate",
    "Rig",
    "files_beside",
    "find_rig_file",
    "load_rig",
    "packaged_rig_path",
    "parse_rig",
]
