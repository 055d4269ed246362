"""docs/proof.md and its like: what the challenge came to, written from the score alone."""

from collections.abc import Sequence
from pathlib import Path

from analysis.challenge.bars import KINDS, Row, stated
from analysis.challenge.grade import Grade
from analysis.challenge.plants import FIRST, plant_named
from analysis.challenge.score import Score

WORST = 25

HEADER = """# Proof on concealed data{}

<!-- written by `analysis challenge score --report`; run it again, do not edit this page -->

"""


def report(score: Score, took_s: float | None = None, remark: str = "") -> str:
    """The page.

    Parameters
    ----------
    score
        Of a challenge.
    took_s
        How long all diagnoses took together; default: their sum.
    remark
        What a reader must know of how this set was made and diagnosed.

    Returns
    -------
    str
        Markdown.
    """
    total = sum(one.seconds for one in score.grades) if took_s is None else took_s
    done = sum(one.verdict != "missing" for one in score.grades)
    median = ", ".join(f"{value:.0f} s a {kind}" for kind, value in score.seconds.items())
    which = "" if score.plant == FIRST else f", by the {score.plant}"
    parts = [
        HEADER.format(which) + plant_named(score.plant).remark,
        f"{len(score.grades)} cases, {done} diagnosed; seed {score.seed}, version {score.version}, "
        f"{total / 3600.0:.1f} h of diagnosis (median {median or 'none'}). Sealed truth: SHA-256 "
        f"`{score.digest}`.",
        f"Again: `analysis challenge make --n {len(score.grades)} --seed {score.seed}"
        f"{_options(score)} OUT`, then `run OUT` and `score OUT`.",
        remark,
        "## Figures\n\nWith 95 % intervals (Wilson for shares, bootstrap over cases for the rest). "
        "`open`: the figure misses its bar, and its interval does not.",
        table(score.rows),
        "## What can be found, and how small\n\n`can be seen from`: the size that stands out of "
        "the noise by 6 (numbers of the machine: 3 sigma) after what the machine's own numbers can "
        "absorb, computed by the plant, median of the cases. Hits: named or, where too weak to "
        "see, rightly left alone.",
        limits_table(score),
        f"## Failures\n\n{len(score.failures)} of {done} cases, the worst first"
        + (f"; {WORST} are shown." if len(score.failures) > WORST else "."),
        failures_table(score),
    ]
    return "\n\n".join(part.rstrip("\n") for part in parts if part) + "\n"


def _options(score: Score) -> str:
    """Those of `make` that are not as usual."""
    kinds = {one.kind for one in score.grades}
    options = "" if score.plant == FIRST else f" --plant {score.plant}"
    options += f" --kind {kinds.pop()}" if len(kinds) == 1 else ""
    effects = [effect for one in score.grades for effect in one.truth]
    if effects and all(effect["separable"] is None for effect in effects):
        options += " --no-rivals"
    return options


def table(rows: tuple[Row, ...]) -> str:
    """The figures, one a line, single runs beside campaigns."""
    lines = [
        "| figure | single run | bar | | campaign | bar | |",
        "|---|---|---|---|---|---|---|",
    ]
    by_name: dict[str, dict[str, Row]] = {}
    for row in rows:
        by_name.setdefault(row.figure, {})[row.kind] = row
    for name, kinds in by_name.items():
        cells = [cell for kind in KINDS for cell in cells_of(kinds[kind])]
        lines.append("| " + " | ".join([name, *cells]) + " |")
    return "\n".join(lines)


def cells_of(row: Row) -> tuple[str, str, str]:
    """Value with interval and number of cases, bar, and whether it is met."""
    if row.value is None:
        return "no case", shown(row.bar, row.percent), ""
    value, low, high = (shown(x, row.percent) for x in (row.value, row.low, row.high))
    sign = ">=" if row.at_least else "<="
    verdict = f"**{row.word}**" if row.word == "not met" else row.word
    return f"{value} ({low} to {high}; {row.of})", f"{sign} {shown(row.bar, row.percent)}", verdict


def shown(value: float, percent: bool) -> str:
    """A figure as people read it."""
    return f"{100.0 * value:.0f} %" if percent else f"{value:.3g}"


def limits_table(score: Score) -> str:
    """Each effect: from what size it can be seen, what was found."""
    lines = [
        "| effect | size | can be seen from: single | campaign | smallest found | hits: limit | "
        "typical | strong |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in score.limits:
        sizes = [row["limit_single"], row["limit_campaign"], row["smallest_found"]]
        unit = "" if row["unit"] == "1" else f" {row['unit']}"
        cells = ["" if size is None else f"{size:.2g}{unit}" for size in sizes]
        hits = ["{}/{}".format(*row[name]) for name in ("limit", "typical", "strong")]
        cells = [f"`{row['effect']}`", f"`{row['size']}`", *cells, *hits]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def failures_table(score: Score) -> str:
    """What was there and what was said."""
    if not score.failures:
        return ""
    lines = ["| case | concealed | said |", "|---|---|---|"]
    for one in score.failures[:WORST]:
        named = "; ".join(" or ".join(f"`{name}`" for name in names) for names in one["named"])
        said = one["error"] or f"{one['verdict']}: {named}".rstrip(": ")
        there = "; ".join(one["concealed"]) or "nothing"
        lines.append(f"| {one['case']} ({one['kind']}) | {there} | {said} |".replace("\n", " "))
    return "\n".join(lines)


def write_report(score: Score, path: Path, remark: str = "") -> list[Path]:
    """Write the page, its figures beside it in `figures/`; `remark` as for `report`.

    Returns
    -------
    list of Path
        What was written.
    """
    from analysis.challenge.figures import draw_confusion

    figures = path.parent / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    text = report(score, remark=remark)
    written = draw_confusion(score.confusion, figures / f"{path.stem}_confusion")
    text += "\n## Confusion\n\n![what was concealed against what was named]"
    text += f"(figures/{path.stem}_confusion.svg)\n"
    calibrated, drawn = calibration(score.grades, path)
    text, written = text + calibrated, [*written, *drawn]
    path.write_text(text, encoding="utf-8")
    return [path, *written]


def calibration(grades: Sequence[Grade], page: Path) -> tuple[str, list[Path]]:
    """The part of a page on calibration, and its figure's files, in `figures/` beside the page.

    Parameters
    ----------
    grades
        Of all cases; where none states a probability, there is no such part.
    page
        Where it is to stand.
    """
    from analysis.challenge.figures import draw_calibration

    pairs = stated(grades)
    if not pairs:
        return "", []
    figures = page.parent / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    drawn = draw_calibration(pairs, figures / f"{page.stem}_calibration")
    text = "\n## Calibration\n\n![share that was right against the probability stated]"
    return text + f"(figures/{page.stem}_calibration.svg)\n", drawn
