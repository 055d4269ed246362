"""`vision`: video to pose."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdpr8.terminal import entry, note, progress, say, say_json, say_table

if TYPE_CHECKING:
    import pandas as pd

    from cdpr8.rigfile.schema import Rig
    from vision.camera_model import CameraModel
    from vision.plate import Plate, Singles

app = typer.Typer(
    help="Video to pose: finds the marker plate in every frame.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


@app.callback()
def vision() -> None:
    """Video to pose: finds the marker plate in every frame."""


@app.command()
def track(
    source: Annotated[
        str, typer.Argument(metavar="RUN|VIDEO", help="a run (folder or name), or a video file")
    ],
    rig: Annotated[
        Path | None, typer.Option(help="rig file with camera and plate; default: the run's own")
    ] = None,
    intrinsics: Annotated[
        Path | None, typer.Option(help="video: OpenCV YAML or XML with the camera's intrinsics")
    ] = None,
    board: Annotated[
        Path | None, typer.Option(help="video: TOML with a plate or singles table")
    ] = None,
    fps: Annotated[
        float | None, typer.Option(min=0.01, help="video: frame rate, where it has no times")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="where to write the poses")] = None,
    json: Annotated[bool, typer.Option("--json", help="the summary for machines")] = False,
) -> None:
    """Write the pose in every frame, with its uncertainty, to pose.csv.

    Of a run: the platform's pose, into the run's folder (./results/RUN where that is packaged or
    read-only). Of a video: the plate's pose in the camera frame, to VIDEO.pose.csv here.

    Examples: vision track run01

    vision track take.mp4 --intrinsics camera.yml --board board.toml
    """
    notes: list[str] = []
    if _is_video(source):
        poses, written = _track_video(Path(source), rig, intrinsics, board, fps, out, notes)
    else:
        _refuse_for_run(intrinsics, board, fps)
        poses, written = _track_run(source, rig, out, notes)
    _report(source, poses, written, notes, json)


def _is_video(source: str) -> bool:
    """Whether a name is a video's: a file, or what would be one."""
    path = Path(source)
    suffixes = {".mp4", ".avi", ".mkv", ".mov", ".m4v", ".webm", ".wmv", ".mpg", ".mpeg"}
    return path.is_file() or (path.suffix.lower() in suffixes and not path.is_dir())


def _refuse_for_run(intrinsics: Path | None, board: Path | None, fps: float | None) -> None:
    from cdpr8.errors import UsageError

    options = {"--intrinsics": intrinsics, "--board": board, "--fps": fps}
    given = [option for option, value in options.items() if value is not None]
    if given:
        raise UsageError(
            f"{' and '.join(given)} with a run",
            allowed="a run has its own rig file, or the one named with --rig",
            remedy="put camera and plate into a rig file and name it with --rig",
        )


def _track_run(
    source: str, rig_file: Path | None, out: Path | None, notes: list[str]
) -> tuple["pd.DataFrame", Path]:
    from cdpr8.rigfile.load import load_rig
    from cdpr8.runfolder.find import find_run, results_folder
    from cdpr8.runfolder.read import load_run
    from cdpr8.runfolder.tables import POSE
    from vision.tables import write_poses
    from vision.track import track_run

    run = load_run(find_run(source))
    notes += run.notes
    rig: Rig | None = load_rig(rig_file) if rig_file else None
    with progress("tracking", len(run.frames) or None) as step:
        poses = track_run(run, rig=rig, step=step, notes=notes)
    results = results_folder(run.folder)
    written = out or (run.folder if results.parent == run.folder else results) / POSE.file
    write_poses(poses, POSE, written)
    return poses, written


def _track_video(
    path: Path,
    rig_file: Path | None,
    intrinsics: Path | None,
    board: Path | None,
    fps: float | None,
    out: Path | None,
    notes: list[str],
) -> tuple["pd.DataFrame", Path]:
    from vision.tables import VIDEO_POSE, write_poses
    from vision.track import track_video

    camera, looked_for = _set_up(path, rig_file, intrinsics, board)
    with progress("tracking", None) as step:
        poses = track_video(path, camera, looked_for, fps=fps, step=step, notes=notes)
    written = out or Path(f"{path.stem}.pose.csv")
    write_poses(poses, VIDEO_POSE, written)
    return poses, written


def _set_up(
    path: Path, rig_file: Path | None, intrinsics: Path | None, board: Path | None
) -> tuple["CameraModel", "Plate | Singles"]:
    """Camera and board of a video: each from its own file, else from the rig file named."""
    from cdpr8.errors import UsageError
    from cdpr8.rigfile.intrinsics import load_intrinsics
    from cdpr8.rigfile.load import load_rig
    from cdpr8.runfolder.video import read_video
    from vision.board_file import load_board
    from vision.camera_model import CameraModel
    from vision.plate import Plate

    size = next(read_video(path))[0].shape
    rig = load_rig(rig_file) if rig_file else None
    camera, looked_for = None, None
    if intrinsics is not None:
        camera = CameraModel.from_intrinsics(
            load_intrinsics(intrinsics, image_size=(size[1], size[0]))
        )
    elif rig and rig.camera and not isinstance(rig.camera.intrinsics, str):
        camera = CameraModel.from_intrinsics(rig.camera.intrinsics, rig.camera.region_of_interest)
    if board is not None:
        looked_for = load_board(board)
    elif rig and rig.plate:
        looked_for = Plate.from_rig(rig.plate)
    if camera is None or looked_for is None:
        raise UsageError(
            f"{path} is a video without a run: camera and board are not known",
            allowed="--intrinsics FILE and --board FILE, or --rig FILE with [camera] and [plate]",
        )
    return camera, looked_for


def _report(
    source: str, poses: "pd.DataFrame", written: Path, notes: list[str], as_json: bool
) -> None:
    from vision.summary import summarise

    for line in notes:
        note(f"note: {line}")
    summary = summarise(poses, notes)
    if as_json:
        result: dict[str, Any] = {"source": source, "written": str(written)}
        say_json(result | summary.as_json())
    else:
        say_table(summary.as_table(f"vision track {source}"))
        say(f"poses: {written}")


main = entry(app)
