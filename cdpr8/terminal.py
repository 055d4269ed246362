"""The one module that owns terminal output, exit codes and how an error is told.

Results go to standard output; progress, notes and errors to standard error, so that a pipe or
``--json`` carries results alone.
"""

import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from cdpr8.errors import DataError, ExitCode, ToolkitError

if TYPE_CHECKING:
    import typer
    from rich.table import Table


def run_app(app: "typer.Typer", arguments: Sequence[str] | None = None) -> int:
    """Run a command line and turn every outcome into an exit code.

    Parameters
    ----------
    app
        The commands.
    arguments
        What follows the program's name; None takes the process's own.

    Returns
    -------
    int
        0 ok, 1 a check failed, 2 usage, 3 bad data or rig file, 4 device.
    """
    import typer.main

    command = typer.main.get_command(app)
    try:
        # Typer itself tells usage errors and an abort, and leaves with their code.
        command.main(args=None if arguments is None else list(arguments))
    except SystemExit as left:
        return left.code if isinstance(left.code, int) else ExitCode.OK
    except ToolkitError as error:
        complain(error.sentence())
        return int(error.exit_code)
    except BrokenPipeError:
        return ExitCode.OK
    except OSError as error:
        # A file that a command could not foresee: a folder that is not there, a disk that is full.
        complain(_unusable(error).sentence())
        return int(ExitCode.BAD_DATA)
    return ExitCode.OK


def _unusable(error: OSError) -> DataError:
    named = "" if error.filename is None else str(error.filename)
    return DataError(
        f"cannot be used: {error.strerror or error}",
        where=named,
        remedy="name a place that is there, has room, and that you may read and write",
    )


def entry(app: "typer.Typer") -> Callable[[], None]:
    """The console entry point of a set of commands."""

    def main() -> None:
        sys.exit(run_app(app))

    return main


def say(text: str) -> None:
    """One line of result."""
    print(text, flush=True)


def note(text: str) -> None:
    """One line that is not a result: what is being done, or what a user must know."""
    print(text, file=sys.stderr, flush=True)


def complain(text: str) -> None:
    """One error."""
    print(f"error: {text}", file=sys.stderr, flush=True)


def alarm(text: str) -> None:
    """One error that cannot wait, with the terminal's bell."""
    complain(text)
    # Past what is printed: a live view takes control characters out of that.
    terminal = sys.__stderr__
    if terminal is not None and terminal.isatty():
        terminal.write("\a")
        terminal.flush()


def say_json(value: Any) -> None:
    """A result for machines: strict JSON (no NaN; what is not known is null)."""
    print(json.dumps(_strict(value), indent=1, allow_nan=False), flush=True)


def say_table(table: "Table") -> None:
    """A result for people; as wide as it is: figures are never cut to fit a terminal."""
    from rich.console import Console
    from rich.measure import Measurement

    console = Console()
    natural = Measurement.get(console, console.options.update(max_width=1000), table).maximum
    Console(width=max(console.width, natural)).print(table)


@contextmanager
def progress(what: str, total: int | None) -> Iterator[Callable[[], None]]:
    """A progress bar on standard error; call what it yields once a step.

    Where standard error is no terminal nothing is drawn.
    """
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)


@contextmanager
def stages() -> Iterator[Callable[[str, int, int], None]]:
    """A progress bar for work of several stages; call what it yields with (stage, done, total).

    Where standard error is no terminal nothing is drawn.
    """
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=None)
        yield lambda stage, done, total: bar.update(
            task, description=stage, completed=done, total=total
        )


def _strict(value: Any) -> Any:
    if isinstance(value, dict):
        return {str(key): _strict(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_strict(item) for item in value]
    if hasattr(value, "tolist"):
        return _strict(value.tolist())
    if isinstance(value, float) and not abs(value) < float("inf"):
        return None
    return value
