"""Figures within the page: drawn for light and dark, for a screen and a phone."""

from base64 import b64encode
from collections.abc import Mapping
from dataclasses import replace
from html import escape
from io import BytesIO
from typing import Any

import numpy as np

from analysis.diagnosis.figure_story import improved, shown_channel
from analysis.diagnosis.figure_style import DARK, LIGHT, most_off
from analysis.diagnosis.figures import Draw, drawn
from analysis.diagnosis.pictures import Channel, Pictures
from analysis.diagnosis.tables import channel_name
from analysis.diagnosis.titles import together

PHONE = "(max-width: 640px)"
NIGHT = "(prefers-color-scheme: dark)"

DPI = 130

COLOURS = 128

CAPTIONS: Mapping[str, str] = {
    "story": "What was found, at a glance: the mean cycle of the tension that is farthest off for "
    "its swing, recorded and simulated with nothing left out, and what that misses; where in all "
    "channels, by harmonic of the drive, it is missed; and the same cycle with the causes in. "
    "Shaded: what differs from cycle to cycle.",
    "map": "Where recording and simulation differ, in units of the noise of a sample: at each "
    "harmonic of the drive, and over its cycle. White is what noise makes.",
    "loops": "Tension against elongation over a mean cycle: the whole of it for the cable that is "
    "farthest off, and for every cable what the spring k ΔL does not account for. A law without "
    "loss is a line; friction opens it to a loop. Elongations are simulated: each line has its "
    "own, the recording that of the better simulation.",
    "speed": "Mean residual of each tension against the speed of its cable; shaded, its spread. A "
    "step at zero is friction, a slope is damping, nothing is a good model.",
    "states": "The force that is missing, as a map over each cable's elongation and speed, with no "
    "law assumed. Bands that change sign with the speed are friction or damping; bands across are "
    "a spring's; white is nothing, or nowhere the cable went.",
    "fit": "Some cycles where the data that were fitted end and those held out begin, and what the "
    "simulations leave of them.",
    "ranking": "Every explanation that was fitted. The dot is how far it is behind the best as it "
    "counts: tempered, since no law is quite the library's. The bar ends where the evidence stands "
    "at face value.",
    "improvement": "What the simulation misses before and after, for the data that were fitted and "
    "for those held out.",
}


def figure(name: str, draw: Draw, alt: str) -> str:
    """One figure with its caption as HTML; its pictures are in it.

    Parameters
    ----------
    name
        Of the figure, as in `drawings`.
    draw
        Draws it.
    alt
        What it shows, for those who cannot see it.
    """
    sources = []
    for media, look in (
        (f"{PHONE} and {NIGHT}", replace(DARK, narrow=True)),
        (PHONE, replace(LIGHT, narrow=True)),
        (NIGHT, DARK),
    ):
        sources.append(
            f'<source media="{media}" srcset="{_data(drawn(draw, look, dpi=DPI)["png"])}">'
        )
    image = _data(drawn(draw, LIGHT, dpi=DPI)["png"])
    caption = CAPTIONS.get(kind_of(name), "")
    return (
        f'<figure id="{escape(name)}"><picture>{"".join(sources)}'
        f'<img src="{image}" alt="{escape(alt)}"></picture>'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )


def kind_of(name: str) -> str:
    """The figure's name without the run's."""
    return name.partition("_")[0]


def alt_text(name: str, said: Mapping[str, Any], pictures: Pictures | None) -> str:
    """What a figure shows, in a sentence with its main numbers.

    Parameters
    ----------
    name
        Of the figure.
    said, pictures
        What it was drawn from.
    """
    kind = kind_of(name)
    if kind == "ranking":
        best = said["ranking"][0]
        count = len(said["ranking"])
        return f"Ranking of {count} explanations; the best is {together(best['effects'])}."
    if kind == "improvement":
        return "Residual over noise before and after: " + "; ".join(
            f"{channels} {part.replace('_', ' ')} {value:.3g} to "
            f"{said['fit']['after'].get(part, {}).get(channels, value):.3g}"
            for part, kinds in said["fit"]["before"].items()
            for channels, value in kinds.items()
        )
    if pictures is None:
        return f"Figure: {kind}."
    run = next((one.name for one in pictures.records if name.endswith(f"_{one.name}")),
               pictures.records[0].name)  # fmt: skip
    channels = pictures.of(run)
    if kind == "map":
        worst, harmonic = _strongest(channels)
        return (
            f"Maps of the residual of {run} by harmonic and by phase, before and after; the "
            f"strongest is {channel_name(worst.name)} at harmonic {harmonic}, "
            f"{worst.harmonics_before[harmonic]:.0f} times the noise before and "
            f"{worst.harmonics_after[harmonic]:.0f} times after."
        )
    words = {
        "loops": "Loops of tension against elongation",
        "speed": "Residual of each tension against the speed of its cable",
        "states": "Missing force of each cable over its elongation and speed",
        "fit": "Recording and both simulations over time, with residuals,",
    }
    if kind == "story":
        own = shown_channel(pictures.of(run, "tension") or channels)
        after = f" and {_rms(own, 'after'):.2g} {own.unit} after" if pictures.named else ""
        return (
            f"{run} in a glance: {channel_name(own.name)} over the mean cycle, off by "
            f"{_rms(own, 'before'):.2g} {own.unit} rms before{after}; and where all channels are "
            f"off, by harmonic. {improved(said)}".strip()
        )
    worst = most_off(pictures.of(run, "tension")) or channels[0]
    return (
        f"{words.get(kind, kind)} of {run}, before and after; {channel_name(worst.name)} is off "
        f"most, by {_rms(worst, 'before'):.2g} {worst.unit} rms before and "
        f"{_rms(worst, 'after'):.2g} {worst.unit} after."
    )


def _strongest(channels: tuple[Channel, ...]) -> tuple[Channel, int]:
    worst = max(channels, key=lambda one: float(one.harmonics_before.max(initial=0.0)))
    return worst, int(np.argmax(worst.harmonics_before))


def _rms(channel: Channel, stage: str) -> float:
    return float(np.sqrt(np.mean((channel.recorded - getattr(channel, stage)) ** 2)))


def _data(png: bytes) -> str:
    """As a URI; in 128 colours, which nobody misses in a drawing, it is a third as long."""
    from PIL import Image

    buffer = BytesIO()
    image = Image.open(BytesIO(png)).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    image.save(buffer, "png", optimize=True)
    return f"data:image/png;base64,{b64encode(buffer.getvalue()).decode('ascii')}"
