"""`vision plate` and `vision calibrate`: what is done once, before the experiment."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdpr8.terminal import note, progress, say, say_json, say_table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from vision.bound import ViewBound
    from vision.calibrate import Calibration
    from vision.calibration_board import BoardView, CalibrationBoard
    from vision.detect import Image


def plate(
    out: Annotated[
        Path | None, typer.Argument(help="PDF or SVG to print; left out: the prediction alone")
    ] = None,
    rig: Annotated[Path | None, typer.Option(help="rig file; default: the packaged rig")] = None,
    grid: Annotated[
        str | None, typer.Option(help="COLUMNSxROWS; default: the rig file's plate")
    ] = None,
    size_mm: Annotated[float, typer.Option(min=1.0, help="with --grid: side of a marker")] = 40.0,
    gap_mm: Annotated[float, typer.Option(min=0.5, help="with --grid: between markers")] = 10.0,
    first_id: Annotated[int, typer.Option(min=0, help="with --grid")] = 0,
    dictionary: Annotated[str, typer.Option(help="with --grid")] = "DICT_4X4_50",
    distance_m: Annotated[
        float | None, typer.Option(min=0.01, help="camera to plate; default: the rig file's")
    ] = None,
    json: Annotated[bool, typer.Option("--json", help="the prediction for machines")] = False,
) -> None:
    """Print a plate to scale, and predict how well pitch can be seen with it.

    The prediction is the Cramer-Rao bound for the rig file's camera, at noise 2/255 and blur
    0.7 px, for the rig's own view and for those one might choose instead.

    Examples: vision plate plate.pdf --grid 2x2 --size-mm 20 --gap-mm 5

    vision plate --rig rig.toml
    """
    from cdpr8.rigfile import load_rig, packaged_rig_path
    from vision.bound import bound_of_view, standard_views
    from vision.camera_model import CameraModel
    from vision.mounting import mounting_of
    from vision.plate import Plate
    from vision.plate_sheet import sheet_of, write_sheet

    machine = load_rig(rig or packaged_rig_path())
    looked_for, margin_m = _plate_of(machine, grid, size_mm, gap_mm, first_id, dictionary)
    seen = Plate.from_rig(looked_for)
    if out is not None:
        write_sheet(sheet_of(seen, margin_m), out)
    views: list[ViewBound] = []
    camera = machine.camera
    if camera is None or isinstance(camera.intrinsics, str):
        note("note: the rig file has no [camera] with intrinsics: no prediction")
    else:
        away = distance_m or 1.0
        if camera.pose is not None and machine.plate is not None:
            mounting = mounting_of(machine)
            if distance_m is None:
                gone = mounting.plate_position - mounting.camera_position
                away = float((gone @ gone) ** 0.5)
                region = CameraModel.from_intrinsics(camera.intrinsics, camera.region_of_interest)
                views.append(bound_of_view("as the rig file has it", seen, mounting, region))
        views += standard_views(seen, CameraModel.from_intrinsics(camera.intrinsics), away)
    _report_views(views, out, json)


def _plate_of(
    machine: Any, grid: str | None, size_mm: float, gap_mm: float, first_id: int, dictionary: str
) -> tuple[Any, float]:
    """Plate of the schema and its margin, from the command line or the rig file."""
    from cdpr8.errors import UsageError
    from cdpr8.rigfile import schema

    if grid is None:
        if machine.plate is None:
            raise UsageError("the rig file has no [plate]", allowed="--grid COLUMNSxROWS")
        return machine.plate, machine.plate.margin_m
    parts = grid.lower().split("x")
    if len(parts) != 2 or not all(part.isdigit() and int(part) > 0 for part in parts):
        raise UsageError(f"--grid {grid}", allowed="COLUMNSxROWS, as 2x2")
    layout = schema.Grid(
        columns=int(parts[0]),
        rows=int(parts[1]),
        size_m=size_mm / 1e3,
        gap_m=gap_mm / 1e3,
        first_id=first_id,
    )
    pose = schema.PlatePose(position_m=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), up=(0.0, 0.0, 1.0))
    if machine.plate is not None:
        pose = machine.plate.pose
    margin_m = max(gap_mm, size_mm / 6.0) / 1e3
    return schema.Plate(dictionary=dictionary, margin_m=margin_m, grid=layout, pose=pose), margin_m


def _report_views(views: "list[ViewBound]", out: Path | None, as_json: bool) -> None:
    if as_json:
        rows = [
            {
                "view": view.view,
                "sigma_roll_deg": view.sigma_deg[0],
                "sigma_pitch_deg": view.sigma_deg[1],
                "sigma_yaw_deg": view.sigma_deg[2],
                "module_px": view.module_px,
                "off_normal_deg": view.off_normal_deg,
                "warnings": list(view.warnings),
            }
            for view in views
        ]
        say_json({"written": str(out) if out else None, "views": rows})
        return
    if views:
        from rich.table import Table

        table = Table(title="one frame's standard deviation, deg", title_justify="left")
        for heading in ("view", "pitch", "roll", "yaw", "px a module"):
            table.add_column(heading)
        for view in views:
            roll, pitch, yaw = (f"{value:.4f}" for value in view.sigma_deg)
            table.add_row(view.view, pitch, roll, yaw, f"{view.module_px:.1f}")
        say_table(table)
    for view in views:
        for warning in view.warnings:
            note(f"warning: {view.view}: {warning}")
    if out is not None:
        say(f"plate: {out} (print at 100 %, then measure the ruler)")


def calibrate(
    pictures: Annotated[list[Path], typer.Argument(help="pictures, or one video, of the board")],
    chessboard: Annotated[
        str | None, typer.Option(help="COLUMNSxROWS of inner corners, as 9x6")
    ] = None,
    charuco: Annotated[str | None, typer.Option(help="COLUMNSxROWS of squares, as 5x7")] = None,
    square_mm: Annotated[float, typer.Option(min=0.1, help="side of a square")] = 25.0,
    marker_mm: Annotated[
        float | None, typer.Option(min=0.1, help="with --charuco: side of a marker")
    ] = None,
    dictionary: Annotated[str, typer.Option(help="with --charuco")] = "DICT_4X4_50",
    out: Annotated[Path, typer.Option(help="OpenCV YAML")] = Path("intrinsics.yml"),
    force: Annotated[
        bool, typer.Option("--force", help="write it even where it is not good enough")
    ] = False,
    json: Annotated[bool, typer.Option("--json", help="the verdict for machines")] = False,
) -> None:
    """Find the camera's intrinsics, and say plainly whether they are good enough.

    What is not good enough is not written, and the pictures that are missing are named.

    Examples: vision calibrate shots/*.jpg --chessboard 9x6 --square-mm 25

    vision calibrate take.mp4 --charuco 5x7 --square-mm 40 --marker-mm 20 --dictionary DICT_6X6_250
    """
    from cdpr8.errors import ExitCode
    from vision.calibrate import calibrate as fit
    from vision.calibrate import different_views, write_intrinsics
    from vision.calibration_board import board_of

    board = board_of(chessboard, charuco, square_mm, marker_mm, dictionary)
    views, size, count = _views(pictures, board)
    if len(pictures) == 1 and count > 1:
        views = different_views(views, size[0])
    found = fit(views, size)
    if found.good or force:
        write_intrinsics(found, out)
    _report_calibration(found, count, out if found.good or force else None, json)
    if not found.good:
        raise typer.Exit(int(ExitCode.CHECK_FAILED))


def _views(
    pictures: "list[Path]", board: "CalibrationBoard"
) -> "tuple[list[BoardView], tuple[int, int], int]":
    """The board wherever it is, the size of the pictures, and how many there are."""
    from cdpr8.errors import DataError

    views, size, count = [], (0, 0), 0
    with progress("finding the board", None) as step:
        for name, image in _images(pictures):
            this = (image.shape[1], image.shape[0])
            if count and this != size:
                raise DataError(
                    f"is {this[0]} x {this[1]} px, those before are {size[0]} x {size[1]} px",
                    where=name,
                    allowed="pictures of one size, by one camera at one focus",
                )
            size, count = this, count + 1
            view = board.find(image, name)
            if view is not None:
                views.append(view)
            step()
    return views, size, count


def _images(pictures: "list[Path]") -> "Iterator[tuple[str, Image]]":
    from cdpr8.runfolder.video import read_video

    for path in pictures:
        for number, (image, _) in enumerate(read_video(path)):
            yield (path.name if len(pictures) > 1 else f"{path.name} frame {number}"), image


def _report_calibration(
    found: "Calibration", count: int, written: Path | None, as_json: bool
) -> None:
    if as_json:
        say_json(
            {
                "good": found.good,
                "written": str(written) if written else None,
                "pictures": count,
                "with_board": found.pictures,
                "reprojection_px": found.reprojection_px,
                "left_out_px": found.left_out_px,
                "focal_change": found.focal_change,
                "camera_matrix": found.matrix,
                "distortion": found.distortion,
                "focal_sigma_px": list(found.focal_sigma_px),
                "principal_sigma_px": list(found.principal_sigma_px),
                "covered": found.covered,
                "faults": list(found.faults),
                "missing": list(found.missing),
            }
        )
        return
    from rich.table import Table

    matrix = found.matrix
    table = Table(title="vision calibrate", title_justify="left", show_header=False)
    rows = (
        ("pictures used", f"{found.pictures} of {count}"),
        (
            "focal length",
            f"{matrix[0, 0]:.1f} +- {found.focal_sigma_px[0]:.1f} px, "
            f"{matrix[1, 1]:.1f} +- {found.focal_sigma_px[1]:.1f} px",
        ),
        (
            "principal point",
            f"{matrix[0, 2]:.1f} +- {found.principal_sigma_px[0]:.1f} px, "
            f"{matrix[1, 2]:.1f} +- {found.principal_sigma_px[1]:.1f} px",
        ),
        ("reprojection error", f"{found.reprojection_px:.3f} px"),
        ("of pictures left out", f"{found.left_out_px:.3f} px"),
        ("focal length, a third left out", f"moves by {found.focal_change:.2%}"),
        ("parts of the picture reached", f"{found.covered:.0%}"),
        ("worst picture", f"{found.worst[0]} ({found.worst[1]:.3f} px)"),
    )
    for row in rows:
        table.add_row(*row)
    say_table(table)
    if found.good:
        say("verdict: good enough to measure with")
    else:
        say("verdict: not good enough: " + "; ".join(found.faults))
    for picture in found.missing:
        say(f"take: {picture}")
    if written:
        say(f"intrinsics: {written}")
    else:
        say("nothing was written (--force writes it all the same)")
