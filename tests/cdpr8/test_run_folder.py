"""A run folder is valid when cut at any byte, and never repaired silently."""

import json
from datetime import UTC, datetime
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from cdpr8.errors import DataError
from cdpr8.rigfile import Excitation, files_beside, load_rig, packaged_rig_path
from cdpr8.runfolder import (
    CameraStart,
    ClockAnchor,
    EventKind,
    FrameFlag,
    RunWriter,
    StartRecord,
    StopRecord,
    TensionStatus,
    document,
    find_run,
    load_run,
    read_video,
    results_folder,
    sample_data_folder,
)

ANCHOR = ClockAnchor(t_s=0.0, wall=datetime(2026, 1, 1, tzinfo=UTC))


def start_record(camera: bool = True) -> StartRecord:
    return StartRecord(
        id="test",
        simulated=True,
        rig_file="rig.toml",
        rig_sha256="0" * 64,
        excitation=Excitation(),
        motion_start_known=True,
        camera=CameraStart(source="test", fps=16.0, exposure_s=0.005, width_px=64, height_px=48)
        if camera
        else None,
        clock_anchor=ANCHOR,
    )


def write_run(folder: Path, samples: int = 40, frames: int = 20) -> None:
    generator = np.random.default_rng(1)
    with RunWriter(folder, start_record(), packaged_rig_path().read_text()) as run:
        for n in range(samples):
            run.tension.append(
                {
                    "t_s": n * 0.01,
                    "cable": n % 8 + 1,
                    "digits": n,
                    "tension_n": 0.1 * n,
                    "status": 0,
                }
            )
        for n in range(frames):
            image = generator.integers(0, 256, (48, 64), dtype=np.uint8)
            run.write_frame(image, n / 16)
        run.event(0.1, EventKind.GAP, 'a gap, with "quotes"', cable=3)
        run.stop(
            StopRecord(reason="duration", t_s=1, samples={1: 5}, frames=frames, clock_anchor=ANCHOR)
        )


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    run = load_run(tmp_path / "run")
    assert len(run.tension) == 40
    assert run.tension["tension_n"].iloc[7] == pytest.approx(0.7)
    assert run.events["detail"].iloc[0] == 'a gap, with "quotes"'
    assert run.notes == ()
    assert run.stop is not None
    assert run.cable_tension(3)["digits"].tolist() == [2, 10, 18, 26, 34]


def test_runs_and_rigs_are_read_by_the_text_of_their_paths(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    run = load_run(str(tmp_path / "run"))
    assert run.folder == tmp_path / "run"
    assert load_rig(str(run.folder / "rig.toml")) == run.rig


def test_video_is_lossless(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    generator = np.random.default_rng(1)
    frames = list(read_video(tmp_path / "run" / "video.mkv"))
    assert len(frames) == 20
    for n, (image, t_s) in enumerate(frames):
        assert np.array_equal(image, generator.integers(0, 256, (48, 64), dtype=np.uint8))
        assert t_s == pytest.approx(n / 16, abs=1e-3)


@pytest.mark.parametrize("name", ["tension.csv", "frames.csv", "events.csv"])
def test_a_table_cut_at_any_byte_loads_without_its_torn_line(tmp_path: Path, name: str) -> None:
    write_run(tmp_path / "run", samples=6, frames=3)
    path = tmp_path / "run" / name
    whole = path.read_bytes()
    rows = len(getattr(load_run(tmp_path / "run"), name.removesuffix(".csv")))
    for cut in range(len(whole)):
        path.write_bytes(whole[:cut])
        run = load_run(tmp_path / "run")
        complete_lines = whole[:cut].count(b"\n")
        table = getattr(run, name.removesuffix(".csv"))
        assert len(table) == max(0, complete_lines - 1) <= rows
        torn = cut > 0 and not whole[:cut].endswith(b"\n")
        assert any("torn last line" in note for note in run.notes) == torn


def test_a_video_cut_short_yields_its_whole_frames(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    path = tmp_path / "run" / "video.mkv"
    whole = path.read_bytes()
    generator = np.random.default_rng(1)
    truth = [generator.integers(0, 256, (48, 64), dtype=np.uint8) for _ in range(20)]
    path.write_bytes(whole[: len(whole) // 2])
    frames = [image for image, _ in read_video(path)]
    assert 5 <= len(frames) <= 11
    for image, original in zip(frames, truth, strict=False):
        assert np.array_equal(image, original)


def test_a_missing_stop_record_means_interrupted_not_broken(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    (tmp_path / "run" / "stop.json").unlink()
    run = load_run(tmp_path / "run")
    assert run.stop is None
    assert any("interrupted" in note for note in run.notes)


def test_a_damaged_cell_is_refused_with_file_line_and_column(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    path = tmp_path / "run" / "tension.csv"
    lines = path.read_text().splitlines(keepends=True)
    lines[4] = lines[4].replace("0.3", "O.3")
    path.write_text("".join(lines))
    with pytest.raises(DataError, match=r"tension\.csv:5, column tension_n"):
        load_run(tmp_path / "run")


def test_a_missing_column_is_named(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    path = tmp_path / "run" / "tension.csv"
    path.write_text(path.read_text().replace("tension_n", "force", 1))
    with pytest.raises(DataError, match="lacks the column tension_n"):
        load_run(tmp_path / "run")


def test_a_folder_with_something_in_it_is_never_written_to(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    with pytest.raises(DataError, match="nothing recorded is ever overwritten"):
        write_run(tmp_path / "run")


def test_a_later_schema_version_is_refused(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    path = tmp_path / "run" / "start.json"
    record = json.loads(path.read_text())
    record["schema_version"] = 99
    path.write_text(json.dumps(record))
    with pytest.raises(DataError, match="update the toolkit"):
        load_run(tmp_path / "run")


def test_a_damaged_start_record_names_its_key(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    path = tmp_path / "run" / "start.json"
    record = json.loads(path.read_text())
    del record["excitation"]
    path.write_text(json.dumps(record))
    with pytest.raises(DataError, match="excitation"):
        load_run(tmp_path / "run")


def test_a_missing_run_lists_those_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_run(Path("runs/monday"))
    assert find_run("monday") == Path("runs/monday")
    with pytest.raises(DataError, match="monday"):
        find_run("tuesday")


def test_results_of_packaged_runs_go_to_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write_run(Path("runs/monday"))
    assert results_folder(Path("runs/monday")) == Path("runs/monday/results")
    assert results_folder(sample_data_folder() / "run01") == Path("results/run01")


def test_a_text_file_is_not_a_video(tmp_path: Path) -> None:
    path = tmp_path / "junk.mp4"
    path.write_text("this is not a video\n" * 100)
    with pytest.raises(DataError, match="is not a video"):
        list(read_video(path))


def test_the_schemas_and_the_page_are_those_of_the_definitions() -> None:
    root = Path(__file__).parents[2]
    assert (root / "docs" / "run-folder.md").read_text() == document.page()
    for name, schema in document.schemas().items():
        assert json.loads((document.SCHEMA_FOLDER / name).read_text()) == schema


def test_the_page_tells_each_bit_its_own_meaning() -> None:
    page = document.page()
    status = page[page.index("## Status bits of") : page.index("## Flag bits of")]
    flags = page[page.index("## Flag bits of") : page.index("## Kinds of event")]
    assert "| 1 | `NET_OVERFLOW` | net overflow; not used |" in status
    assert "| 128 | `NOT_CONTIGUOUS` | the amplifier skipped values |" in status
    assert "| 1 | `DROPPED_BEFORE` | a frame was lost before this one |" in flags
    assert "| 128 | `HIGH_REPROJECTION` | the plate fits this picture worse" in flags
    for section, bits in ((status, TensionStatus), (flags, FrameFlag)):
        rows = [line for line in section.splitlines() if line.startswith("| ") and "`" in line]
        assert len(rows) == len(bits)
        meanings = {line.rsplit("|", 2)[1] for line in rows}
        assert len(meanings) == len(rows)
    assert not any(line in flags for line in status.splitlines() if "`" in line and "_" in line)


def schema_faults(value: object, schema: dict[str, object]) -> list[str]:
    return [fault.message for fault in jsonschema.Draft202012Validator(schema).iter_errors(value)]


def test_a_written_run_obeys_the_schemas(tmp_path: Path) -> None:
    write_run(tmp_path / "run")
    schemas = document.schemas()
    for record in ("start", "stop"):
        value = json.loads((tmp_path / "run" / f"{record}.json").read_text())
        assert list(schema_faults(value, schemas[f"{record}.schema.json"])) == []
    rows = json.loads(load_run(tmp_path / "run").tension.to_json(orient="records"))
    assert len(rows) == 40
    for row in rows:
        assert list(schema_faults(row, schemas["tension.row.schema.json"])) == []


def test_a_run_carries_the_intrinsics_file_that_its_rig_names(tmp_path: Path) -> None:
    text = packaged_rig_path().read_text()
    first, last = text.index("[camera.intrinsics]"), text.index("[camera.pose]")
    text = text[:first].replace("[camera]\n", '[camera]\nintrinsics = "lens.yml"\n') + text[last:]
    (tmp_path / "lens.yml").write_text(
        "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 1024\n"
        "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
        "   data: [ 1500., 0., 640., 0., 1500., 512., 0., 0., 1. ]\n"
        "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
        "   data: [ 0., 0., 0., 0., 0. ]\n"
    )
    RunWriter(tmp_path / "run", start_record(), text, files_beside(text, tmp_path)).close()
    camera = load_run(tmp_path / "run").rig.camera
    assert camera is not None
    assert not isinstance(camera.intrinsics, str)
    assert camera.intrinsics.fx_px == 1500.0
