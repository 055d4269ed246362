"""What a simulator may have left out, and how large that can be."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from math import log

AT_END = 0.02
"""Of a shape's range: a value that is as near to an end is there."""


@dataclass(frozen=True)
class Term:
    """One magnitude of a candidate: zero of it is nothing.

    Parameters
    ----------
    name
        Unique in the candidate, such as "coulomb_n@3".
    parameter, unit
        The number it is, such as "coulomb_n".
    place
        Where it acts, such as "3" for cable 3; "" where there is no choice.
    low, high
        Its plausible range.
    step
        A size at which its effect is computed for screening.
    least, most
        How far beyond its plausible range a fit may go, only to be flagged; None: not at all.
    """

    name: str
    parameter: str
    unit: str
    place: str
    low: float
    high: float
    step: float
    least: float | None = None
    most: float | None = None


@dataclass(frozen=True)
class Shape:
    """A number that forms a candidate but does not switch it off, such as a time constant.

    Parameters
    ----------
    name, unit
        The number.
    default, low, high
        Where it starts and its plausible range.
    grid
        Values that are tried in screening.
    logarithmic
        Whether equal ratios count alike (else equal differences).
    whole
        Never fitted, only tried: at the values of the grid and,
    finest
        about the best of them, at ever closer ones down to this distance. 0: no closer.
    term
        The magnitude it belongs to, such as the state in which one cable of many begins: it counts
        where that is on, and may well come to the end of its range. "": it belongs to all.
    between
        It leads from one law to another: at the end of its range it is one of them.
    low_is
        And where that is its low end, this candidate, if it is not "".
    """

    name: str
    unit: str
    default: float
    low: float
    high: float
    grid: tuple[float, ...] = ()
    logarithmic: bool = True
    whole: bool = False
    finest: float = 0.0
    term: str = ""
    between: bool = False
    low_is: str = ""

    def counted(self, value: float) -> float:
        """A value as fits count it: its logarithm, where equal ratios count alike."""
        return log(value) if self.logarithmic else value

    def is_low(self, value: float) -> bool:
        """Whether a value is at the low end of the range, within `AT_END` of that."""
        low = self.counted(self.low)
        return self.counted(value) - low < AT_END * (self.counted(self.high) - low)


@dataclass(frozen=True)
class Candidate:
    """Something the simulator may have left out.

    Parameters
    ----------
    name, title
        Identifier, and what it is in words.
    side
        Where it acts: "plant", "parameter", "drive", "cell", "camera", "clock" for a machine;
        any words for another system.
    terms
        Its magnitudes.
    shapes
        Its other numbers.
    form_share
        How far the true law may differ from this one, as a share of what it does: 0.02 for a gain,
        0.15 for a friction law.
    together
        Terms act one by one (False), or only all at once (True).
    chosen_terms
        At most so many free numbers at once; 0: no limit.
    shareable
        Terms of one parameter at several places may have one value.
    combinations
        Sets of terms that are tried as wholes, beside single ones, such as the posts of a frame.
    prior
        How likely it is beforehand, against others.
    fixed
        Its magnitude is not free: there or not there.
    family
        Laws of one thing: two of a family are less likely both there.
    grows
        What it does grows as the square of its magnitude: it is screened at the whole of its step,
        for a little of it tells nothing.
    bends
        What it does is in proportion to its magnitude as long as that is little, as of a gap that
        is far narrower than the way through it: a ring looks at the whole of its step as well.
    shown
        Terms that samples show by themselves, without any simulation: where no simulation can
        follow them, this is there whatever else is.
    akin
        Names of laws of other things that may do nearly the same: each is led from where this one
        has come to, as those of its family are, and both may be there. Names that are not listed
        count for nothing.
    """

    name: str
    title: str
    side: str
    terms: tuple[Term, ...]
    shapes: tuple[Shape, ...] = ()
    form_share: float = 0.1
    together: bool = False
    chosen_terms: int = 0
    shareable: bool = True
    combinations: tuple[tuple[str, ...], ...] = ()
    prior: float = 1.0
    fixed: bool = False
    family: str = ""
    grows: bool = False
    bends: bool = False
    shown: tuple[str, ...] = ()
    akin: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """Of what it is a law: its family's, or its own."""
        return self.family or self.name

    def is_kin(self, other: "Candidate") -> bool:
        """Whether another law may do as well in its place."""
        return other.name in self.akin or (self.family != "" and self.family == other.family)

    @property
    def spreads(self) -> bool:
        """Whether it may be in all its places alike, and as well in a few, or of its own size."""
        spread = len({one.parameter for one in self.terms}) < len(self.terms)
        return spread and self.shareable and not self.chosen_terms

    def groups(self, terms: Sequence[str], shared: bool) -> tuple[tuple[str, ...], ...]:
        """Terms that have one value, in their order: where shared, all those of one parameter."""
        if not shared:
            return tuple((one,) for one in terms)
        parameters = {one.name: one.parameter for one in self.terms}
        kinds = dict.fromkeys(parameters[one] for one in terms)
        return tuple(tuple(one for one in terms if parameters[one] == kind) for kind in kinds)

    def shapes_of(self, terms: Collection[str]) -> tuple[Shape, ...]:
        """Those that count where these terms are on."""
        return tuple(one for one in self.shapes if not one.term or one.term in terms)

    def variants(self) -> tuple[dict[str, float], ...]:
        """Every combination of the shapes' screening values."""
        found: list[dict[str, float]] = [{}]
        for shape in self.shapes:
            found = [
                {**one, shape.name: value}
                for one in found
                for value in (shape.grid or (shape.default,))
            ]
        return tuple(found)


@dataclass(frozen=True)
class Setting:
    """A candidate with numbers.

    Parameters
    ----------
    values
        Of its terms; those left out are zero.
    shapes
        Of its shapes; those left out have their default.
    """

    values: Mapping[str, float]
    shapes: Mapping[str, float] = field(default_factory=dict)
