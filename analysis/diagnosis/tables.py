"""A diagnosis as tables: rows of text, and the same for a terminal and for Markdown."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analysis.diagnosis.proposing import spelled
from analysis.diagnosis.spelling import listed, number, percent, scaled, size_of
from analysis.diagnosis.titles import parameter_name, rival, short, title, together

if TYPE_CHECKING:
    from rich.table import Table

Statement = Mapping[str, Any]

MOST_ROWS = 8
"""Hypotheses in the table of what was ruled out."""

RESIDUALS = {
    "cables": "tension of each cable beyond k ΔL",
    "platform": "forces on the platform that do not balance",
    "inner": "tensions that cancel on the platform",
}

PARTS = {"used": "data used", "held_out": "held out"}


@dataclass(frozen=True)
class Rows:
    """A table of texts: its title, its columns, which of those are numbers, and its rows."""

    title: str
    columns: tuple[str, ...]
    right: tuple[bool, ...]
    rows: tuple[tuple[str, ...], ...]

    def printed(self) -> "Table":
        """For a terminal."""
        from rich.box import SIMPLE_HEAD
        from rich.table import Table
        from rich.text import Text

        shown = Table(title=self.title, title_justify="left", box=SIMPLE_HEAD)
        for column, right in zip(self.columns, self.right, strict=True):
            shown.add_column(column, justify="right" if right else "left", no_wrap=True)
        for row in self.rows:
            shown.add_row(*(Text(cell) for cell in row))
        return shown

    def markdown(self) -> str:
        """For a page."""
        lines = [f"**{self.title}**", "", "| " + " | ".join(self.columns) + " |"]
        lines.append("|" + "|".join("---:" if right else "---" for right in self.right) + "|")
        for row in self.rows:
            lines.append("| " + " | ".join(cell.replace("\n", "<br>") for cell in row) + " |")
        return "\n".join(lines) + "\n"


def tables(said: Statement) -> list[Rows]:
    """All tables of a statement that have rows."""
    found = (causes(said), located(said) if not said.get("ranking") else None, balance(said),
             proposal(said), rivals(said), fit(said), parameters(said), campaign(said))  # fmt: skip
    return [one for one in found if one is not None and one.rows]


def causes(said: Statement) -> Rows:
    """The causes: effect, side, cables, parameters, probability, not told from."""
    rows = []
    for cause in said["causes"]:
        lines = []
        for name, one in cause["parameters"].items():
            unit = one.get("unit", "")
            lines.append(f"{name} {number(name, one['value'], one['sigma'], unit)}")
            if len({round(v, 9) for v in one.get("cables", {}).values()}) > 1:
                lines.append(_by_cable(name, one, unit))
        rows.append(
            (
                title(cause["effect"]),
                cause["where"]["side"],
                listed(cause["where"]["cables"]),
                "\n".join(lines),
                percent(cause["probability"]),
                "\n".join(short(one) for one in cause["indistinguishable_from"]),
            )
        )
    return Rows(
        "causes",
        ("effect", "side", "cables", "parameters", "probability", "not told from"),
        (False, False, False, False, True, False),
        tuple(rows),
    )


def _by_cable(name: str, entry: Statement, unit: str) -> str:
    factor, spelled = scaled(name, entry["value"], unit)
    values = sorted((int(cable), value) for cable, value in entry["cables"].items())
    parts = [f"{cable}: {factor * value:.3g}" for cable, value in values]
    after = f" ({spelled})" if spelled else ""
    return f"  by cable{after}  {'  '.join(parts)}"


def located(said: Statement, most: int = 15) -> Rows:
    """Where recording and simulation differ, the strongest first."""
    rows = []
    for one in said["located"][:most]:
        unit = one["unit"]
        size = (one["in_phase"] ** 2 + one["quadrature"] ** 2) ** 0.5
        factor, spelled = (57.29577951308232, "deg") if unit == "rad" else scaled("", size, unit)
        rows.append(
            (
                one["run"],
                channel_name(one["channel"]),
                one["segment"],
                f"{one['line']:.3g}" + (", slow change" if one["slow"] else ""),
                f"{factor * one['in_phase']:+.3g}",
                f"{factor * one['quadrature']:+.3g}",
                spelled,
                f"{one['sigmas']:.3g}",
            )
        )
    return Rows(
        "where recording and simulation differ",
        ("run", "channel", "stretch", "line", "in phase", "quadrature", "unit", "sigmas"),
        (False, False, False, True, True, True, False, True),
        tuple(rows),
    )


def balance(said: Statement) -> Rows:
    """Which of the three residuals sees the mismatch."""
    runs = said.get("balance") or []
    several = len(runs) > 1
    rows = []
    for run in runs:
        for one in run["residuals"]:
            where = [] if one["residual"] == "inner" else one["where"]
            short_ = [name.removeprefix("cable ") for name in where]
            row = (RESIDUALS[one["residual"]], one["sees"], listed(short_), f"{one['sigmas']:.3g}")
            rows.append((run["run"], *row) if several else row)
    columns = ("residual", "sees it", "where", "sigmas")
    return Rows(
        "which residual sees it",
        ("run", *columns) if several else columns,
        (*[False] * (len(columns) - (not several)), True),
        tuple(rows),
    )


def proposal(said: Statement) -> Rows:
    """Laws proposed for what is missing."""
    rows = []
    for one in said.get("proposal") or []:
        for term in one["terms"]:
            others = [spelled(other) for other in term["alternatives"]]
            share = percent(one["explains_share_held_out"])
            rows.append((listed(one["cables"]), spelled(term), percent(term["chosen_share"]),
                         share, "\n".join(others)))  # fmt: skip
    return Rows(
        "proposed, not found: terms of the missing force",
        ("cable", "term", "of resamples", "explains, held out", "as well in its place"),
        (False, False, True, True, False),
        tuple(rows),
    )


def rivals(said: Statement) -> Rows:
    """What was ruled out: the best hypotheses, and effects that were not needed."""
    rows: list[tuple[str, ...]] = []
    for one in said.get("ranking", []):
        if len(rows) >= MOST_ROWS and one["effects"] and not one["chosen"]:
            continue
        mark = "chosen" if one["chosen"] else "implausible numbers" if one["implausible"] else ""
        rows.append(
            (
                together(one["effects"]),
                f"{one['log_odds']:,.1f}",
                probability(one["probability"]),
                mark,
            )
        )
    return Rows(
        "what was weighed (log odds against the best)",
        ("left out", "log odds", "probability", ""),
        (False, True, True, False),
        tuple(rows),
    )


def probability(value: float) -> str:
    """A probability as a number."""
    if value >= 0.001:
        return f"{value:.3f}"
    return f"{value:.0e}" if value >= 1e-6 else "< 1e-6"


def fit(said: Statement) -> Rows:
    """Residual over noise, before and after."""
    before, after = said["fit"].get("before", {}), said["fit"].get("after", {})
    rows = [
        (
            f"{kind}, {PARTS.get(part, part)}",
            f"{value:.2f}",
            f"{after[part][kind]:.2f}" if kind in after.get(part, {}) else "",
        )
        for part, kinds in before.items()
        for kind, value in kinds.items()
    ]
    return Rows(
        "fit (rms of the residual over the noise; 1 is noise alone)",
        ("channels", "before", "after"),
        (False, True, True),
        tuple(rows),
    )


def parameters(said: Statement) -> Rows:
    """Parameters of the rig file that the fit moved."""
    rows = tuple(
        (parameter_name(one["parameter"]), amount(one), f"{one['sigmas']:+.1f}")
        for one in said.get("parameters", [])
    )
    return Rows(
        "parameters that moved, in what is known of them",
        ("parameter", "moved", "sigmas"),
        (False, True, True),
        rows,
    )


def campaign(said: Statement) -> Rows:
    """Experiments that could be done next, in their order."""
    rows = tuple(
        (
            one["what"],
            f"{one['bits']:.2f}",
            f"{one['minutes']:.1f}",
            f"{one['bits_per_minute']:.2f}",
            " / ".join(rival(name) for name in one["separates"]),
            one.get("command") or "",
        )
        for one in said.get("campaign") or []
    )
    return Rows(
        "next experiments, by what each is expected to tell beside those before it",
        ("experiment", "bits", "minutes", "bits a minute", "separates", "command"),
        (False, True, True, True, False, False),
        rows,
    )


def amount(one: Statement) -> str:
    """By how much a parameter moved."""
    last = one["parameter"].split()[-1].partition("@")[0]
    if one["unit"] == "rad":
        return f"{57.29577951308232 * one['moved']:+.3g} deg"
    name = "x_share" if one["unit"] == "1" else last
    factor, unit = scaled(name, one["moved"], one["unit"])
    return f"{factor * one['moved']:+.3g} {unit}".strip()


def unnoticed(said: Statement) -> Rows:
    """From which size on each effect would have been noticed, where nothing is named."""
    rows = []
    for one in said["limits"]:
        sizes = [one["everywhere"], *([one["in_one_cable"]] if one["placed"] else [])]
        texts = [
            "-" if size is None else size_of(one["parameter"], size, one["unit"]) for size in sizes
        ]
        rows.append((title(one["effect"]), one["parameter"], *texts, *[""] * (2 - len(texts))))
    return Rows(
        "what would not have gone unnoticed, if only as another law of its kind",
        ("effect", "parameter", "from (all cables alike)", "from (in any one cable)"),
        (False, False, True, True),
        tuple(rows),
    )


def channel_name(name: str) -> str:
    """A channel without its unit: "pitch", "tension 3"."""
    for ending in ("_deg", "_m"):
        name = name.removesuffix(ending)
    return name


def markdown(said: Statement, sections: Sequence[tuple[str, str]], name: str) -> str:
    """The whole page: words and tables."""
    parts = [f"# Diagnosis of {name}\n"]
    parts += [f"## {heading}\n\n{text}\n" for heading, text in sections]
    shown = [*tables(said), *([unnoticed(said)] if said.get("limits") else [])]
    if shown:
        parts.append("## Numbers\n")
        parts += [one.markdown() for one in shown]
    if said.get("notes"):
        parts.append("## Notes\n\n" + "\n".join(f"- {one}" for one in said["notes"]) + "\n")
    return "\n".join(parts)
