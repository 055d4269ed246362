"""Motions beyond the rig file's sine: each satisfies `model.motion.Motion`, on all six axes."""

from model.motions.free_decay import FreeDecay
from model.motions.multisine import Multisine
from model.motions.pose import COORDINATES, Pose, along
from model.motions.recorded import COLUMNS, Recorded
from model.motions.staircase import Staircase
from model.motions.windowed import Times, Windowed
from model.motions.words import motion_of

__all__ = [
    "COLUMNS",
    "COORDINATES",
    "FreeDecay",
    "Multisine",
    "Pose",
    "Recorded",
    "Staircase",
    "Times",
    "Windowed",
    "along",
    "motion_of",
]
