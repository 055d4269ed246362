"""The table of docs/validation.md: `python -m tests.validation.report > docs/validation.md`."""

import sys

from analysis.engine import Diagnosis
from tests.validation.runs import (
    FULL,
    Run,
    arrow_inside_s,
    beyond_published,
    emps,
    emps_rmse,
    published_emps,
    silverbox,
    tanks,
)

HEAD = """# Other people's machines

The engine that finds what a simulation of CDPR-8 leaves out (`analysis/engine`, see
[engine.md](engine.md)) on three public recordings of things that are no cable robot. Each is
described in at most 150 lines under `tests/validation/`: a linear model, how well its numbers are
known, and some ten candidates, most of them wrong. Nothing is named, and no number fitted, by the
test records; how far a simulation and a law may be trusted (noise, form) was set by hand for each
description, with these figures in view. `python -m tests.validation.report` writes this page,
`./lab test` and `./lab test long` hold its figures to their bars.

| recording | judged by | before | after | published |
|---|---|---|---|---|
"""


def row(what: str, judged: str, before: float, after: float, published: str) -> str:
    """One line of the table."""
    return f"| {what} | {judged} | {before:.3g} | {after:.3g} | {published} |\n"


def emps_rows(run: Run) -> str:
    """The axis."""
    published = {"train": "2.21", "test": "3.56"}
    here = {name: emps_rmse(run, published_emps(), name) for name in published}
    return "".join(
        row(
            "EMPS, motor and ball-screw",
            f"force, {name} [N]",
            emps_rmse(run, run.before, name),
            emps_rmse(run, run.chosen.point, name),
            f"{said}, its model form by least squares (its own numbers, judged here: "
            f"{here[name]:.2f})",
        )
        for name, said in published.items()
    )


def silverbox_rows(run: Run, held: Run) -> str:
    """The oscillator, and the same with a wrong hold."""
    best = "best linear about 14, state-space encoder 5.79, PNLSS 0.26"
    spans = {
        "arrow, full [mV]": ("arrow", 1e9, best),
        "arrow, no extrapolation [mV]": ("arrow", arrow_inside_s(), "state-space encoder 2.04"),
        "multisine, test [mV]": ("multisine", 1e9, "-"),
    }
    rows = [
        row(
            "Silverbox, electronic oscillator",
            judged,
            1e3 * run.rmse(run.before, part, end_s=end_s),
            1e3 * run.rmse(run.chosen.point, part, end_s=end_s),
            said,
        )
        for judged, (part, end_s, said) in spans.items()
    ]
    rows.append(
        row(
            "Silverbox, simulated with a wrong hold",
            "multisine, test [mV]",
            1e3 * held.rmse(held.before, "multisine"),
            1e3 * held.rmse(held.chosen.point, "multisine"),
            "-",
        )
    )
    return "".join(rows)


def tanks_rows(run: Run) -> str:
    """The tanks."""
    said = "linear 0.75, Volterra 0.54, neural 0.33, physics named by people 0.18"
    return row(
        "Cascaded tanks",
        "level, test [V]",
        run.rmse(run.before, "test"),
        run.rmse(run.chosen.point, "test"),
        said,
    )


def causes(diagnosis: Diagnosis) -> str:
    """What was named, with its numbers, one a line."""
    titles = {one.name: one for one in diagnosis.system.candidates}
    lines = []
    for cause in diagnosis.judgement.causes if diagnosis.judgement else ():
        known = titles[cause.name]
        units = {one.name: one.unit for one in (*known.terms, *known.shapes)}
        fixed = {} if known.fixed else dict(cause.values)
        numbers = [
            f"{value:.3g} ± {cause.sigmas[name]:.1g} {units[name]}" for name, value in fixed.items()
        ]
        numbers += [f"{name} {value:.3g} {units[name]}" for name, value in cause.shapes.items()]
        said = f": {', '.join(numbers)}" if numbers else ""
        rivals = ", ".join(one.name for one in cause.rivals)
        said += f"; these data do not tell it from {rivals}" if rivals else ""
        lines.append(f"- `{cause.name}`, {known.title}{said}\n")
    return "".join(lines)


def order(run: Run) -> str:
    """The best hypotheses in order of size."""
    return "; ".join(" + ".join(f"`{one}`" for one in names) for names in run.order)


def page() -> str:
    """All of docs/validation.md."""
    axis, box, held, pair = emps(), silverbox(FULL), silverbox(hold="zero-order"), tanks()
    text = HEAD + emps_rows(axis) + silverbox_rows(box, held) + tanks_rows(pair)
    text += "\nBest of one cause, of two and so on, and what the verdict names:\n"
    titles = ("EMPS", "Silverbox", "Silverbox, simulated with a wrong hold", "Cascaded tanks")
    for title, run in zip(titles, (axis, box, held, pair), strict=True):
        text += f"\n## {title}\nVerdict `{run.diagnosis.verdict}`. In order of evidence: "
        text += f"{order(run)}.\n\n{causes(run.diagnosis)}"
    more = ", ".join(f"`{one}`" for one in sorted(beyond_published(axis)))
    text += "\n## Beyond the published model of EMPS\n"
    text += (
        f"The data ask for more than mass, viscous friction, Coulomb friction and offset: {more}"
    )
    text += " (a difference of viscous friction by direction stands in for the offset).\n"
    text += "\n## A better fit that is not believed\n"
    for one in pair.diagnosis.implausible:
        text += (
            f"Cascaded tanks: with `{one.term}` at {one.value:.2g} ± {one.sigma:.1g} {one.unit}, "
            f"outside of its plausible range of {one.low:g} to {one.high:g}, the level would be "
            f"foretold to {pair.rmse(one.fitted.point, 'test'):.3g} V. No tank leaks inwards: "
            "it is said here, and not named.\n"
        )
    return text


if __name__ == "__main__":
    sys.stdout.write(page())
