"""The search's memory: a file that is only appended to, and is sound when cut at any byte."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from cdpr8.errors import DataError

FORMAT = "cdpr8 reconstruction 1"


@dataclass(frozen=True)
class Member:
    """One machine of the population.

    Parameters
    ----------
    cost
        Its misfit.
    vector
        The parameters of `model.reconstruct.layout.BOUNDS`.
    reach
        x of the front and of the rear anchor, m.
    terms, figures
        What the misfit is made of, and what the machine gives, by frequency.
    """

    cost: float
    vector: list[float]
    reach: list[float]
    terms: dict[str, float] = field(default_factory=dict)
    figures: dict[str, dict[str, float]] = field(default_factory=dict)


class Journal:
    """Improvements, generation by generation.

    Parameters
    ----------
    path
        The file; made where there is none.
    identity
        Of the search; a file of another search is refused.
    """

    def __init__(self, path: Path, identity: dict[str, object]) -> None:
        self.members: dict[int, Member] = {}
        self.generations = 0
        header = {"format": FORMAT, **json.loads(json.dumps(identity))}
        whole = self._read(path, header) if path.exists() else 0
        self._file: IO[bytes] = path.open("r+b" if path.exists() else "w+b")
        self._file.truncate(whole)
        self._file.seek(whole)
        if not whole:
            self._write(header)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()

    def keep(self, slot: int, member: Member) -> None:
        """Note that a slot of the population has a new member."""
        self.members[slot] = member
        self._write({"slot": slot, **asdict(member)})

    def close_generation(self) -> None:
        """Note that a generation is whole: a search goes on from here."""
        self.generations += 1
        self._write({"generation": self.generations})

    def _write(self, row: dict[str, object]) -> None:
        self._file.write(json.dumps(row).encode() + b"\n")
        self._file.flush()

    def _read(self, path: Path, header: dict[str, object]) -> int:
        """Take in the whole generations; returns the bytes they take."""
        whole, at = 0, 0
        pending: dict[int, Member] = {}
        for number, line in enumerate(path.read_bytes().splitlines(keepends=True)):
            try:
                row = json.loads(line) if line.endswith(b"\n") else None
            except ValueError:
                row = None
            if row is None:
                break
            at += len(line)
            if number == 0 and row != header:
                raise DataError(
                    "is of another search: its seed, population or bounds differ",
                    where=str(path),
                    remedy="name another folder with --out, or delete the file",
                )
            if number == 0:
                whole = at
            elif "generation" in row:
                self.members |= pending
                pending = {}
                self.generations, whole = int(row["generation"]), at
            else:
                slot = int(row.pop("slot"))
                pending[slot] = Member(**row)
        return whole
