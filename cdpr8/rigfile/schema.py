"""The rig file as data: one class a section (design, section 2). Loading is in `load`."""

from enum import StrEnum
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from cdpr8 import CABLES
from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.parameter import (
    Damping,
    Delay,
    Inertia,
    LineDensity,
    Mass,
    Point,
    Position,
    Pretension,
    Stiffness,
)
from cdpr8.rigfile.section import Section, Vector


class Platform(Section):
    """The rigid platform; points of the platform frame are relative to its origin."""

    mass_kg: Mass
    inertia_kg_m2: Inertia = Field(description="about the centre of mass, in the platform frame")
    centre_of_mass_m: Position = Point(value=(0.0, 0.0, 0.0), sigma=1e-3, unit="m")


class Amplifier(Section):
    """The force cell of one cable and the transducer electronics that read it."""

    address: int = Field(ge=0, le=31)
    port: str = Field(default="", description="its own serial port, where [bus] streaming = true")
    serial_number: str = Field(default="", max_length=7)
    nominal_force_n: float = Field(default=50.0, gt=0.0)
    sensitivity_mv_per_v: float = Field(default=1.0, gt=0.0, description="from the certificate")
    sign: Literal[1, -1] = 1
    noise_n: float = Field(default=0.005, ge=0.0, description="standard deviation at rest")
    filter_delay_s: Delay | None = Field(default=None, description="measured; before the bus's")


class CellPlace(StrEnum):
    """Where a cable's force cell sits; friction between cell and platform is not seen by it."""

    PLATFORM = "platform"
    BASE = "base"
    WINCH = "winch"


class Cable(Section):
    """One cable, from its base point (contact with the pulley) to its anchor on the platform."""

    name: str = ""
    base_m: Position = Field(description="in O-XYZ")
    anchor_m: Position = Field(description="in the platform frame")
    stiffness_n_per_m: Stiffness
    pretension_n: Pretension
    line_density_kg_per_m: LineDensity
    damping_1_per_s: Damping
    cell: CellPlace = CellPlace.PLATFORM
    amplifier: Amplifier | None = None


class Bus(Section):
    """The serial line the amplifiers share; `port = "simulated"` is the built-in rig."""

    port: str = "simulated"
    baud: Literal[1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200] = 115200
    parity: Literal["even", "none"] = "even"
    echo: bool = Field(default=False, description="a 2-wire adapter hears what it sends")
    streaming: bool = Field(
        default=False,
        description="each amplifier has a serial port of its own and sends its values unasked",
    )
    sweep: Literal["polled", "broadcast"] = Field(
        default="polled",
        description="how a value of each amplifier is taken: asked for one by one, or measured by "
        "all after one broadcast trigger and then fetched one by one",
    )
    checksum: bool = Field(
        default=True,
        description="a checksum guards each value, in the place of the amplifier's status byte; "
        "overload is then seen from the value",
    )
    output_format: int = Field(default=24, ge=0, le=255, description="COF of the AED protocol")
    output_rate: int = Field(default=0, ge=0, le=7, description="ICR of the AED protocol")
    filter: int = Field(default=0, ge=0, le=10, description="ASF of the AED protocol")
    filter_delay_s: Delay | None = Field(
        default=None,
        description="measured, of the amplifiers with this filter and output_rate; left out: first "
        "order, from the filter's cut-off",
    )

    @model_validator(mode="after")
    def _one_kind_of_sweep(self) -> Self:
        if self.streaming and self.sweep == "broadcast":
            raise ValueError(
                'sweep = "polled" with streaming = true: on a port of its own each amplifier sends '
                "unasked, and no broadcast reaches all of them"
            )
        return self


class Intrinsics(Section):
    """A pinhole camera in OpenCV's convention, for the full sensor image."""

    width_px: int = Field(gt=0)
    height_px: int = Field(gt=0)
    fx_px: float = Field(gt=0.0)
    fy_px: float = Field(gt=0.0)
    cx_px: float
    cy_px: float
    distortion: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _five_distortion_coefficients(self) -> Self:
        if len(self.distortion) not in (4, 5, 8, 12, 14):
            raise ValueError("distortion takes 4, 5, 8, 12 or 14 coefficients (OpenCV's order)")
        return self


class CameraPose(Section):
    """Where the camera stands in O-XYZ; `up` points to the top of its image."""

    position_m: Vector
    look_at_m: Vector = (0.0, 0.0, 0.0)
    up: Vector = (0.0, 0.0, 1.0)


class RegionOfInterest(Section):
    """The part of the sensor image that is recorded."""

    x_px: int = Field(ge=0)
    y_px: int = Field(ge=0)
    width_px: int = Field(gt=0)
    height_px: int = Field(gt=0)


class Camera(Section):
    """The camera; `source = "simulated"` renders the plate, else a device number or a path."""

    source: str = "simulated"
    fps: float = Field(default=16.0, gt=0.0)
    exposure_s: float = Field(default=0.005, gt=0.0)
    row_delay_s: float = Field(
        default=0.0, ge=0.0, description="rolling shutter: from one row to the next; 0: global"
    )
    intrinsics: Intrinsics | Annotated[str, Field(pattern=r"^[^/\\\\]+$")] = Field(
        description="a table, or the name of a file beside the rig file"
    )
    pose: CameraPose | None = Field(
        default=None, description="left out: taken from the frames at rest"
    )
    region_of_interest: RegionOfInterest | None = None


class PlatePose(Section):
    """How the plate sits on the platform, in the platform frame."""

    position_m: Vector = Field(description="of the plate's origin")
    normal: Vector = Field(description="points out of the printed side")
    up: Vector = Field(description="points to the top of the print")


class Marker(Section):
    """One square marker; the centre is in the plate's plane, x to the right, y up."""

    id: int = Field(ge=0)
    centre_m: tuple[float, float]
    size_m: float = Field(gt=0.0)


class Grid(Section):
    """Markers in rows and columns about the plate's origin, ids from top left, row by row."""

    columns: int = Field(gt=0)
    rows: int = Field(gt=0)
    size_m: float = Field(gt=0.0)
    gap_m: float = Field(gt=0.0)
    first_id: int = Field(default=0, ge=0)

    def markers(self) -> tuple[Marker, ...]:
        """The grid, marker by marker."""
        pitch = self.size_m + self.gap_m
        return tuple(
            Marker(
                id=self.first_id + row * self.columns + column,
                centre_m=(
                    (column - (self.columns - 1) / 2) * pitch,
                    ((self.rows - 1) / 2 - row) * pitch,
                ),
                size_m=self.size_m,
            )
            for row in range(self.rows)
            for column in range(self.columns)
        )


class Plate(Section):
    """The marker plate on the platform."""

    dictionary: str = "DICT_4X4_50"
    margin_m: float = Field(default=0.01, gt=0.0, description="white border round the markers")
    grid: Grid | None = None
    marker: tuple[Marker, ...] = ()
    pose: PlatePose

    @model_validator(mode="after")
    def _grid_or_markers(self) -> Self:
        if (self.grid is None) == (not self.marker):
            raise ValueError("a plate takes either [plate.grid] or [[plate.marker]], one of them")
        ids = [marker.id for marker in self.markers()]
        if len(set(ids)) != len(ids):
            raise ValueError(f"marker ids repeat: {ids}; each id once")
        return self

    def markers(self) -> tuple[Marker, ...]:
        """All markers, however they were given."""
        return self.grid.markers() if self.grid else self.marker


class Rig(Section):
    """One machine."""

    name: str = "unnamed rig"
    platform: Platform
    cable: tuple[Cable, ...]
    bus: Bus = Bus()
    camera: Camera | None = None
    plate: Plate | None = None
    excitation: Excitation = Excitation()
    physics: dict[str, dict[str, object]] = Field(
        default_factory=dict, description="left-out effects switched on"
    )

    @model_validator(mode="after")
    def _eight_cables(self) -> Self:
        if len(self.cable) != CABLES:
            raise ValueError(f"{len(self.cable)} [[cable]] tables; a rig has {CABLES}, in order")
        return self
