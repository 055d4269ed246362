"""The commanded motion, as a rig file and a run's start record state it."""

from collections.abc import Iterable
from typing import Any, Literal, Self

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from cdpr8.rigfile.section import Section, Vector

Ramp = Literal["quintic", "raised_cosine", "cubic", "septic"]
Ending = Literal["ramp_within", "ramp_beyond", "at_once"]


class Excitation(Section):
    """The commanded motion X*(t), on the tension clock (design, section 4).

    X* = 0 until `motion_start_s`; then `amplitude_deg` w(tau) sin(2 pi f tau) about one axis,
    with w rising from 0 to 1 over `ramp_s` by the law `ramp` and, by the same law mirrored, ending
    as `ending` says; then rest again. With ``ramp_s = 0`` the motion starts in the state X*, X*'
    (the paper's case).
    """

    axis: Literal["roll", "pitch", "yaw"] = "pitch"
    amplitude_deg: float = Field(
        default=2.0, ge=0.0, le=30.0, description="0: nothing is commanded (rest, a free decay)"
    )
    frequency_hz: float = Field(default=2.06, gt=0.0, le=50.0)
    rest_s: float = Field(
        default=1.0,
        ge=0.0,
        description="before the motion, and after it; where that before it was another, "
        "motion_start_s says so",
    )
    motion_start_s: float | None = Field(default=None, ge=0.0, description="default: rest_s")
    motion_s: float = Field(default=8.0, gt=0.0, description="length of the motion with ramps")
    ramp_s: float = Field(default=0.5, ge=0.0)
    ramp: Ramp = Field(
        default="quintic",
        description="how w rises, x = tau/ramp_s: quintic 10x^3 - 15x^4 + 6x^5, "
        "raised_cosine (1 - cos pi x)/2, cubic 3x^2 - 2x^3, septic 35x^4 - 84x^5 + 70x^6 - 20x^7",
    )
    ending: Ending = Field(
        default="ramp_within",
        description="w falls over the last ramp_s of motion_s (ramp_within), over another ramp_s "
        "after it (ramp_beyond), or at once at its end (at_once)",
    )
    drive: Literal["wrench", "winch"] = Field(
        default="wrench",
        description="wrench: the force and moment about the rig file's centre of mass that make "
        "the rig file's machine follow X*, with elastic cables that do not vibrate; winch: each "
        "winch pays out what its cable's length changes by on X*. Either is a table of the time: "
        "nothing corrects it, and the platform rings about X*",
    )
    platform_offset_m: Vector = Field(
        default=(1e-4, 0.0, 0.0), description="X_p0, at the motion's start"
    )
    cable_offset_m: float = Field(default=1e-4, description="X_w0, at the motion's start")

    @model_serializer(mode="wrap")
    def _as_stated(self, serialize: SerializerFunctionWrapHandler) -> Any:
        """A law that nobody stated is not stated by writing it down."""
        found = serialize(self)
        if isinstance(found, dict):
            for name in self._unstated:
                found.pop(name, None)
        return found

    def __repr_args__(self) -> Iterable[tuple[str | None, Any]]:
        """As stated, too: a run's identifier is made of it."""
        return [one for one in super().__repr_args__() if one[0] not in self._unstated]

    @property
    def _unstated(self) -> set[str]:
        return {"ramp", "ending"} - self.model_fields_set

    @model_validator(mode="after")
    def _ramps_fit(self) -> Self:
        within = 2.0 if self.ending == "ramp_within" else 1.0
        if within * self.ramp_s > self.motion_s:
            ramps = "two ramps" if self.ending == "ramp_within" else "a ramp"
            raise ValueError(f"{ramps} of {self.ramp_s} s do not fit a motion of {self.motion_s} s")
        return self

    @property
    def rests(self) -> bool:
        """Whether the platform is neither driven nor let go."""
        return self.amplitude_deg == 0.0 and not any(self.platform_offset_m)

    @property
    def start_s(self) -> float:
        """When the motion starts."""
        return self.rest_s if self.motion_start_s is None else self.motion_start_s

    @property
    def end_s(self) -> float:
        """When the motion ends, with its last ramp."""
        beyond_s = self.ramp_s if self.ending == "ramp_beyond" else 0.0
        return self.start_s + self.motion_s + beyond_s

    @property
    def duration_s(self) -> float:
        """Rest, motion and rest."""
        return self.end_s + self.rest_s

    @property
    def steady_window_s(self) -> tuple[float, float]:
        """From the end of the first ramp to the start of the last, if there is one."""
        last_s = 0.0 if self.ending == "at_once" else self.ramp_s
        return self.start_s + self.ramp_s, self.end_s - last_s
