"""docs/effects.md and `model effects`, written from the library itself."""

from collections.abc import Iterator

from model.library.discovery import library
from model.library.effect import Acts, Effect, Parameter

HEADING = """\
# Left-out effects

Physics the paper leaves out, as terms of the simulation or of the measurement. Written by
`model effects --markdown`; a test holds this page to the library in `model/effects/`.

Use one with `model simulate --with pulley_coulomb:coulomb_n=0.3@1,2`, or keep it in the rig file:

```toml
[physics.pulley_coulomb]
coulomb_n = 0.3        # or eight values, one a cable
cables = [1, 2]        # left out: all
```

What is left out has its default; a value beyond the plausible range is refused. An effect whose
magnitudes (in bold) are all zero is no effect at all. Effects at a `pulley` are seen by a cell on
the platform, and not by one at the base or at the winch, which sit behind the pulley. Effects of
the parameters change the plant, not the machine the drive was made for. `model.observe` applies
those of cells, camera and clocks to a simulation.

To add one, put a file into `model/effects/`; nothing else changes.
"""

TITLES = {
    Acts.CABLE: "In the cable",
    Acts.PULLEY: "At the pulley",
    Acts.PLATFORM: "On the platform",
    Acts.PARAMETER: "In the machine's numbers",
    Acts.DRIVE: "In the drive",
    Acts.CELL: "In the force cells",
    Acts.CAMERA: "In the camera",
    Acts.CLOCK: "In the clocks",
}


def markdown() -> str:
    """The page."""
    return "\n".join([HEADING, *_sections()])


def _sections() -> Iterator[str]:
    for acts, title in TITLES.items():
        yield f"## {title}\n"
        for effect in library().values():
            if effect.acts is acts:
                yield _paragraph(effect)


def _paragraph(effect: Effect) -> str:
    lines = [f"### `{effect.name}`: {effect.title}\n", f"`{effect.equation}`\n"]
    lines.append(f"Seen as: {effect.signature}. Source: {effect.source}.\n")
    lines += ["| parameter | unit | default | range | meaning |", "|---|---|---|---|---|"]
    lines += [_row(parameter) for parameter in effect.parameters]
    lines.append("")
    if effect.states:
        listed = "; ".join(f"`{one.name}` ({one.unit}): {one.meaning}" for one in effect.states)
        shared = (
            ", shared by the cables of a post (base points in one quadrant of the floor)"
            if effect.states[0].shared
            else ""
        )
        lines.append(f"States of each cable{shared}: {listed}.\n")
    if callable(effect.longest_step_s):
        lines.append(f"Steps: {effect.cost}.\n")
    elif effect.longest_step_s is not None:
        longest_ms = 1e3 * effect.longest_step_s
        lines.append(f"Steps of at most {longest_ms:g} ms: {effect.cost}.\n")
    return "\n".join(lines)


def _row(parameter: Parameter) -> str:
    name = f"`{parameter.name}`"
    if parameter.magnitude:
        name = f"**{name}**"
    per_cable = ", each cable its own" if parameter.per_cable else ""
    allowed = f"{parameter.low:g} to {parameter.high:g}"
    return (
        f"| {name} | {parameter.unit} | {parameter.default:g} | {allowed} "
        f"| {parameter.meaning}{per_cable} |"
    )


def as_json() -> list[dict[str, object]]:
    """The library for machines."""
    return [
        {
            "name": effect.name,
            "title": effect.title,
            "acts": effect.acts.value,
            "side": effect.acts.side,
            "equation": effect.equation,
            "source": effect.source,
            "signature": effect.signature,
            "longest_step_s": None if callable(effect.longest_step_s) else effect.longest_step_s,
            "cost": effect.cost,
            "parameters": [
                {
                    "name": parameter.name,
                    "unit": parameter.unit,
                    "default": parameter.default,
                    "low": parameter.low,
                    "high": parameter.high,
                    "meaning": parameter.meaning,
                    "per_cable": parameter.per_cable,
                    "magnitude": parameter.magnitude,
                }
                for parameter in effect.parameters
            ],
            "states": [
                {"name": state.name, "unit": state.unit, "shared": state.shared}
                for state in effect.states
            ],
        }
        for effect in library().values()
    ]
