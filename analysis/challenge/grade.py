"""One case graded: what was concealed against what was reported."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

CABLES = frozenset(range(1, 9))


@dataclass(frozen=True)
class Cause:
    """One cause as a diagnosis reports it.

    Parameters
    ----------
    effect
        Its name.
    set
        With those that cannot be told from it.
    probability
        As stated; None where none is.
    side
        Where it is said to sit.
    cables
        Those it names.
    parameters
        Name -> value, and per cable where it is given so.
    """

    effect: str
    set: frozenset[str]
    probability: float | None
    side: str | None
    cables: frozenset[int]
    parameters: Mapping[str, Any]

    @classmethod
    def read(cls, cause: Mapping[str, Any]) -> "Cause":
        """From the diagnosis's JSON (design, section 6)."""
        where = cause.get("where") or {}
        return cls(
            effect=str(cause["effect"]),
            set=frozenset({cause["effect"], *(cause.get("indistinguishable_from") or ())}),
            probability=cause.get("probability"),
            side=where.get("side"),
            cables=frozenset(int(cable) for cable in where.get("cables") or ()),
            parameters=cause.get("parameters") or {},
        )

    def value(self, name: str, cables: frozenset[int]) -> float | None:
        """A parameter's value: over the cables that hold it, where each has its own."""
        told = self.parameters.get(name)
        if told is None:
            return None
        if not isinstance(told, Mapping):
            return float(told)
        each = told.get("cables") or {}
        chosen = [float(v) for key, v in each.items() if not cables or int(key) in cables]
        if chosen:
            return float(np.mean(chosen))
        return None if told.get("value") is None else float(told["value"])


@dataclass(frozen=True)
class Grade:
    """One case.

    Parameters
    ----------
    case, kind
        Its name; "single" or "campaign".
    truth
        The concealed effects, as sealed.
    verdict
        Of the diagnosis; "failed" where it crashed, "missing" where it was not run.
    causes
        As reported, the likeliest first.
    held_out
        Error on data not used, after, in units of the noise.
    seconds
        What it took.
    error
        Why it failed.
    """

    case: str
    kind: str
    truth: tuple[Mapping[str, Any], ...]
    verdict: str
    causes: tuple[Cause, ...]
    held_out: float | None
    seconds: float
    error: str | None

    @property
    def visible(self) -> tuple[Mapping[str, Any], ...]:
        """Concealed effects that the runs can show."""
        return tuple(effect for effect in self.truth if effect["visible"])

    @property
    def reported(self) -> frozenset[str]:
        """Every name in any reported set."""
        return frozenset().union(*(cause.set for cause in self.causes))

    @property
    def right(self) -> bool:
        """Whether nothing that can be seen is missed, and nothing is named where nothing is."""
        if self.verdict in ("failed", "missing"):
            return False
        if not self.visible:
            names = {effect["effect"] for effect in self.truth}
            return self.verdict == "none" or bool(names & self.reported)
        return all(effect["effect"] in self.reported for effect in self.visible)

    @property
    def alone(self) -> bool:
        """Whether the one concealed effect is named, and it alone."""
        return self.reported == {self.truth[0]["effect"]}

    def cause_of(self, effect: str) -> Cause | None:
        """The cause whose set holds an effect."""
        return next((cause for cause in self.causes if effect in cause.set), None)

    def parameter_error(self, effect: Mapping[str, Any]) -> float | None:
        """Relative error of the size of an effect that was named, None where it cannot be said."""
        cause = next((one for one in self.causes if one.effect == effect["effect"]), None)
        wanted = effect["parameters"]
        if cause is None or not wanted:
            return None
        cables = frozenset(effect["cables"])
        pairs = [(cause.value(name, cables), true) for name, true in wanted.items()]
        if all(value is None for value, _ in pairs):
            return None
        off = [(0.0 if value is None else value) - true for value, true in pairs]
        return float(np.linalg.norm(off) / np.linalg.norm([true for _, true in pairs]))

    def cables_right(self, effect: Mapping[str, Any]) -> bool | None:
        """Whether the cables named are those; None where none are named or none hold it."""
        cause = next((one for one in self.causes if one.effect == effect["effect"]), None)
        if cause is None or not cause.cables or not effect["cables"]:
            return None
        return cause.cables == frozenset(effect["cables"])


def grade(truth: Mapping[str, Any], row: Mapping[str, Any] | None) -> Grade:
    """Hold one answer against the truth.

    Parameters
    ----------
    truth
        The case as sealed.
    row
        Its line of the answers, None where it was not run.
    """
    answer = (row or {}).get("answer") or {}
    verdict = answer.get("verdict", "failed" if row else "missing")
    causes = [Cause.read(cause) for cause in answer.get("causes") or ()]
    causes.sort(key=lambda cause: -(cause.probability or 0.0))
    return Grade(
        case=truth["case"],
        kind=truth["kind"],
        truth=tuple(truth["effects"]),
        verdict=verdict,
        causes=tuple(causes),
        held_out=_held_out(answer),
        seconds=float((row or {}).get("seconds") or 0.0),
        error=(row or {}).get("error"),
    )


def _held_out(answer: Mapping[str, Any]) -> float | None:
    """Root mean square over the channels of what `fit` says of held-out data, in noise."""
    channels = ((answer.get("fit") or {}).get("after") or {}).get("held_out")
    if isinstance(channels, int | float):
        return float(channels)
    values = [v for v in (channels or {}).values() if isinstance(v, int | float)]
    return float(np.sqrt(np.mean(np.square(values)))) if values else None
