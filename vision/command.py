"""`vision`: video to pose."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdpr8.terminal import entry, note, progress, say, say_json, say_table
from vision.setup_command import calibrate, plate

if TYPE_CHECKING:
    import pandas as pd

    from cdpr8.rigfile.schema import Rig
    from vision.camera_model import CameraModel
    from vision.plate import Plate, Singles
    from vision.refine import Refinement

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
    refine: Annotated[
        str | None,
        typer.Option(help="corners or photometric; default: photometric, corners for singles"),
    ] = None,
    zero: Annotated[
        str | None,
        typer.Option(metavar="rest|RUN", help="run: what is zero, its own rest or a still run"),
    ] = None,
    self_calibrate: Annotated[
        bool, typer.Option("--self-calibrate", help="run: find where the markers really are")
    ] = False,
    row_delay: Annotated[
        float | None,
        typer.Option(help="run: rolling shutter, seconds from row to row", show_default="rig file"),
    ] = None,
    follow: Annotated[
        bool, typer.Option("--follow", help="run: one that is still being recorded")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="where to write the poses")] = None,
    json: Annotated[bool, typer.Option("--json", help="the summary for machines")] = False,
) -> None:
    """Write the pose in every frame, with its uncertainty, to pose.csv.

    Of a run: the platform's pose, into the run's folder (./results/RUN where that is packaged or
    read-only). Of a video: the plate's pose in the camera frame, to VIDEO.pose.csv here.

    Examples: vision track run01

    vision track run01 --zero rest --self-calibrate

    vision track today --follow     (while it is being recorded)

    vision track take.mp4 --intrinsics camera.yml --board board.toml
    """
    notes: list[str] = []
    choice = _refinement(refine)
    if _is_video(source):
        of_runs = {
            "--zero": zero,
            "--self-calibrate": self_calibrate,
            "--row-delay": row_delay,
            "--follow": follow,
        }
        _refuse(of_runs, "a video", "runs only: their rig file says how camera and plate sit")
        poses, written = _track_video(Path(source), rig, intrinsics, board, fps, choice, out, notes)
    else:
        of_videos = {"--intrinsics": intrinsics, "--board": board, "--fps": fps}
        _refuse(of_videos, "a run", "a run has its own rig file, or the one named with --rig")
        options = {"self_calibrate": self_calibrate, "row_delay_s": row_delay, "zero": _zero(zero)}
        if follow:
            late = {"--self-calibrate": self_calibrate, "--row-delay": row_delay, "--zero": zero}
            _refuse(late, "--follow", "these need the whole run: track again once it is recorded")
            poses, written = _follow_run(source, rig, choice, out, notes, quiet=json)
        else:
            poses, written = _track_run(source, rig, choice, options, out, notes)
    _report(source, poses, written, notes, json)


def _is_video(source: str) -> bool:
    """Whether a name is a video's: a file, or what would be one."""
    path = Path(source)
    suffixes = {".mp4", ".avi", ".mkv", ".mov", ".m4v", ".webm", ".wmv", ".mpg", ".mpeg"}
    return path.is_file() or (path.suffix.lower() in suffixes and not path.is_dir())


def _refuse(options: Mapping[str, object], what: str, allowed: str) -> None:
    from cdpr8.errors import UsageError

    given = [option for option, value in options.items() if value]
    if given:
        raise UsageError(f"{' and '.join(given)} with {what}", allowed=allowed)


def _refinement(name: str | None) -> "Refinement | None":
    from cdpr8.errors import UsageError
    from vision.refine import Refinement

    if name is None:
        return None
    if name not in list(Refinement):
        raise UsageError(f"--refine {name}", allowed=" or ".join(Refinement))
    return Refinement(name)


def _zero(name: str | None) -> Any:
    from cdpr8.runfolder.find import find_run
    from cdpr8.runfolder.read import load_run

    return load_run(find_run(name)) if name not in (None, "rest") else name


def _track_run(
    source: str,
    rig_file: Path | None,
    refinement: "Refinement | None",
    options: dict[str, Any],
    out: Path | None,
    notes: list[str],
) -> tuple["pd.DataFrame", Path]:
    from cdpr8.crew import USUAL
    from cdpr8.rigfile.load import load_rig
    from cdpr8.runfolder.find import find_run
    from cdpr8.runfolder.read import load_run
    from cdpr8.runfolder.tables import POSE
    from vision.tables import write_poses
    from vision.tracked_run import track_run

    run = load_run(find_run(source))
    notes += run.notes
    rig: Rig | None = load_rig(rig_file) if rig_file else None
    with progress("tracking", len(run.frames) or None) as step:
        poses = track_run(
            run, rig=rig, refinement=refinement, step=step, notes=notes, workers=USUAL, **options
        )
    written = out or _pose_file(run.folder)
    write_poses(poses, POSE, written)
    return poses, written


def _pose_file(folder: Path) -> Path:
    from cdpr8.runfolder.find import results_folder
    from cdpr8.runfolder.tables import POSE

    results = results_folder(folder)
    return (folder if results.parent == folder else results) / POSE.file


def _follow_run(
    source: str,
    rig_file: Path | None,
    refinement: "Refinement | None",
    out: Path | None,
    notes: list[str],
    *,
    quiet: bool,
) -> tuple["pd.DataFrame", Path]:
    from cdpr8.rigfile.load import load_rig
    from cdpr8.runfolder.find import find_run
    from cdpr8.runfolder.tables import POSE
    from vision.follow import follow_run
    from vision.tables import write_poses

    folder = find_run(source)
    rig = load_rig(rig_file) if rig_file else None
    show = None if quiet else lambda live: say(live.sentence())
    poses = follow_run(folder, rig=rig, refinement=refinement, show=show, notes=notes)
    written = out or _pose_file(folder)
    write_poses(poses, POSE, written)
    return poses, written


def _track_video(
    path: Path,
    rig_file: Path | None,
    intrinsics: Path | None,
    board: Path | None,
    fps: float | None,
    refinement: "Refinement | None",
    out: Path | None,
    notes: list[str],
) -> tuple["pd.DataFrame", Path]:
    from vision.tables import VIDEO_POSE, write_poses
    from vision.tracked_video import track_video

    camera, looked_for = _set_up(path, rig_file, intrinsics, board)
    with progress("tracking", None) as step:
        poses = track_video(
            path, camera, looked_for, fps=fps, refinement=refinement, step=step, notes=notes
        )
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


@app.command()
def overlay(
    source: Annotated[
        str, typer.Argument(metavar="RUN|VIDEO", help="a run (folder or name), or a video file")
    ],
    rig: Annotated[Path | None, typer.Option(help="rig file; default: the run's own")] = None,
    intrinsics: Annotated[Path | None, typer.Option(help="video: OpenCV YAML or XML")] = None,
    board: Annotated[Path | None, typer.Option(help="video: TOML with the board")] = None,
    fps: Annotated[float, typer.Option(min=1.0, help="of the video written")] = 16.0,
    out: Annotated[Path | None, typer.Option(help="default: NAME.overlay.mp4 here")] = None,
    json: Annotated[bool, typer.Option("--json", help="the result for machines")] = False,
) -> None:
    """Write the video anew with markers, axes, errors and flags drawn on every frame.

    Example: vision overlay run01
    """
    from vision.overlay import write_overlay

    if _is_video(source):
        path, frames = Path(source), None
        camera, looked_for = _set_up(path, rig, intrinsics, board)
        written = out or Path(f"{path.stem}.overlay.mp4")
    else:
        from cdpr8.rigfile.load import load_rig
        from cdpr8.runfolder.find import find_run
        from cdpr8.runfolder.read import load_run
        from vision.tracked_run import camera_and_plate

        of_videos = {"--intrinsics": intrinsics, "--board": board}
        _refuse(of_videos, "a run", "a run has its own rig file, or the one named with --rig")
        run = load_run(find_run(source))
        camera, looked_for = camera_and_plate(run, load_rig(rig) if rig else None)
        assert run.video is not None
        path, frames = run.video, len(run.frames) or None
        written = out or Path(f"{run.name}.overlay.mp4")
    with progress("drawing", frames) as step:
        count = write_overlay(path, written, camera, looked_for, fps=fps, step=step)
    if json:
        say_json({"source": source, "written": str(written), "frames": count})
    else:
        say(f"{count} frames: {written}")


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


app.command()(plate)
app.command()(calibrate)

main = entry(app)
