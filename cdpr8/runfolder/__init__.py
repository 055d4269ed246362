"""Run folders: how a recording lies on disk (design, section 3; docs/run-folder.md)."""

from cdpr8.runfolder.find import find_run, results_folder, sample_data_folder
from cdpr8.runfolder.read import Run, load_run, read_table
from cdpr8.runfolder.records import (
    UNKNOWN,
    CameraStart,
    ClockAnchor,
    Node,
    StartRecord,
    StopRecord,
)
from cdpr8.runfolder.tables import (
    BAD_TENSION,
    POSE_AXES,
    EventKind,
    FrameFlag,
    TensionStatus,
)
from cdpr8.runfolder.video import VideoWriter, read_video
from cdpr8.runfolder.write import RawLog, RunWriter, TableWriter

__all__ = [
    "BAD_TENSION",
    "POSE_AXES",
    "UNKNOWN",
    "CameraStart",
    "ClockAnchor",
    "EventKind",
    "FrameFlag",
    "Node",
    "RawLog",
    "Run",
    "RunWriter",
    "StartRecord",
    "StopRecord",
    "TableWriter",
    "TensionStatus",
    "VideoWriter",
    "find_run",
    "load_run",
    "read_table",
    "read_video",
    "results_folder",
    "sample_data_folder",
]
