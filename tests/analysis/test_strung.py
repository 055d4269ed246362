"""What a recording shows of its strings, and up to when it can be foretold where they grow."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from recorded_by import STILL, by_model

from analysis.challenge.rigs import cdpr8
from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.strung import strung
from analysis.engine.array import Array
from analysis.engine.bundle import Bundle, Segment
from analysis.engine.system import Point, Prediction
from cdpr8.rigfile import Excitation, Rig
from model import Machine
from model.rest import tones_hz

SIGMA = 0.01
T_S = np.arange(0.0, 10.0, 0.01)
STRINGS = np.array([False, False, True])
WHOLE = Bundle(
    ("x",), ("N",), T_S, np.zeros((len(T_S), 1)), np.array([[SIGMA**2]]), (Segment(0.0, 10.0),)
)


def seeing(of_strings: Array) -> Callable[[Sequence[Point]], Sequence[Prediction]]:
    """Simulations in which a string does so much, in units of the noise, for each sigma."""

    def see(points: Sequence[Point]) -> Sequence[Prediction]:
        return [
            [(one.nuisance[0] + SIGMA * one.nuisance[2] * of_strings)[:, None]] for one in points
        ]

    return see


def test_strings_that_do_nothing_are_not_shown_whatever_else_is_off() -> None:
    told = strung(seeing(np.full(len(T_S), 0.01)), STRINGS, [WHOLE])
    assert not told.shown_in([WHOLE])
    assert told.foretold == 1.0


def test_strings_that_are_set_off_are_shown_and_foretold_to_the_end() -> None:
    told = strung(seeing(200.0 * np.exp(-T_S)), STRINGS, [WHOLE])
    assert told.shown_in([WHOLE])
    assert told.foretold == 1.0


def test_strings_that_grow_are_foretold_up_to_where_they_show() -> None:
    growing = 1e-7 * np.exp(2.0 * T_S)
    told = strung(seeing(growing), STRINGS, [WHOLE])
    # What may be off by two or three sigmas, and grows the faster for it, is below the noise there.
    assert 0.0 < np.interp(10.0 * told.foretold, T_S, growing) < 0.1
    assert told.foretold > 0.5


def in_tune(rig: Rig) -> Rig:
    """A rig whose strings all sound at half of the platform's highest tone."""
    machine = Machine.from_rig(rig)
    highest_hz = float(tones_hz(machine).max())
    cables = []
    for one, tension_n in zip(rig.cable, machine.pretension, strict=True):
        length_m = np.linalg.norm(np.subtract(one.base_m.value, one.anchor_m.value))
        density = float(tension_n / (highest_hz * length_m) ** 2)
        known = one.line_density_kg_per_m
        known = known.model_copy(update={"value": density, "sigma": 0.05 * density})
        cables.append(one.model_copy(update={"line_density_kg_per_m": known}))
    return rig.model_copy(update={"cable": tuple(cables)})


@pytest.mark.parametrize("tuned", [False, True])
def test_a_platform_let_go_counts_up_to_where_strings_in_tune_with_it_grow(
    tmp_path: Path, tuned: bool
) -> None:
    excitation = Excitation(
        amplitude_deg=2.0, frequency_hz=1.5, motion_s=4.1667, ramp_s=0.0, rest_s=2.0,
        **(STILL | {"cable_offset_m": 1e-4}),
    )  # fmt: skip
    rig = in_tune(cdpr8()) if tuned else cdpr8()
    recorded = by_model(tmp_path / "let go", [], excitation, rig=rig)
    machine = RecordedMachine([recorded], ("stiffness",), workers=1).with_strings()
    (seen,) = machine.recordings
    assert len(seen.notes) - len(recorded.notes) == tuned
    end_s = [max(one.end_s for one in bundle.segments) for bundle in seen.bundles]
    if not tuned:
        assert end_s == [max(one.end_s for one in each.segments) for each in recorded.bundles]
        return
    assert "strings of the cables" in seen.notes[-1]
    # The motion has ended by then: strings have nothing to grow from before.
    assert all(2.0 + 4.1667 < one < excitation.duration_s - 0.5 for one in end_s)
    assert machine.bundles == seen.bundles
