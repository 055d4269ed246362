"""The command line of `analysis`: one module for each command or family of commands."""

import os

# Small matrices are slower on many threads; it counts before NumPy is first imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import typer

from analysis.challenge.command import app as challenge
from analysis.compare_command import compare
from analysis.diagnose_command import diagnose
from analysis.report_command import report
from analysis.stiffness_command import stiffness
from cdpr8.terminal import entry

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    help="Compare a recorded run with its simulation, and find out why they differ. "
    "Example: analysis diagnose run01",
)

app.command()(compare)
app.command()(diagnose)
app.command()(report)
app.command()(stiffness)
app.add_typer(challenge, name="challenge")

main = entry(app)
