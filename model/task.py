"""One simulation as asked for, made ready for either kernel."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from inspect import signature
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import NDArray

from cdpr8.errors import UsageError
from cdpr8.rigfile.excitation import Excitation
from cdpr8.rigfile.schema import Rig
from model.drive import drive_table
from model.extras import pack, state_count
from model.kept_drive import DriveKey, Resting, followed, resting_wrench, table_at_stages
from model.kernel import PLATFORM_STATES, STATES, Extras
from model.library.effect import Acts, Law
from model.library.selection import ActiveEffect, of_rig, those_that_act
from model.machine import Machine
from model.method import Method, find_method
from model.motion import Motion, RampedSine
from model.rest import gained_at_once, rest_state
from model.steps import Steps, divide, jumps_at_s, steps_a_row
from model.strings import UNCHANGED, Strings
from model.tabulated import drive_at_stages

Array = NDArray[np.float64]

SHORTEST_STEP_S = 2e-5
"""Steeper friction than this can follow trembles at rest, by less than its own switch."""

DRIVES = ("wrench", "winch")

THRIFTY = ("dop853", "dp5")
"""Methods that a fit chooses from."""

ALMOST = 1.05
"""In a fit what sticks may turn in a step by so much more: steps are whole parts of a row, and one
that is a little too long for three would else become one for two."""


@dataclass(frozen=True)
class Disturbance:
    """What is added to the state when the motion starts (Section 4.1 of the paper).

    Parameters
    ----------
    platform_offset_m
        X_p0 in O-XYZ, m.
    cable_offset_m
        X_w0 at mid-span: of every cable, or of each, shape (8,); m.
    """

    platform_offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    cable_offset_m: float | tuple[float, ...] = 0.0

    @classmethod
    def from_excitation(cls, excitation: Excitation) -> Self:
        """The disturbance a rig file's [excitation] asks for."""
        return cls(excitation.platform_offset_m, excitation.cable_offset_m)


NO_DISTURBANCE = Disturbance()


@dataclass(frozen=True)
class Task:
    """What is to be simulated; the arguments of `model.simulate` that are not its method.

    Parameters
    ----------
    rig
        The machine.
    excitation
        The commanded motion and the disturbances; default: the rig's own.
    motion
        Any other motion, in place of the excitation's.
    effects
        Left-out effects; default: those the rig file has switched on.
    excitation_effect
        False sets X_w = 0 in Eq. 18.
    disturbance
        Acts when the motion starts. Default: the excitation's with excitation effect, none
        without.
    nominal
        The machine the drive was made for; default: `rig`.
    drive
        "wrench" or "winch"; default: the excitation's.
    strings
        What the cables are as strings beside the rig file.
    """

    rig: Rig
    excitation: Excitation | None = None
    motion: Motion | None = None
    effects: Sequence[ActiveEffect] | None = None
    excitation_effect: bool = True
    disturbance: Disturbance | None = None
    nominal: Rig | None = None
    drive: str | None = None
    strings: Strings = UNCHANGED
    acting: tuple[ActiveEffect, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        effects = of_rig(self.rig.physics) if self.effects is None else self.effects
        object.__setattr__(self, "acting", those_that_act(effects))
        if self.drive_kind not in DRIVES:
            raise UsageError(f"no drive {self.drive_kind!r}", allowed=", ".join(DRIVES))

    @property
    def asked(self) -> Excitation:
        """The excitation, the rig's own where none was given."""
        return self.rig.excitation if self.excitation is None else self.excitation

    @property
    def drive_kind(self) -> str:
        """The word "wrench" or "winch"."""
        return self.asked.drive if self.drive is None else self.drive

    @cached_property
    def nominal_machine(self) -> Machine:
        """The machine the drive was made for."""
        machine = Machine.from_rig(self.nominal or self.rig)
        for one in self.acting:
            if one.effect.reckoned is not None:
                machine = _asked(one.effect.reckoned, one.numbers(), machine=machine)
        return machine

    @cached_property
    def machine(self) -> Machine:
        """The plant: the rig's, with the parameters that effects move."""
        machine = self.strings.of(Machine.from_rig(self.rig))
        for one in self.acting:
            if one.effect.change is not None:
                machine = one.effect.change(machine, **one.columns())
        return machine

    @cached_property
    def command(self) -> Motion:
        """X*, as commanded."""
        return RampedSine.from_excitation(self.asked) if self.motion is None else self.motion

    @cached_property
    def driven(self) -> Motion:
        """X* as the drive makes it."""
        motion = self.command
        for one in self.acting:
            if one.effect.command is not None:
                motion = one.effect.command(motion, **one.numbers())
        return motion

    @cached_property
    def extras(self) -> Extras | None:
        """The effects in the kernel."""
        return pack(self.machine, self.acting)

    @property
    def states(self) -> int:
        """Length of the state vector."""
        return state_count(self.acting)

    @property
    def cells_behind_pulley(self) -> NDArray[np.bool_]:
        """Which cells sit behind their pulley, shape (8,)."""
        return np.array([cable.cell != "platform" for cable in self.rig.cable])

    def step_s(self, method: Method, *, thrifty: bool = False, finer: float = 1.0) -> float:
        """The longest step a method should take, by the highest tone and the sharpest switch.

        Parameters
        ----------
        method
            Of which.
        thrifty
            For a fit; see `thrifty`.
        finer
            So many times as many steps for each tone.
        """
        of_tones_s = method.step_s(self._highest_tone_hz, thrifty=thrifty) / finer
        decay = self._fastest_decay_1_per_s
        of_decay_s = max(method.stable / decay, SHORTEST_STEP_S) if decay > 0.0 else np.inf
        stuck = self._stuck_rad_per_s
        turn_rad = method.turn_rad * (ALMOST if thrifty else 1.0)
        of_stuck_s = max(turn_rad / stuck, SHORTEST_STEP_S) if stuck > 0.0 else np.inf
        return float(min([of_tones_s, of_decay_s, of_stuck_s, *self._longest_steps_s]))

    @cached_property
    def _longest_steps_s(self) -> list[float]:
        """What each effect that is on says of steps, s."""
        found = []
        for one in self.acting:
            longest_s = one.effect.longest_step_s
            if callable(longest_s):
                longest_s = float(np.min(_asked(longest_s, one.columns())))
            found.append(np.inf if longest_s is None else longest_s)
        return found

    @cached_property
    def _highest_tone_hz(self) -> float:
        return float(max(self.machine.cable_tones_hz.max(), self.machine.platform_tones_hz.max()))

    @cached_property
    def _fastest_decay_1_per_s(self) -> float:
        """How fast the steepest friction brings the platform to rest."""
        return self.machine.fastest_decay_1_per_s(self._slopes("steepest"))

    @property
    def stuck_hz(self) -> float:
        """The quickest tone of the platform while all that can stick does; 0: nothing can."""
        return self._stuck_rad_per_s / (2.0 * np.pi)

    @cached_property
    def _stuck_rad_per_s(self) -> float:
        springs = self._slopes("stiffest")
        return self.machine.fastest_tone_rad_per_s(springs) if springs.any() else 0.0

    def _slopes(self, law: Literal["steepest", "stiffest"]) -> Array:
        """What that law of all effects adds up to in each cable, shape (8,)."""
        found = np.zeros(self.machine.cables)
        for one in self.acting:
            slope = getattr(one.effect, law)
            if slope is not None:
                found += _asked(slope, one.columns(), pretension=self.machine.pretension)
        return found

    def thrifty(
        self, output_rate_hz: float, finer: Mapping[str, float] | None = None
    ) -> tuple[str, float]:
        """The method and step that evaluate the right-hand side least often for a fit.

        Parameters
        ----------
        output_rate_hz
            Rows a second.
        finer
            Method -> so many times as many steps for each tone, where a ring is so strong that a
            thousandth of it stands out of the noise.

        Returns
        -------
        str, float
            Name of the method and step, s, of whole rows or a whole part of one: such as keep a
            ring to about a thousandth of its amplitude over hundreds of periods.
        """
        found = []
        for name in THRIFTY:
            method = find_method(name)
            step_s = self.step_s(method, thrifty=True, finer=(finer or {}).get(name, 1.0))
            divisions, joined = steps_a_row(output_rate_hz, step_s, join=method.inside)
            stages = method.step_weights.size if joined == 1 else method.nodes.size
            found.append((stages * divisions / joined, name, joined / divisions / output_rate_hz))
        _, name, step_s = min(found)
        return name, step_s

    def steps(self, method: Method, output_rate_hz: float, step_s: float | None) -> Steps:
        """The steps to take."""
        longest_step_s = self.step_s(method) if step_s is None else step_s
        return divide(self.driven, output_rate_hz, longest_step_s, join=method.inside)

    def drive_at_stages(self, method: Method, steps: Steps) -> Array:
        """The drive's table; kept for the next task with the same drive."""
        return table_at_stages(self.drive_key(method, steps))

    def drive_key(self, method: Method, steps: Steps) -> DriveKey:
        """Equal for tasks that share their drive's table."""
        return DriveKey(self.nominal_machine, self.driven, steps, method.name, self.drive_kind)

    def drive_at(self, time_s: Array, within_s: Array) -> Array:
        """The drive at any times; see `model.drive.drive_table`."""
        return drive_table(self.nominal_machine, self.driven, time_s, within_s, self.drive_kind)

    def drive_of_steps(self, method: Method, point_s: Array) -> Array:
        """The drive at the stages of some steps, which are not kept."""
        return drive_at_stages(
            self.nominal_machine, self.driven, point_s, method.nodes, self.drive_kind
        )

    def drive_at_outputs(self, steps: Steps) -> Array:
        """The drive at each output: what a winch has paid out; else one row that is not read."""
        if self.drive_kind == "wrench":
            return np.zeros((1, 6))
        time_s = steps.output_s[:, None]
        table = drive_table(self.nominal_machine, self.driven, time_s, time_s, self.drive_kind)
        return np.ascontiguousarray(table[:, 0])

    def initial(self, steps: Steps) -> Array:
        """The state before the first point."""
        if not steps.jump_point:
            return np.zeros(self.states)
        state = self._state_at(0.0, -1.0)
        if self.drive_kind == "wrench" and not state[:12].any():
            return self._at_rest.copy()
        return state

    @cached_property
    def _at_rest(self) -> Array:
        """How the plant hangs, with the drive as it is at rest."""
        if self.machine is self.nominal_machine or not self._differs:
            return np.zeros(self.states)
        wrench = resting_wrench(Resting(self.nominal_machine, self.driven))
        return rest_state(self.machine, self.extras, self.acting, wrench, self.states)

    @property
    def _differs(self) -> bool:
        """Whether the plant may hang elsewhere than the machine that the drive was made for."""
        return bool(self.acting) or any(
            not np.array_equal(np.asarray(one), np.asarray(other))
            for one, other in zip(self.machine.plant(), self.nominal_machine.plant(), strict=True)
        )

    def jump(self, steps: Steps) -> Array:
        """What the state gains when the motion starts: any jump of X* and X*', X_p0 and X_w0."""
        at, middle_s = steps.jump_point, steps.middle_s[:, 0]
        start_s = jumps_at_s(self.driven)
        jump = self._state_at(start_s, middle_s[min(at, len(middle_s) - 1)])
        if at > 0:
            jump -= self._state_at(start_s, middle_s[at - 1])
        disturbance = self._disturbance
        at_once = np.concatenate([disturbance.platform_offset_m, np.zeros(3), jump[6:12]])
        jump[:3] += disturbance.platform_offset_m
        if at_once.any():
            rest = self.initial(steps)
            jump += gained_at_once(self.machine, self.extras, self.acting, rest, at_once)
        if self.excitation_effect:
            cables = (STATES - PLATFORM_STATES) // 2
            jump[PLATFORM_STATES : PLATFORM_STATES + cables] += disturbance.cable_offset_m
        return jump

    @property
    def _disturbance(self) -> Disturbance:
        if self.disturbance is not None:
            return self.disturbance
        if self.excitation_effect:
            return Disturbance.from_excitation(self.asked)
        return NO_DISTURBANCE

    def _state_at(self, time_s: float, within_s: float) -> Array:
        """The state of a platform that follows X*, cables at rest."""
        state = np.zeros(self.states)
        state[0:6], state[6:12] = followed(self.driven, time_s, within_s)
        return state


def _asked(law: Law, numbers: Mapping[str, Any], **more: Any) -> Any:
    """What a law says of those of an effect's numbers, and of what else is known, that it takes."""
    known = {**numbers, **more}
    return law(**{name: known[name] for name in signature(law).parameters})


def is_measurement(effect: ActiveEffect) -> bool:
    """Whether an effect changes what is recorded, not what happens."""
    return effect.effect.acts in (Acts.CELL, Acts.CAMERA, Acts.CLOCK)
