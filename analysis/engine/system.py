"""What the engine is given: recorded channels, a simulator, and what it may have left out."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Ring = Literal["left_out", "damped", "as_is"]
"""Left out, with no bias on other lines; damped, which is cheaper and good for differences of two
simulations; or as the simulator has it."""


@dataclass(frozen=True)
class Segment:
    """A stretch of time over which channels are looked at together.

    Parameters
    ----------
    start_s, end_s
        From and to.
    fundamental_hz
        The motion repeats at this rate: harmonics of it are fitted, and their slow change. None:
        nothing repeats, and the stretch is resolved into lines of a Fourier series over its length.
    highest_hz
        Nothing faster is looked at; None, and nothing repeats: every sample is, resolved into as
        many lines; samples must then be evenly apart.
    held_out
        Kept back when what was found is fitted once more for the proof.
    sealed
        Kept back from everything but the proof: neither parameters nor causes are found by it.
    name
        What to call it, such as "rest" or "steady".
    """

    start_s: float
    end_s: float
    fundamental_hz: float | None = None
    highest_hz: float | None = None
    held_out: bool = False
    sealed: bool = False
    name: str = ""

    def holds(self, t_s: Array) -> NDArray[np.bool_]:
        """Which times lie in it, of shape (n,); its end does not."""
        return np.asarray((t_s >= self.start_s) & (t_s < self.end_s))


@dataclass(frozen=True)
class Bundle:
    """Channels sampled together.

    Parameters
    ----------
    names, units
        Of the channels, length m.
    t_s
        Sample times, shape (n,).
    value
        Shape (n, m).
    covariance
        Of the noise of one sample, shape (m, m); samples are independent.
    segments
        Stretches to look at. Samples outside of all are not used.
    record
        Which recording they belong to, where there are several.
    kind
        Channels of one kind are pictured together, such as "tension" or "pose".
    base_share
        The simulator's own error as a share of the channels' variation, however good its physics.
    tones_hz
        The system's own tones: what is left of a kick long ago cannot be foretold in phase, and so
        lines near a tone, and all above those that the drive cannot reach, name nothing.
    jitter
        What one standard deviation of its instant does to each sample, shape (n, m): the rate at
        which values change there, times that; None: instants are known.
    noise_from
        How many samples the covariance was taken from; 0: it is known.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    t_s: Array
    value: Array
    covariance: Array
    segments: tuple[Segment, ...]
    record: str = ""
    kind: str = ""
    base_share: float = 0.0
    tones_hz: tuple[float, ...] = ()
    jitter: Array | None = None
    jitter_unsure: float = 0.0
    noise_from: int = 0


@dataclass(frozen=True)
class Nuisance:
    """A parameter that is free within its prior throughout.

    Parameters
    ----------
    name
        Unique.
    sigma, unit
        How well it is known.
    cause, term
        The candidate that it is, once it moves further than its prior allows, and which term of
        it; None: it has none.
    step
        Half the width of the difference that tells what it does, in sigmas.
    record
        The only recording that it moves; "": it may move all.
    loose
        Its sigma says how far off it may be at most: all such may be known better, by one share of
        their sigmas, which the recording tells.
    """

    name: str
    sigma: float
    unit: str
    cause: str | None = None
    term: str | None = None
    step: float = 0.5
    record: str = ""
    loose: bool = False


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

    @property
    def kind(self) -> str:
        """Of what it is a law: its family's, or its own."""
        return self.family or self.name

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


@dataclass(frozen=True)
class Point:
    """What is to be simulated.

    Parameters
    ----------
    nuisance
        In sigmas, shape (p,); zero is the nominal.
    effects
        Candidates that are on.
    ring
        What becomes of the system's own ring, where it has one: the phase of a ring that a kick
        left long ago cannot be foretold, and hides what the drive's own lines show.
    upto
        Share of each recording's time that is asked for, from its first sample on: a simulator may
        leave out the rest, and predict anything there.
    records
        Names of the recordings that are asked for; (): all of them. A simulator may leave out
        others, and predict anything in them.
    """

    nuisance: Array
    effects: Mapping[str, Setting] = field(default_factory=dict)
    ring: Ring = "left_out"
    upto: float = 1.0
    records: tuple[str, ...] = ()


Prediction = list[Array]
"""For each bundle its channels at its sample times, shape (n, m)."""


class System(Protocol):
    """Anything that can be simulated and was recorded."""

    @property
    def name(self) -> str:
        """What to call it."""
        ...

    @property
    def bundles(self) -> Sequence[Bundle]:
        """What was recorded."""
        ...

    @property
    def nuisances(self) -> Sequence[Nuisance]:
        """What is free throughout."""
        ...

    @property
    def candidates(self) -> Sequence[Candidate]:
        """What may have been left out."""
        ...

    def simulate(self, points: Sequence[Point], reduce: Callable[[Prediction], Any]) -> list[Any]:
        """Predict what would be recorded, without noise, and keep what `reduce` makes of it."""
        ...


@runtime_checkable
class Ringing(Protocol):
    """A system that says how its numbers move the tones that it rings in."""

    def tones_hz(self, point: Point) -> Array:
        """Its own tones in the first of its recordings, shape (k,), Hz; (0,): not known."""
        ...


def tones_of(system: System, point: Point) -> Array:
    """Tones of a system, whether or not it says them, as `Ringing.tones_hz` has them."""
    return system.tones_hz(point) if isinstance(system, Ringing) else np.zeros(0)


def free_of(system: System) -> list[Candidate]:
    """Candidates of a system whose magnitude is free."""
    return [one for one in system.candidates if not one.fixed]
