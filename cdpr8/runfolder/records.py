"""start.json and stop.json: what is known before the first sample, and how the run ended."""

from datetime import datetime
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, model_serializer

from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.schema import RegionOfInterest
from cdpr8.runfolder.tables import SCHEMA_VERSION

UNKNOWN = "unknown"
"""What stands in a record for an amplifier's dialect, or its filter's delay, that nobody knows."""


class Record(BaseModel):
    """A JSON record; keys of later versions are kept, not refused."""

    model_config = ConfigDict(extra="allow", frozen=True)


class Node(Record):
    """One amplifier as it answered before the run."""

    cable: int = Field(ge=1, le=8)
    address: int
    identity: str = Field(default="", description="the answer to IDN?")
    settings: dict[str, str] = Field(
        default_factory=dict,
        description="command -> answer: written and read back, and the amplifier's own curve (LDW, "
        "LWT), linearisation (LIC), zero at power-on (ZSE) and trigger (TRC); ? where it has none",
    )
    found: dict[str, str] = Field(
        default_factory=dict,
        description="command -> answer before anything was written: scaling (NOV), net or gross "
        "(TAS), zero tracking (ZTR), tare (TAV, never changed), calibration weight (CWT), steps "
        "(RSN)",
    )
    zero_mv_per_v: float = Field(default=0.0, description="host-side zero")
    zero_taken: str = Field(default="never", description="when the zero was taken")
    profile: str | None = Field(
        default=None,
        description="the dialect, chosen by the identity (AD104, AD101B/AD103 or FIT class; of "
        "other electronics any name); unknown: values were asked for as text",
    )
    value_bytes: int | None = Field(default=None, description="bytes of one value on the line")
    output_period_s: float | None = Field(
        default=None,
        description="between two values inside the amplifier, nominal; measured before the run "
        "where the dialect is unknown",
    )
    sampling_sigma_s: float | None = Field(
        default=None,
        description="standard uncertainty of the instants in tension.csv: on a bus the output "
        "period over the square root of 12, each amplifier for itself; at most that, where the "
        "dialect is unknown. It is the age of a value when it was asked for: of each sample "
        "another, or of a second's samples the same, where asking kept step with the amplifier",
    )
    filter_delay_s: float | None = Field(
        default=None,
        description="of the amplifier's filter and averaging; taken off the times at reading, "
        "never in tension.csv",
    )
    filter_delay_sigma_s: float | None = Field(default=None, description="its standard uncertainty")
    filter_delay_from: Literal["measured", "from the cut-off", "unknown"] | None = Field(
        default=None,
        description="where it comes from: filter_delay_s of the rig file, or first order from the "
        "filter's cut-off, with the mean over an output period; unknown: nothing is taken off",
    )


class ClockAnchor(Record):
    """The same instant on the run's clock and on the wall."""

    t_s: float
    wall: datetime


class CameraStart(Record):
    """The camera as it was set."""

    source: str
    fps: float
    exposure_s: float
    width_px: int
    height_px: int
    region_of_interest: RegionOfInterest | None = None


class StartRecord(Record):
    """start.json, on disk before the first sample."""

    schema_version: int = SCHEMA_VERSION
    id: str
    simulated: bool
    reconstruction: str | None = Field(
        default=None, description="said in words where the data were made, not measured"
    )
    rig_file: str
    rig_sha256: str
    excitation: Excitation
    motion_start_known: bool = Field(
        description="whether the start of the motion was recorded on the tension clock"
    )
    nodes: tuple[Node, ...] = ()
    sweep: Literal["polled", "broadcast", "streaming"] | None = Field(
        default=None,
        description="how values were taken: asked for one by one; measured by all after one "
        "broadcast trigger, and then fetched; or sent unasked on a port for each amplifier",
    )
    camera: CameraStart | None = None
    clock_anchor: ClockAnchor
    import_map: str | None = Field(
        default=None, description="how another program's table was read, where one was"
    )
    command_log: str | None = Field(
        default=None,
        description="which log of the winch controller was recorded, and how it was read; "
        "absent where there is none",
    )
    seed: int | None = None
    versions: dict[str, str] = Field(default_factory=dict)

    @model_serializer(mode="wrap")
    def _without_a_log_that_is_not(self, serialize: SerializerFunctionWrapHandler) -> Any:
        """Runs without a command log stay what they were, to the byte."""
        found = serialize(self)
        if isinstance(found, dict) and found.get("command_log") is None:
            found.pop("command_log", None)
        return found


class StopRecord(Record):
    """stop.json; a run without one was interrupted and is still loadable."""

    schema_version: int = SCHEMA_VERSION
    reason: Literal["duration", "interrupted", "stopped_at_once", "device", "disk_full"]
    t_s: float
    samples: dict[int, int] = Field(description="cable -> samples written")
    frames: int
    lost: dict[str, int] = Field(default_factory=dict, description="what was lost -> how often")
    clock_anchor: ClockAnchor
