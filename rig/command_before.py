"""`rig doctor`, `rig zero` and `rig pretension`: before a run."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdpr8.terminal import note, say, say_json

if TYPE_CHECKING:
    from cdpr8.rigfile import Rig
    from rig.sampler import Sampler

RigOption = Annotated[
    Path | None,
    typer.Option("--rig", help="Rig file.  [default: ./rig.toml, else the packaged CDPR-8]"),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]


def doctor_command(rig: RigOption = None, as_json: JsonOption = False) -> None:
    """Look whether this computer is fit to record: one verdict a line, with its remedy.

    Example: rig doctor --rig lab.toml
    """
    from cdpr8.errors import CheckError
    from cdpr8.rigfile import find_rig_file, load_rig
    from rig.doctor import diagnose
    from rig.finding import Verdict
    from rig.run_name import RUNS

    found = list(diagnose(load_rig(find_rig_file(rig)), RUNS))
    if as_json:
        say_json(
            [
                {"verdict": d.verdict, "what": d.what, "words": d.words, "remedy": d.remedy}
                for d in found
            ]
        )
    else:
        for each in found:
            remedy = f"; {each.remedy}" if each.remedy else ""
            say(f"{each.verdict.value:<5} {each.what:<10} {each.words}{remedy}")
    bad = [each.what for each in found if each.verdict is Verdict.FAIL]
    if bad:
        raise CheckError(f"not fit to record: {', '.join(bad)}")


def zero_command(
    rig: RigOption = None,
    seconds: Annotated[
        float, typer.Option("--for", min=0.2, max=600.0, help="Mean over this many s.")
    ] = 2.0,
    out: Annotated[
        Path | None, typer.Option(help="Zeros file.  [default: zeros.json beside the rig file]")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Take the zeros of the force cells: every cable hanging free and still.

    The amplifiers' own tare is left alone; `rig record` reads the zeros and start.json keeps them.

    Example: rig zero --rig lab.toml
    """
    from datetime import UTC, datetime

    from cdpr8.rigfile import find_rig_file, load_rig
    from rig.zeros import Zeros, default_zeros_path, take_zero, write_zeros

    path = find_rig_file(rig)
    machine = load_rig(path)
    _say_simulated(machine)
    with _sampler(machine) as sampler:
        values = sampler.signals_mv_per_v(seconds)
        serials = {each.cable: each.identity.serial_number for each in sampler.stations}
    now = datetime.now(UTC)
    zeros = Zeros(
        cables={
            cable: take_zero(signal, now, serials[cable], cable) for cable, signal in values.items()
        }
    )
    target = out or default_zeros_path(path)
    write_zeros(target, zeros)
    if as_json:
        say_json({"file": str(target), **zeros.model_dump(mode="json")})
        return
    for cable, zero in zeros.cables.items():
        say(
            f"cable {cable}: {1e3 * zero.zero_mv_per_v:+9.4f} uV/V, "
            f"spread {1e3 * zero.spread_mv_per_v:.4f} uV/V, {zero.values} values"
        )
    say(f"wrote {target}")


def pretension_command(
    rig: RigOption = None,
    seconds: Annotated[
        float, typer.Option("--for", min=1.0, max=3600.0, help="End after this many s.")
    ] = 600.0,
    tolerance: Annotated[
        float, typer.Option(min=0.1, max=50.0, help="Allowed difference in % of the target.")
    ] = 5.0,
) -> None:
    """Show each cable's tension against its target while the winches are turned.

    Ctrl-C ends it. The toolkit shows; it turns nothing.

    Example: rig pretension --rig lab.toml --for 120
    """
    from cdpr8.errors import CheckError
    from cdpr8.rigfile import find_rig_file, load_rig
    from rig.pretension import compare, line
    from rig.stop import StopRequest
    from rig.zeros import default_zeros_path, read_zeros, zero_values

    path = find_rig_file(rig)
    machine = load_rig(path)
    _say_simulated(machine)
    zeros = zero_values(read_zeros(default_zeros_path(path)))
    stop = StopRequest()
    rows = []
    with _sampler(machine, zeros) as sampler, stop.listening():
        for _ in range(round(seconds)):
            rows = compare(machine, sampler.tensions_n(1.0), tolerance)
            note(line(rows))
            if stop.requested:
                break
    for row in rows:
        say(row.sentence())
    off = [str(row.cable) for row in rows if not row.met]
    if off:
        raise CheckError(f"not at their targets: cables {', '.join(off)}")


@contextmanager
def _sampler(rig: "Rig", zeros: dict[int, float] | None = None) -> "Iterator[Sampler]":
    from cdpr8.clock import RealClock
    from rig.machine import open_machine
    from rig.sampler import Sampler

    clock = RealClock()
    machine = open_machine(rig, rig.excitation, clock)
    try:
        sampler = Sampler(machine, rig, zeros or {})
        yield sampler
        sampler.close()
    finally:
        machine.close()


def _say_simulated(rig: "Rig") -> None:
    if rig.bus.port == "simulated":
        note("the simulated rig, no hardware")
