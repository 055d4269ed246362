"""The tables of a run folder: their columns, units and meaning (design, section 3).

One definition serves the writer, the reader, the JSON Schemas and docs/run-folder.md.
"""

from dataclasses import dataclass
from enum import IntFlag, StrEnum
from itertools import combinations
from typing import Literal

SCHEMA_VERSION = 1
"""Version of the run folder that this toolkit writes; it reads all versions up to this one."""

POSE_AXES = ("x_m", "y_m", "z_m", "roll_deg", "pitch_deg", "yaw_deg")
"""The pose columns, in the order of the paper's X = [X_p, Y_p, Z_p, phi, theta, psi]."""


class TensionStatus(IntFlag):
    """Bits of `status` in tension.csv: the amplifier's status byte, then the host's own flags."""

    NET_OVERFLOW = 1
    GROSS_OVERFLOW = 2
    ADC_OVERFLOW = 4
    STANDSTILL = 8
    LIMIT_1 = 16
    LIMIT_2 = 32
    TRIGGER = 64
    NOT_CONTIGUOUS = 128
    HOST_OVERLOAD = 256
    STALE = 512
    UNCONFIRMED = 1024
    UNTIMED = 2048


BAD_TENSION = (
    TensionStatus.NET_OVERFLOW
    | TensionStatus.GROSS_OVERFLOW
    | TensionStatus.ADC_OVERFLOW
    | TensionStatus.STALE
    | TensionStatus.UNCONFIRMED
    | TensionStatus.UNTIMED
)
"""A sample with any of these bits is kept and never used as a measured value."""


class FrameFlag(IntFlag):
    """Bits of `flags` in frames.csv and pose.csv."""

    DROPPED_BEFORE = 1
    REPEATED = 2
    BLACK = 4
    NO_MARKER = 8
    FEW_MARKERS = 16
    AMBIGUOUS = 32
    BRANCH_FROM_PREVIOUS = 64
    HIGH_REPROJECTION = 128


class EventKind(StrEnum):
    """Kinds of event in events.csv."""

    MOTION_START = "motion_start"
    MOTION_END = "motion_end"
    GAP = "gap"
    BAD_FRAME = "bad_frame"
    NODE_LOST = "node_lost"
    NODE_BACK = "node_back"
    OVERLOAD = "overload"
    FRAME_DROPPED = "frame_dropped"
    CLOCK_ANCHOR = "clock_anchor"
    SYNC_TAP = "sync_tap"
    INTERRUPTED = "interrupted"
    LINE_LOST = "line_lost"
    LINE_BACK = "line_back"
    PAUSE = "pause"
    CLOCK_STEP = "clock_step"
    DISK_FULL = "disk_full"
    STRAY_BYTES = "stray_bytes"
    COMMAND_LOG = "command_log"


@dataclass(frozen=True)
class Column:
    """One column: what a cell holds, and whether it may be empty or left out (not measured).

    With `left_out` the column may be left out as a whole, by other programs: it then holds that.
    """

    name: str
    type: Literal["number", "integer", "string"]
    meaning: str
    unit: str = ""
    optional: bool = False
    digits: int | None = None
    left_out: int | None = None


@dataclass(frozen=True)
class Table:
    """One CSV file of a run folder."""

    file: str
    meaning: str
    columns: tuple[Column, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Column names, in order."""
        return tuple(column.name for column in self.columns)


TENSION = Table(
    "tension.csv",
    "One row a sample, with its own time; the eight of a broadcast sweep have one time.",
    (
        Column("t_s", "number", "estimated sampling instant, tension clock", "s", digits=6),
        Column("cable", "integer", "cable number, 1 to 8"),
        Column("digits", "integer", "raw value of the amplifier, never altered", optional=True),
        Column("tension_n", "number", "digits, scaled: positive pulls", "N", digits=6),
        Column("status", "integer", "status bits, see below", left_out=0),
        Column("request_s", "number", "when the value was asked for, or triggered", "s", True, 6),
        Column("received_s", "number", "when its last byte had come", "s", True, 6),
    ),
)

FRAMES = Table(
    "frames.csv",
    "One row a frame of video.mkv, in order.",
    (
        Column("frame", "integer", "frame number from 0, the order in video.mkv"),
        Column("t_s", "number", "mid-exposure, camera clock", "s", digits=6),
        Column("flags", "integer", "frame flag bits, see below", left_out=0),
    ),
)

EVENTS = Table(
    "events.csv",
    "What happened, in the order it was noticed.",
    (
        Column("t_s", "number", "when it was noticed", "s", digits=6),
        Column("kind", "string", "kind of event, see below"),
        Column("cable", "integer", "cable number, where it concerns one", "", True),
        Column("detail", "string", "in words, with the values", "", True),
    ),
)

COMMAND = Table(
    "command.csv",
    "The winch controller's own log, where there is one: any of the four quantities.",
    (
        Column("t_s", "number", "of the row, on the tension clock", "s", digits=6),
        Column("cable", "integer", "cable number, 1 to 8"),
        Column("commanded_m", "number", "unstretched length commanded", "m", True, 9),
        Column("measured_m", "number", "unstretched length measured", "m", True, 9),
        Column("commanded_deg", "number", "winch angle commanded", "deg", True, 6),
        Column("measured_deg", "number", "winch angle measured (encoder)", "deg", True, 6),
        Column("log_s", "number", "the log's own time, never altered", "s", True, 6),
        Column("arrived_s", "number", "when the row had come, where it was recorded", "s", True, 6),
    ),
)

POSE = Table(
    "pose.csv",
    "Written by `vision track`: pose of the centre of mass in O-XYZ, one row a frame.",
    (
        Column("frame", "integer", "frame number of video.mkv"),
        Column("t_s", "number", "mid-exposure", "s", digits=6),
        *(Column(name, "number", "pose", name.rsplit("_", 1)[1], True, 9) for name in POSE_AXES),
        *(
            Column(f"sigma_{name}", "number", "standard deviation", name.rsplit("_", 1)[1], True, 9)
            for name in POSE_AXES
        ),
        *(
            Column(
                f"corr_{a.rsplit('_', 1)[0]}_{b.rsplit('_', 1)[0]}",
                "number",
                "correlation",
                "",
                True,
                4,
            )
            for a, b in combinations(POSE_AXES, 2)
        ),
        Column("markers", "integer", "markers used", left_out=0),
        Column("reproj_px", "number", "rms reprojection error", "px", True, 4),
        Column("ratio", "number", "second-best over best reprojection error", "", True, 3),
        Column("flags", "integer", "frame flag bits, see below", left_out=0),
        Column("blur_px", "number", "standard deviation of the point spread", "px", True, 3),
    ),
)

TABLES = (TENSION, FRAMES, EVENTS, COMMAND, POSE)
