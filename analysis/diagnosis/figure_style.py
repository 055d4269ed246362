"""How the figures of a diagnosis look: colours that the colour-blind can tell, light and dark."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from analysis.diagnosis.pictures import Channel
from analysis.diagnosis.tables import channel_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Look:
    """Colours and width of a figure.

    Parameters
    ----------
    ink, paper, faint
        Text, background, grid lines and bands.
    recorded, before, after
        Of data, of the simulation with nothing left out and of that with the causes in (Okabe and
        Ito's colours, which all can tell apart).
    narrow
        For a phone: panels stand below each other.
    """

    ink: str = "#1c1c1c"
    paper: str = "#ffffff"
    faint: str = "#d9d9d9"
    recorded: str = "#1c1c1c"
    before: str = "#d55e00"
    after: str = "#0072b2"
    narrow: bool = False

    @property
    def style(self) -> Any:
        """A dictionary for matplotlib's `rc_context`."""
        return {
            "font.size": 10,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "axes.grid": True,
            "grid.color": self.faint,
            "grid.linewidth": 0.6,
            "axes.axisbelow": True,
            "svg.hashsalt": "cdpr8",
            "savefig.dpi": 150,
            "figure.facecolor": self.paper,
            "savefig.facecolor": self.paper,
            "axes.facecolor": self.paper,
            "text.color": self.ink,
            "axes.labelcolor": self.ink,
            "axes.edgecolor": self.ink,
            "axes.titlecolor": self.ink,
            "xtick.color": self.ink,
            "ytick.color": self.ink,
            "axes.titlesize": 10,
        }

    @property
    def width(self) -> float:
        """Of a figure, in inches."""
        return 4.2 if self.narrow else 9.0


LIGHT = Look()
DARK = Look(
    ink="#e8e6e3", paper="#16181c", faint="#3a3e46", recorded="#e8e6e3", before="#ff9248",
    after="#5cb8ff",
)  # fmt: skip

_SHOWN = {"m": (1e3, "mm"), "rad": (57.29577951308232, "deg")}


def shown(channel: Channel) -> tuple[float, str, str]:
    """Factor and unit in which a channel is drawn, and its name."""
    factor, unit = _SHOWN.get(channel.unit, (1.0, channel.unit))
    return factor, unit, channel_name(channel.name)


def most_off(channels: tuple[Channel, ...]) -> Channel | None:
    """The channel that is farthest off before, in units of its noise; None: there is none."""
    if not channels:
        return None
    return max(channels, key=lambda one: float((one.recorded - one.before).std()) / one.noise)


def below_key(figure: "Figure", tall: float) -> None:
    """Leave room above the panels of a figure that is so tall, in inches, for the key."""
    engine: Any = figure.get_layout_engine()
    engine.set(rect=(0, 0, 1, 1 - 0.3 / tall))


def key(
    figure: "Figure", look: Look, *, named: bool, first: str = "recorded", top: float = 0.995
) -> None:
    """Name the three colours in a line above the panels, in their own colours."""
    words = [(first, look.recorded), ("before", look.before)]
    if named:
        words.append(("after: causes in", look.after))
    steps = (0.3, 0.25, 0.0) if look.narrow else (0.13, 0.1, 0.0)
    at = 0.02
    for (word, colour), step in zip(words, steps, strict=False):
        figure.text(at, top, word, color=colour, weight="bold", va="top", ha="left", fontsize=10)
        at += step
