"""`rig verify`, `rig export` and `rig import`: recorded runs."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdpr8.terminal import note, say, say_json

if TYPE_CHECKING:
    from rig.import_run import ImportedCommand


def verify_command(
    run: Annotated[str, typer.Argument(help="A run folder, or its name.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Report the health of a run: rates, gaps, losses, overloads, clocks.

    Example: rig verify runs/first
    """
    from cdpr8.errors import CheckError
    from cdpr8.runfolder import find_run, load_run
    from rig.finding import Verdict
    from rig.verify import verify

    folder = find_run(run)
    findings = verify(load_run(folder))
    if as_json:
        say_json([{"verdict": f.verdict, "what": f.what, "words": f.words} for f in findings])
    else:
        for each in findings:
            say(f"{each.verdict.value:<5} {each.what:<10} {each.words}")
    bad = [each.what for each in findings if each.verdict is Verdict.FAIL]
    if bad:
        raise CheckError(f"not in order: {', '.join(bad)}", where=str(folder))


def export_command(
    run: Annotated[str, typer.Argument(help="A run folder, or its name.")],
    parquet: Annotated[
        bool, typer.Option("--parquet", help="One Parquet file a table, into a folder.")
    ] = False,
    mcap: Annotated[
        bool, typer.Option("--mcap", help="One MCAP file with pictures, for Foxglove.")
    ] = False,
    out: Annotated[Path | None, typer.Option(help="Where to.  [default: ./NAME.mcap]")] = None,
) -> None:
    """Write a run for other programs.

    Example: rig export runs/first --mcap
    """
    from cdpr8.errors import UsageError
    from cdpr8.runfolder import find_run, load_run
    from rig.export import export_mcap, export_parquet

    if parquet == mcap:
        raise UsageError("nothing or both to export", allowed="either --parquet or --mcap")
    loaded = load_run(find_run(run))
    if parquet:
        written = export_parquet(loaded, out or Path(f"{loaded.name}-parquet"))
    else:
        written = [export_mcap(loaded, out or Path(f"{loaded.name}.mcap"))]
    for path in written:
        say(f"wrote {path} ({path.stat().st_size / 1e6:.2f} MB)")


def import_command(
    tension: Annotated[Path, typer.Option(help="Table of tensions: text.")],
    map_: Annotated[
        str,
        typer.Option("--map", help="Which column is what: time=COLUMN,1=COLUMN,2=COLUMN ..."),
    ],
    video: Annotated[Path | None, typer.Option(help="Any video that FFmpeg reads.")] = None,
    sync: Annotated[
        list[str] | None,
        typer.Option(help="An event seen in both, TABLE=VIDEO in s; twice also tells the rate."),
    ] = None,
    command: Annotated[
        Path | None, typer.Option(help="Log of the winch controller: text, with a time.")
    ] = None,
    command_map: Annotated[
        str | None,
        typer.Option(
            help="Which of its columns is what: time=COLUMN,1=COLUMN,2.measured_deg=COLUMN ...  "
            "[default: its columns are those of command.csv]"
        ),
    ] = None,
    command_sync: Annotated[
        list[str] | None,
        typer.Option(help="An event seen in both, TABLE=LOG in s; twice also tells the rate."),
    ] = None,
    rig: Annotated[Path | None, typer.Option("--rig", help="Rig file of the machine.")] = None,
    name: Annotated[str, typer.Option(help="Name of the run: the folder runs/NAME.")] = "imported",
) -> None:
    """Make a run of a video and a tension table that other programs recorded.

    Example: rig import --video test.avi --tension test.asc
    --map "time=Time,1=Force 1,2=Force 2" --sync 2.31=1.04 --sync 58.77=57.49
    """
    from cdpr8.rigfile import files_beside, find_rig_file, load_rig
    from rig.foreign import ClockMap, ColumnMap, conversions
    from rig.foreign_table import read_foreign_table
    from rig.import_run import import_run
    from rig.run_name import named_run

    path = find_rig_file(rig)
    taps = [_tap(words, "--sync") for words in sync or []]
    columns = ColumnMap.parse(map_)
    clock = ClockMap.of(taps)
    if video is not None and not taps:
        note("no --sync: the video is taken to start with the table")
    folder = named_run(name)
    rig_text = path.read_text(encoding="utf-8")
    table = read_foreign_table(tension)
    for words in conversions(table, columns, str(tension)):
        note(f"the column {words}")
    stop = import_run(
        folder,
        load_rig(path),
        rig_text,
        str(path),
        table,
        columns,
        str(tension),
        video=video,
        clock=clock,
        taps=tuple(taps),
        beside_rig=files_beside(rig_text, path.parent),
        command=_imported_command(command, command_map, command_sync or []),
    )
    count = sum(stop.samples.values())
    say(f"run {folder}: {stop.t_s:.1f} s, {count} values, {stop.frames} frames")
    say(f"next:   rig verify {folder}")


def _imported_command(
    path: Path | None, map_: str | None, sync: list[str]
) -> "ImportedCommand | None":
    from cdpr8.errors import UsageError
    from rig.command_columns import CommandColumns, read_command_table
    from rig.foreign import ClockMap
    from rig.import_run import ImportedCommand

    if path is None:
        if map_ is not None or sync:
            raise UsageError("--command-map or --command-sync without --command")
        return None
    columns = CommandColumns.parse(map_)
    clock = ClockMap.of([_tap(words, "--command-sync") for words in sync])
    if not sync:
        note("no --command-sync: the command log is taken to have the table's time")
    text = f"{path}: {columns.text}; {clock.offset_s:+.6f} s, rate {clock.rate:.9f}"
    return ImportedCommand(read_command_table(path, columns), clock, text)


def _tap(words: str, option: str) -> tuple[float, float]:
    from cdpr8.errors import UsageError

    try:
        table_s, other_s = (float(word) for word in words.split("="))
    except ValueError:
        raise UsageError(
            f"{option} {words!r} is no pair of times", allowed="TABLE=OTHER, both in s: 2.31=1.04"
        ) from None
    return table_s, other_s
