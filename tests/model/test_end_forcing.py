"""What its moving anchor does to a cable, and the cable to it: no energy is made of nothing."""

import numpy as np
import pytest

from cdpr8.rigfile import Rig
from model import Machine
from model.effects import ActiveEffect, library
from model.extras import pack, state_count
from model.kernel import PLATFORM_STATES, derivative
from tests.model.harness import call

TENSION_N, LENGTH_M, DENSITY = 12.0, 1.7, 9e-3
DIRECTION = np.array([0.48, 0.6, 0.64])
PLANES = {"v": (1, 2, 3), "h": (1, 2, 3)}


def known(random: np.random.Generator) -> dict:
    """A cable that vibrates in all of its modes, and an anchor that moves anyhow."""
    velocity = random.normal(size=3)
    vectors = {"direction": DIRECTION, "anchor_velocity": velocity}
    names = [f"{plane}{n}" for plane, modes in PLANES.items() for n in modes]
    return (
        {
            f"{name}_{axis}": v
            for name, one in vectors.items()
            for axis, v in zip("xyz", one, strict=True)
        }
        | {name: 1e-3 * random.normal() for name in names}
        | {f"{name}_rate": 0.1 * random.normal() for name in names}
        | {"tension": TENSION_N, "length": LENGTH_M, "line_density": DENSITY}
        | {"axial_velocity": 0.0, "damping": 0.0, "forcing_share": 0.7, "reaction_share": 1.0}
        | {"overtone_share": 1.0, "stiffness": 1500.0}
    )


def test_what_the_anchor_puts_into_its_cable_it_takes_from_the_platform() -> None:
    """Power: of the string's modes, each rho L/2 of mass, and of the pull at the anchor."""
    effect = library()["cable_end_forcing"]
    now = known(np.random.default_rng(4))
    mass = 0.5 * DENSITY * LENGTH_M
    tone = np.pi / LENGTH_M * np.sqrt(TENSION_N / DENSITY)
    names = [state.name for state in effect.states]
    rates = dict(zip(names, call(effect.rates, now), strict=True))
    shaken, _ = call(effect.transverse, now)
    # The first mode in the vertical plane is Eq. 17's own.
    rates |= {"v1": now["v1_rate"] + shaken, "v1_rate": -(tone**2) * now["v1"]}
    gained = 0.0
    for plane, modes in PLANES.items():
        for n in modes:
            name = f"{plane}{n}"
            gained += mass * now[f"{name}_rate"] * rates[f"{name}_rate"]
            gained += mass * (n * tone) ** 2 * now[name] * rates[name]
    pulled = call(effect.across, now | {"mid_span": now["v1"]})
    velocity = np.array([now[f"anchor_velocity_{axis}"] for axis in "xyz"])
    assert abs(gained) > 1e-3
    assert np.dot(pulled, velocity) == pytest.approx(-gained, rel=1e-12)
    assert abs(np.dot(pulled, DIRECTION)) < 1e-12


def test_the_kernel_pulls_at_the_anchor_with_the_slope_of_the_cable(rig: Rig) -> None:
    machine, offset_m, mid_span = Machine.from_rig(rig), 1e-3, PLATFORM_STATES + 3
    effect = library()["cable_end_forcing"]

    def rate(reaction_share: float) -> np.ndarray:
        values = {"forcing_share": 1.0, "reaction_share": reaction_share}
        on = (ActiveEffect("cable_end_forcing", values),)
        state = np.zeros(state_count(on))
        state[mid_span] = offset_m
        found = np.zeros_like(state)
        derivative(state, np.zeros(6), machine.plant(), pack(machine, on), found)
        return found

    added = rate(1.0) - rate(0.0)
    length, direction = machine.rest_length[3], machine.structure[:3, 3]
    stretch = np.pi**2 * offset_m**2 / (4.0 * length)
    tension = machine.pretension[3] + machine.stiffness[3] * stretch
    still = dict.fromkeys(("v2", "v3", "h1", "h2", "h3"), 0.0)
    line = dict(zip(("direction_x", "direction_y", "direction_z"), direction, strict=True))
    force = np.array(
        call(
            effect.across,
            {
                "forcing_share": 1.0,
                "reaction_share": 1.0,
                "overtone_share": 1.0,
                "mid_span": offset_m,
                "tension": tension,
                "length": length,
            }
            | still
            | line,
        )
    )
    assert np.linalg.norm(force) == pytest.approx(tension * np.pi * offset_m / length)
    assert added[6:9] * machine.mass == pytest.approx(force, rel=1e-9)
    moment = np.cross(machine.anchor[3], force)
    assert machine.inertia @ added[9:12] == pytest.approx(moment, rel=1e-9)


def test_without_overtones_what_is_shaken_is_eq_17() -> None:
    effect = library()["cable_end_forcing"]
    now = known(np.random.default_rng(4))
    first = now | {"mid_span": now["v1"], "overtone_share": 0.0}
    still = first | {"overtone_share": 1.0, "mid_span": 0.0}
    assert call(effect.pull, first) == 0.0
    assert call(effect.pull, still) > 0.0
    both = np.add(call(effect.across, first), call(effect.across, still))
    assert both == pytest.approx(call(effect.across, still | {"mid_span": now["v1"]}))
