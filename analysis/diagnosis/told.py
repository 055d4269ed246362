"""A cause as a sentence needs it: its cables as a subject, its numbers with uncertainty."""

from collections.abc import Mapping
from typing import Any

from analysis.diagnosis.spelling import cables, listed, number

ALIKE = 0.12
"""Cables whose values differ by less than this share are told together."""


class Told:
    """What a sentence can say of a cause.

    Parameters
    ----------
    cause
        One of the statement's causes.
    """

    def __init__(self, cause: Mapping[str, Any]) -> None:
        self._parameters: Mapping[str, Any] = cause["parameters"]
        self.cables: list[int] = list(cause["where"]["cables"])

    @property
    def who(self) -> str:
        """The cables it acts on, as a subject."""
        return cables(self.cables)

    @property
    def whose(self) -> str:
        """The cells of these cables."""
        return f"the force cell{'' if len(self.cables) == 1 else 's'} of {cables(self.cables)}"

    def does(self, one: str, many: str) -> str:
        """The verb's form for as many cables."""
        return one if len(self.cables) == 1 else many

    @property
    def names(self) -> list[str]:
        """Its numbers."""
        return list(self._parameters)

    def value(self, name: str) -> float:
        """The (mean) value; 0 where it is not told."""
        return float(self._parameters.get(name, {}).get("value", 0.0))

    def of(self, name: str) -> str:
        """A number with its uncertainty; cables that differ are told apart."""
        entry = self._parameters.get(name)
        if entry is None:
            return "an amount that was not told"
        groups = self._groups(entry)
        if len(groups) < 2:
            return number(name, entry["value"], entry["sigma"], entry["unit"])
        parts = [
            f"{number(name, value, sigma, entry['unit'])} ({cables(own)})"
            for own, value, sigma in groups
        ]
        return listed(parts)

    def signed(self, name: str, more: str, less: str) -> str:
        """A number with a word for its sign: "2.0 ± 0.1 % too high"."""
        entry = self._parameters.get(name)
        if entry is None:
            return "an amount that was not told"
        groups = self._groups(entry) or [([], entry["value"], entry["sigma"])]
        parts = []
        for own, value, sigma in groups:
            spelled = number(name, abs(value), sigma, entry["unit"])
            place = f" ({cables(own)})" if len(groups) > 1 else ""
            parts.append(f"{spelled} {more if value >= 0.0 else less}{place}")
        return listed(parts)

    def all_of(self, *names: tuple[str, str]) -> str:
        """Those of several numbers that are told, each after its name in words."""
        found = [f"{word} {self.of(name)}" for name, word in names if name in self._parameters]
        return listed(found)

    def _groups(self, entry: Mapping[str, Any]) -> list[tuple[list[int], float, float]]:
        """Cables of about one value, with its mean and sigma."""
        own = {
            int(cable): (float(value), float(entry.get("sigma_cables", {}).get(cable, 0.0)))
            for cable, value in entry.get("cables", {}).items()
            if not self.cables or int(cable) in self.cables
        }
        groups: list[tuple[list[int], float, float]] = []
        members: list[int] = []
        for cable in sorted(own, key=lambda c: own[c][0]):
            if members:
                first, last = own[members[0]], own[cable]
                apart = abs(last[0] - first[0])
                near = max(ALIKE * abs(last[0]), 2.0 * max(first[1], last[1]))
                if apart > near or first[0] * last[0] < 0.0:
                    groups.append(_group(members, own))
                    members = []
            members.append(cable)
        if members:
            groups.append(_group(members, own))
        return sorted(groups)


def _group(
    members: list[int], own: Mapping[int, tuple[float, float]]
) -> tuple[list[int], float, float]:
    values = [own[cable] for cable in members]
    count = len(values)
    return (
        sorted(members),
        sum(one[0] for one in values) / count,
        max(one[1] for one in values),
    )
