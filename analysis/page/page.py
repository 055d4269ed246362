"""The page: a material as one HTML text that needs nothing else."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

from analysis.diagnosis.figures import drawings
from analysis.diagnosis.pictures import Pictures
from analysis.diagnosis.proposing import HEADING as PROPOSED
from analysis.diagnosis.spelling import listed, sentence
from analysis.diagnosis.tables import (
    Rows,
    balance,
    campaign,
    causes,
    fit,
    located,
    parameters,
    proposal,
    rivals,
)
from analysis.diagnosis.titles import rival, together
from analysis.diagnosis.words import SIDE, headline
from analysis.page.figure import alt_text, figure, kind_of
from analysis.page.gather import Material
from analysis.page.style import CSS

SHOWN_CABLES = ("1", "7")
"""The paper's; the others follow."""

HEADINGS: Mapping[str, str] = {
    "story": "Before, where, after",
    "map": "Where they differ",
    "loops": "Tension against elongation",
    "speed": "Residual against speed",
    "states": "The missing force over the cable's state",
    "ranking": "Rivals",
    "improvement": "Before and after",
    "fit": "Before and after, over time",
}

ORDER = ("story", "map", "loops", "speed", "states", "ranking", "improvement", "fit")

# Nothing may be fetched: the page says so itself, and a browser holds it to that.
_HEAD = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>{css}</style>
</head>
<body>
"""


def page(material: Material) -> str:
    """The whole page.

    Parameters
    ----------
    material
        What it shows.
    """
    said = material.statement
    parts = [_HEAD.format(title=escape(f"{material.name}: diagnosis"), css=CSS)]
    parts.append(_top(material))
    figures = dict(_figures(said, _first_run(material.pictures, material.name)))
    parts.append(figures.pop("story", ""))
    parts += _words(said)
    parts.append(_section_5(material.before, material.after))
    parts.append(_block("Causes", _table(causes(said))))
    parts += figures.values()
    parts.append(_experiment(said))
    parts.append(_block("Numbers", _table(fit(said)) + _table(parameters(said))
                        + _details("All that was located", _table(located(said, 40)))))  # fmt: skip
    parts.append(_provenance(material))
    return "".join(parts) + "</body>\n</html>\n"


def _top(material: Material) -> str:
    said = material.statement
    text = f"<header><p class=soft>CDPR-8 diagnosis</p><h1>{escape(material.name)}</h1>"
    text += f"<p><span class=verdict>{escape(said['verdict'])}</span></p>"
    text += f"<p class=lead>{escape(headline(said))}</p>"
    for run in said["provenance"]["runs"]:
        if run.get("reconstruction"):
            text += f"<p class=note>{escape(run['name'])} is a reconstruction: "
            text += f"{escape(run['reconstruction'])}</p>"
        elif run.get("simulated"):
            text += f"<p class=note>{escape(run['name'])} was recorded from the simulated rig.</p>"
    return text + "</header><main>"


def _words(said: Mapping[str, Any]) -> list[str]:
    first = headline(said)
    found = []
    for one in said["words"]:
        # The headline stands at the top already.
        text = one["text"].removeprefix(first).strip()
        if text:
            table = {SIDE: balance, PROPOSED: proposal}.get(one["heading"])
            more = _table(table(said)) if table else ""
            found.append(_block(one["heading"], f"<p>{escape(text)}</p>{more}"))
    return found


def _section_5(before: Mapping[str, Any] | None, after: Mapping[str, Any] | None) -> str:
    """The paper's Section 5, and the same with the causes in."""
    if before is None:
        return ""
    columns = ["quantity", "measured", "simulated", "relative error"]
    if after is not None:
        columns += ["simulated, causes in", "relative error, causes in"]
    own = before["tension"]
    order = [*(c for c in SHOWN_CABLES if c in own), *(c for c in own if c not in SHOWN_CABLES)]
    rows = [_compared(before["angle"], after["angle"] if after else None)]
    for cable in order:
        rows.append(_compared(own[cable], after["tension"].get(cable) if after else None))
    shown = Rows("amplitudes, as the paper's Section 5 has them: simulated against measured",
                 tuple(columns), (False, *[True] * (len(columns) - 1)), tuple(rows))  # fmt: skip
    return _block("The paper's Section 5", _table(shown))


def _compared(one: Mapping[str, Any], better: Mapping[str, Any] | None) -> tuple[str, ...]:
    unit = one["unit"]
    row = [
        one["name"],
        f"{one['measured']:.2f} {unit}",
        f"{one['simulated']:.2f} {unit}",
        f"{one['relative_error_percent']:.2f} %",
    ]
    if better is not None:
        row += [f"{better['simulated']:.2f} {unit}", f"{better['relative_error_percent']:.2f} %"]
    return tuple(row)


def _first_run(pictures: Pictures | None, name: str) -> Pictures | None:
    """Of a campaign, the run that the page is about."""
    if pictures is None:
        return None
    own = tuple(one for one in pictures.records if one.name == name) or pictures.records[:1]
    chosen = {one.name for one in own}
    return Pictures(own, tuple(c for c in pictures.channels if c.record in chosen), pictures.named)


def _figures(said: Mapping[str, Any], pictures: Pictures | None) -> Iterator[tuple[str, str]]:
    """The kind of each figure, and its block."""
    draws = dict(drawings(said, pictures))
    for name in sorted(draws, key=lambda one: ORDER.index(kind_of(one))):
        heading = HEADINGS[kind_of(name)]
        text = figure(name, draws[name], alt_text(name, said, pictures))
        if kind_of(name) == "ranking":
            text += _details("As a table", _table(rivals(said)) + _ruled_out(said))
        yield kind_of(name), _block(heading, text)


def _ruled_out(said: Mapping[str, Any]) -> str:
    rows = tuple(
        (together([one["effect"]]), f"{one['log_odds']:,.1f}", one["how"])
        for one in said.get("ruled_out", [])
    )
    return _table(
        Rows("effects that are not among the causes: the best explanation with each",
             ("effect", "log odds", "how"), (False, True, False), rows)
    )  # fmt: skip


def _experiment(said: Mapping[str, Any]) -> str:
    experiment = said.get("next_experiment")
    if not experiment:
        return ""
    text = f"<p>{escape(sentence(experiment['what']))}</p>"
    if experiment.get("command"):
        text += f"<p><code>{escape(experiment['command'])}</code></p>"
    if experiment.get("separates"):
        names = listed([rival(one) for one in experiment["separates"]])
        text += f"<p>It would tell of {escape(names)}.</p>"
    return _block("Next experiment", text + _table(campaign(said)))


def _provenance(material: Material) -> str:
    source = material.statement["provenance"]
    rows = [
        (f"run {one['name']}", f"{one['id']}\nrig file {one.get('rig_sha256') or 'not hashed'}")
        for one in source["runs"]
    ]
    rows += [(name, version) for name, version in source.get("versions", {}).items()]
    rows.append(("simulations", f"{source.get('simulations', 0):,}"))
    improved = material.statement.get("improved_rig")
    if improved:
        rows.append(("improved rig file", improved))
    text = _table(Rows("", ("what", "is"), (False, False), tuple(rows)))
    notes = material.statement.get("notes") or []
    if notes:
        items = "".join(f"<li>{escape(one)}</li>" for one in notes)
        text = f"<ul>{items}</ul>" + text
    if material.made:
        text += f"<p class=soft>Made for this page: {escape(', '.join(material.made))}.</p>"
    return _block("Provenance", text) + "</main>"


def _block(heading: str, text: str) -> str:
    return f"<section><h2>{escape(heading)}</h2>{text}</section>\n" if text else ""


def _details(summary: str, text: str) -> str:
    return f"<details><summary>{escape(summary)}</summary>{text}</details>" if text else ""


def _table(rows: Rows) -> str:
    """A table that scrolls by itself where it is too wide."""
    if not rows.rows:
        return ""
    head = "".join(
        _cell("th", text, right) for text, right in zip(rows.columns, rows.right, strict=True)
    )
    body = "".join("<tr>" + _row(row, rows.right) + "</tr>" for row in rows.rows)
    caption = f"<caption>{escape(rows.title)}</caption>" if rows.title else ""
    return f'<div class=wide tabindex="0"><table>{caption}<tr>{head}</tr>{body}</table></div>'


def _row(cells: Sequence[str], right: Sequence[bool]) -> str:
    return "".join(_cell("td", text, side) for text, side in zip(cells, right, strict=True))


def _cell(tag: str, text: str, right: bool) -> str:
    return f"<{tag}{' class=right' if right else ''}>{escape(text)}</{tag}>"
