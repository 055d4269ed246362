"""HBM AED/AD transducer electronics: their messages, value frames, dialects and scaling.

Section numbers in docstrings are those of the protocol note (docs/amplifiers.md).
"""

from rig.amplifier.frame import BadFrameError, FrameFormat, Reading, ValueFormat
from rig.amplifier.node import NodeClient, Settings
from rig.amplifier.profile import Identity, Profile
from rig.amplifier.scaling import Scaling
from rig.amplifier.text_frame import TextFormat

__all__ = [
    "BadFrameError",
    "FrameFormat",
    "Identity",
    "NodeClient",
    "Profile",
    "Reading",
    "Scaling",
    "Settings",
    "TextFormat",
    "ValueFormat",
]
