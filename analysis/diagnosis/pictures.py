"""What the figures draw, as plain arrays: made once of a diagnosis, kept beside its results."""

import json
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FILE = "diagnose.npz"

_ARRAYS = (
    "t_s",
    "recorded",
    "sigma",
    "before",
    "after",
    "elongation_before_m",
    "elongation_m",
    "rate_m_per_s",
    "harmonics_before",
    "harmonics_after",
)


@dataclass(frozen=True)
class Stretch:
    """A stretch of time that was looked at as one."""

    name: str
    start_s: float
    end_s: float
    held_out: bool
    repeats: bool


@dataclass(frozen=True)
class Record:
    """One run.

    Attributes
    ----------
    name
        Of the run.
    motion_start_s, frequency_hz, axis
        Of its drive; the drive's phase is zero at the start.
    stretches
        Of its tensions.
    peaks_deg
        Largest steady angle, where there is a pose: as the rig file has it simulated, the same at
        the camera's frames only, and recorded.
    """

    name: str
    motion_start_s: float
    frequency_hz: float
    axis: str
    stretches: tuple[Stretch, ...]
    peaks_deg: tuple[float, float, float] | None = None

    def steady(self, t_s: Array) -> NDArray[np.bool_]:
        """Which times lie where the motion repeats."""
        inside = np.zeros(len(t_s), dtype=bool)
        for one in self.stretches:
            if one.repeats:
                inside |= (t_s >= one.start_s) & (t_s < one.end_s)
        return inside

    def phase(self, t_s: Array) -> Array:
        """Part of the drive's cycle, 0 to 1."""
        return np.mod((t_s - self.motion_start_s) * self.frequency_hz, 1.0)


@dataclass(frozen=True)
class Channel:
    """One channel of one run, recorded and simulated.

    Attributes
    ----------
    record, kind, name, unit
        Whose it is. Positions in m, angles in rad, tensions in N.
    cable, stiffness_n_per_m
        Of a tension; 0 of a pose.
    t_s, recorded, sigma
        The samples, and the standard deviation of each, that of its instant included, shape (n,).
    before, after
        Simulated with nothing left out and with the causes in, shape (n,).
    elongation_before_m
        Of the cable, simulated with nothing left out, shape (n,); empty for a pose.
    elongation_m, rate_m_per_s
        Of the cable, simulated with the causes in, shape (n,); empty for a pose.
    harmonics_before, harmonics_after
        Residual at each harmonic of the drive from the mean on, in units of its noise, shape (h,);
        empty where nothing repeats. Of what is drawn, where the ring's phase was found; where not,
        with the ring left out, as it was judged.
    """

    record: str
    kind: str
    name: str
    unit: str
    cable: int
    stiffness_n_per_m: float
    t_s: Array
    recorded: Array
    sigma: Array
    before: Array
    after: Array
    elongation_before_m: Array
    elongation_m: Array
    rate_m_per_s: Array
    harmonics_before: Array = field(default_factory=lambda: np.zeros(0))
    harmonics_after: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def noise(self) -> float:
        """Standard deviation of a sample, on average."""
        return float(np.sqrt(np.mean(self.sigma**2)))


@dataclass(frozen=True)
class Pictures:
    """All that is drawn.

    Attributes
    ----------
    records, channels
        The runs, and their channels.
    named
        Whether anything was left out in the second simulation: where not, `after` is `before`.
    """

    records: tuple[Record, ...]
    channels: tuple[Channel, ...]
    named: bool

    def of(self, record: str, kind: str = "") -> tuple[Channel, ...]:
        """Channels of a run, of one kind."""
        return tuple(c for c in self.channels if c.record == record and kind in ("", c.kind))

    def record(self, name: str) -> Record:
        """A run by its name."""
        return next(one for one in self.records if one.name == name)

    def save(self, folder: Path) -> Path:
        """Write into a folder."""
        meta = {"named": self.named, "records": [asdict(one) for one in self.records]}
        arrays: dict[str, Any] = {}
        rows = []
        for i, channel in enumerate(self.channels):
            rows.append(
                {one.name: getattr(channel, one.name) for one in fields(channel)
                 if one.name not in _ARRAYS}
            )  # fmt: skip
            for name in _ARRAYS:
                precise = name == "t_s"
                arrays[f"{i}_{name}"] = getattr(channel, name).astype("f8" if precise else "f4")
        meta["channels"] = rows
        path = folder / FILE
        np.savez_compressed(path, meta=np.array(json.dumps(meta)), **arrays)
        return path

    @classmethod
    def load(cls, folder: Path) -> "Pictures":
        """Read back what `save` wrote."""
        with np.load(folder / FILE) as stored:
            meta = json.loads(str(stored["meta"]))
            channels = tuple(
                Channel(**row, **{name: stored[f"{i}_{name}"].astype(float) for name in _ARRAYS})
                for i, row in enumerate(meta["channels"])
            )
        records = tuple(
            Record(
                **{
                    **one,
                    "stretches": tuple(Stretch(**s) for s in one["stretches"]),
                    "peaks_deg": tuple(one["peaks_deg"]) if one["peaks_deg"] else None,
                }
            )
            for one in meta["records"]
        )
        return cls(records, channels, meta["named"])
