"""One sweep over all effects: what holds for each that is there, and for the next."""

import numpy as np
import pytest

from cdpr8.errors import UsageError
from cdpr8.rigfile import Excitation, Rig
from cdpr8.rigfile.schema import CellPlace
from model import Machine, Simulation, Task, observe, simulate, simulate_many
from model.effects import ActiveEffect, Effect, library
from model.effects.cable_sag import pull as sag_pull
from model.library.discovery import kernel_effects
from model.library.effect import Acts
from model.simulator import run
from tests.model.harness import STEPS, STIFFNESS, cable_response, platform_response

ALL = list(library().values())
KERNEL = list(kernel_effects())
CABLE = [effect for effect in KERNEL if effect.acts is not Acts.PLATFORM]
SHORT = Excitation(rest_s=0.1, motion_s=0.8, ramp_s=0.1)

DESIGN = """
pulley_coulomb pulley_capstan pulley_stribeck pulley_presliding cable_viscous cable_relaxation
cable_hysteresis cable_stiffening cable_slack cable_creep cable_modes cable_end_forcing cable_sag
cable_structural anchor_play pulley_geometry pulley_inertia frame_compliance platform_damping
air_drag umbilical stiffness pretension mass inertia centre_of_mass geometry drive_amplitude
drive_frequency drive_phase drive_harmonic drive_backlash cell_gain cell_zero cell_drift cell_lag
cell_saturation cell_swapped camera_latency camera_exposure camera_axis camera_gain
camera_rolling_shutter clock_drift frames_dropped
"""


def by_name(effect: Effect) -> str:
    return effect.name


def nothing(effect: Effect) -> ActiveEffect:
    return ActiveEffect(effect.name, dict.fromkeys(effect.magnitudes, 0.0))


def states(simulation: Simulation) -> np.ndarray:
    return np.hstack([simulation.pose, simulation.tension_n, simulation.cable_offset_m])


def test_every_effect_of_the_design_is_there() -> None:
    assert set(library()) == set(DESIGN.split())


@pytest.mark.parametrize("effect", ALL, ids=by_name)
def test_an_effect_says_what_it_is(effect: Effect) -> None:
    assert effect.equation
    assert effect.source
    assert effect.signature
    assert effect.magnitudes
    for parameter in effect.parameters:
        assert parameter.low <= parameter.default <= parameter.high
        assert parameter.low <= 0.0 <= parameter.high or not parameter.magnitude
        assert parameter.unit
    assert (effect.longest_step_s is None) == (not effect.cost)
    assert effect.acts.in_kernel or not effect.states


@pytest.mark.parametrize("effect", ALL, ids=by_name)
def test_zero_is_no_effect_bit_for_bit(rig: Rig, effect: Effect) -> None:
    zero = nothing(effect)
    assert zero.is_nothing
    bare = Task(rig, SHORT, effects=())
    # Past the rule that drops what is nothing: the law itself must add exactly nothing.
    task = Task(rig, SHORT, effects=())
    object.__setattr__(task, "acting", (zero,))
    if effect.acts in (Acts.CELL, Acts.CAMERA, Acts.CLOCK):
        before = run(bare)
        look = observe(before, ())
        law = effect.measure
        if effect.acts is Acts.CELL:
            seen = law(before.t_s, before.tension_n, **zero.columns())
            assert np.array_equal(seen, look.tension_n)
        else:
            poses = law(lambda stamp_s: before.pose.copy(), **zero.numbers())(before.t_s)
            assert poses == pytest.approx(look.pose, rel=1e-14, abs=1e-16)
        return
    assert np.array_equal(states(run(bare, step_s=2e-3)), states(run(task, step_s=2e-3)))


@pytest.mark.parametrize("effect", ALL, ids=by_name)
def test_implausible_values_are_refused_with_the_range(effect: Effect) -> None:
    for parameter in effect.parameters:
        for wrong in (parameter.low - 1.0, parameter.high + 1.0):
            with pytest.raises(UsageError) as caught:
                ActiveEffect(effect.name, {parameter.name: wrong})
            unit = "" if parameter.unit == "1" else f" {parameter.unit}"
            allowed = f"allowed: {parameter.low:g} to {parameter.high:g}{unit}"
            assert allowed in str(caught.value).splitlines()[1]


def test_scalar_and_lane_kernel_agree_on_every_effect(rig: Rig) -> None:
    plant = [effect for effect in ALL if effect.acts.side in ("plant", "parameter", "drive")]
    tasks = [Task(rig, SHORT, effects=[ActiveEffect(effect.name)]) for effect in plant]
    together = simulate_many(tasks)
    for effect, task, lane in zip(plant, tasks, together, strict=True):
        alone = run(task)
        for ours, theirs in (
            (lane.pose, alone.pose),
            (lane.tension_n, alone.tension_n),
            (lane.cable_offset_m, alone.cable_offset_m),
        ):
            difference = np.abs(ours - theirs).max()
            assert difference <= 1e-10 * max(1.0, np.abs(theirs).max()), effect.name


@pytest.mark.parametrize(
    "effect", [one for one in ALL if one.acts.side in ("plant", "parameter", "drive")], ids=by_name
)
def test_every_effect_is_felt(rig: Rig, effect: Effect) -> None:
    without = run(Task(rig, SHORT, effects=()))
    one = run(Task(rig, SHORT, effects=[ActiveEffect(effect.name)], nominal=rig))
    assert np.abs(states(one) - states(without)).max() > 1e-9
    assert one.outcome.status != "blow_up"


@pytest.mark.parametrize("effect", CABLE, ids=by_name)
def test_a_cable_never_gives_more_than_it_takes(effect: Effect) -> None:
    if effect.pull is None:
        pytest.skip("acts across the cable")
    answer = cable_response(effect, cycles=8 if effect.name == "frame_compliance" else 3)
    scale = np.abs(answer.force - answer.mean).max() * np.abs(answer.rate).max() / 2.0
    assert answer.work >= -0.02 * scale


@pytest.mark.parametrize("name", ["platform_damping", "air_drag", "umbilical"])
def test_a_platform_effect_takes_energy(name: str) -> None:
    for answer in platform_response(library()[name]):
        assert answer.work < 0.0


# The signatures of notes/left-out-physics.md, Section 2.


def test_coulomb_is_a_step_at_reversal_whatever_amplitude_and_frequency() -> None:
    effect = library()["pulley_coulomb"]
    sharp = {"presliding_m": 2e-5}
    for amplitude_m, frequency_hz in ((5e-3, 2.0), (1e-3, 2.0), (5e-3, 6.0)):
        answer = cable_response(effect, sharp, amplitude_m, frequency_hz)
        assert answer.quadrature[1] == pytest.approx(4 * 0.3 / np.pi, rel=0.02)
        assert answer.share(3) == pytest.approx(1 / 3, abs=0.015)
        assert answer.share(2) < 1e-9
        # A reversal takes it some lengths of bristle, and so it is late by sqrt(2 ln 2 x_s / A).
        late = np.sqrt(2.0 * np.log(2.0) * 2e-5 / amplitude_m)
        assert answer.in_phase[1] == pytest.approx(late * answer.quadrature[1], rel=0.2)


def test_capstan_friction_has_the_second_harmonic_and_scales_with_pretension() -> None:
    effect = library()["pulley_capstan"]
    loaded = cable_response(effect, {"presliding_m": 2e-5})
    theta = 0.03 * 1.5708
    assert loaded.size[2] == pytest.approx(0.85 * theta * 1410 * 5e-3, rel=0.03)
    more = cable_response(effect, {"presliding_m": 2e-5}, pretension=22.0)
    assert more.quadrature[1] == pytest.approx(2 * loaded.quadrature[1], rel=0.02)


@pytest.mark.parametrize("growth", [1.0, 0.5, 0.0])
def test_capstan_friction_helps_a_cable_that_is_let_out_less_than_it_holds_one_back(
    growth: float,
) -> None:
    """Euler and Eytelwein's exp(a) - 1 has a mean over a cycle, of a^2/2 T; mu theta T has none."""
    effect, grip = library()["pulley_capstan"], 0.1 * 1.5708
    numbers = {"presliding_m": 2e-5, "friction": 0.1, "growth_share": growth}
    answer = cable_response(effect, numbers, pretension=200.0)
    assert answer.force.mean() == pytest.approx(growth * grip**2 / 2.0 * 200.0, rel=0.05, abs=0.1)
    assert answer.quadrature[1] == pytest.approx(4.0 / np.pi * grip * 200.0, rel=0.02)


def test_stribeck_friction_spikes_at_reversal() -> None:
    effect = library()["pulley_stribeck"]
    answer = cable_response(effect)
    assert answer.quadrature[1] > 0
    fast = np.abs(answer.force[np.argmax(np.abs(answer.rate))])
    assert np.abs(answer.force).max() > 1.1 * fast
    assert answer.share(2) < 1e-9


def test_presliding_is_stiffness_below_and_friction_above() -> None:
    effect = library()["pulley_presliding"]
    small = cable_response(effect, amplitude_m=1e-5)
    assert small.in_phase[1] == pytest.approx(0.3 / 6e-4 * 1e-5, rel=0.05)
    assert abs(small.quadrature[1]) < 0.1 * small.in_phase[1]
    large = cable_response(effect, amplitude_m=1e-2)
    assert large.quadrature[1] == pytest.approx(4 * 0.3 / np.pi, rel=0.07)
    # With most of the give before the pulley, little of the friction reaches the platform.
    far = cable_response(effect, {"far_share": 0.2})
    seen = cable_response(effect, {"far_share": 0.2}, hook="behind")
    assert far.size[1] == pytest.approx(0.2 * seen.size[1], rel=1e-6)


def test_stiffening_is_a_third_harmonic_in_phase() -> None:
    # The limit, a cube alone.
    answer = cable_response(library()["cable_stiffening"], {"hardening": 0.0})
    assert answer.share(3) == pytest.approx(1 / 3)
    assert abs(answer.quadrature[1]) < 1e-9
    assert answer.work == pytest.approx(0.0, abs=1e-12)


def test_stiffening_may_follow_the_tension() -> None:
    pull = library()["cable_stiffening"].pull
    assert pull is not None
    stiffness, rest_n, share = 3000.0, 20.0, 0.5
    rise = share * stiffness / rest_n
    elongation_m = np.linspace(-0.02, 0.02, 21)
    # dT/dx = k (1 + b (T - T_0) / T_0), T(0) = T_0.
    exact_n = rest_n / share * np.expm1(rise * elongation_m) - stiffness * elongation_m
    found_n = pull(stiffness * rise**2 / 6.0, 1.0 / share, share, elongation_m, stiffness, rest_n)
    assert found_n == pytest.approx(exact_n, rel=1e-4, abs=1e-9)


def test_stiffening_that_hardly_hardens_is_a_square_beside_a_cube() -> None:
    pull = library()["cable_stiffening"].pull
    assert pull is not None
    stiffness, rest_n, cubic = 3000.0, 20.0, 2e5
    elongation_m = np.linspace(-0.02, 0.02, 21)
    cube_n = cubic * elongation_m**3
    square_n = cubic * 3.0 * 1.5 * rest_n / stiffness * elongation_m**2
    found_n = pull(cubic, 1.5, 0.03, elongation_m, stiffness, rest_n)
    assert np.abs(found_n - cube_n - square_n).max() < 1e-3 * np.abs(square_n).max()


def test_a_hook_that_nothing_holds_goes_through_its_gap_at_no_cost() -> None:
    gap = {"play_m": 1e-3, "held_share": 0.0, "middle_share": -0.3}
    answer = cable_response(library()["anchor_play"], gap)
    phase = 2.0 * np.pi * np.arange(STEPS) / STEPS
    slid_m = np.clip(5e-3 * np.sin(phase), -1.3e-3, 0.7e-3)
    assert answer.force == pytest.approx(-STIFFNESS * slid_m, abs=1e-6)
    assert answer.work == pytest.approx(0.0, abs=1e-9)


def test_slack_and_sag_are_even_and_in_phase() -> None:
    for name, values in (("cable_slack", {"slack_m": 5e-3}), ("cable_sag", {})):
        answer = cable_response(library()[name], values)
        assert answer.size[2] > 0.1 * answer.size[1], name
        assert abs(answer.quadrature[1]) < 1e-6, name


def test_sag_goes_with_the_square_of_the_weight() -> None:
    effect = library()["cable_sag"]
    light, heavy = (cable_response(effect, {"weight_share": one}) for one in (0.1, 0.2))
    assert heavy.size[1] == pytest.approx(4.0 * light.size[1], rel=1e-2)


@pytest.mark.parametrize("elastic_n", [-5.0, 0.0, 1.0, 3.0, 8.0, 30.0])
def test_sag_is_the_parabola_however_low_the_pull(elastic_n: float) -> None:
    at_rest_n, stiffness, length, weight_n = 17.0, 3000.0, 3.0, 0.2
    added = sag_pull(1.0, elastic_n, at_rest_n, stiffness, length, weight_n / length, 1.0, 0.0)
    tension = elastic_n + added
    shorter = weight_n**2 * length / 24.0 * (tension**-2.0 - at_rest_n**-2.0)
    assert tension > 0.0
    assert tension == pytest.approx(elastic_n + stiffness * shorter, abs=1e-6)


def test_a_cable_that_weighs_nothing_does_not_push() -> None:
    assert sag_pull(0.0, -5.0, 17.0, 3000.0, 3.0, 0.1, 1.0, 0.0) == pytest.approx(5.0)
    assert sag_pull(0.0, 5.0, 17.0, 3000.0, 3.0, 0.1, 1.0, 0.0) == pytest.approx(0.0)


def test_creep_drifts_one_way() -> None:
    effect = library()["cable_creep"]
    early = cable_response(effect, cycles=2, frequency_hz=1.0)
    late = cable_response(effect, cycles=8, frequency_hz=1.0)
    assert 0 > early.mean > late.mean


def test_play_needs_an_amplitude() -> None:
    effect = library()["anchor_play"]
    assert cable_response(effect, amplitude_m=1e-4).size[1] < 1e-3
    answer = cable_response(effect, amplitude_m=1e-3)
    assert answer.quadrature[1] > 0.1
    assert answer.share(2) < 1e-3 < answer.share(3)


def test_pulley_geometry_is_even_without_a_loop() -> None:
    answer = cable_response(library()["pulley_geometry"], {"left_at_rest": 1.0})
    assert answer.share(2) > 1e-3
    assert abs(answer.quadrature[1]) < 1e-9


def over_a_wheel(anchor: np.ndarray, base: np.ndarray, radius_m: float) -> float:
    """Length of a cable that comes up through `base`, goes over a wheel, and leaves it tangent."""
    centre = np.array([np.hypot(*(base - anchor)[:2]) - radius_m, base[2] - anchor[2]])
    turns = np.linspace(0.0, np.pi, 2_000_001)
    radial = np.stack([np.cos(turns), np.sin(turns)])
    line = centre[:, None] + radius_m * radial
    (left,) = np.flatnonzero(np.diff(np.sign((line * radial).sum(axis=0))))
    return float(np.hypot(*line[:, left]) + radius_m * turns[left])


def test_pulley_geometry_is_that_of_a_wheel(rig: Rig) -> None:
    radius_m = 0.03
    effect = library()["pulley_geometry"]
    machine = Machine.from_rig(rig)
    assert effect.change is not None
    moved = effect.change(machine, np.full(8, radius_m), np.zeros(8))
    for i in range(8):
        anchor, base = machine.anchor[i], machine.base[i]
        way = 0.01 * np.array([0.3, -0.2, 0.9])
        exact = [over_a_wheel(anchor + d, base, radius_m) for d in (0.0 * way, way)]
        ours = [np.linalg.norm(moved.base[i] - anchor - d) for d in (0.0 * way, way)]
        bare = [np.linalg.norm(base - anchor - d) for d in (0.0 * way, way)]
        wrong = (bare[1] - bare[0]) - (exact[1] - exact[0])
        assert abs((ours[1] - ours[0]) - (exact[1] - exact[0])) < 0.1 * abs(wrong)


def test_a_frame_that_gives_way_looks_like_less_stiffness() -> None:
    answer = cable_response(library()["frame_compliance"], cycles=8)
    assert answer.in_phase[1] < 0
    assert abs(answer.quadrature[1]) < 0.3 * abs(answer.in_phase[1])


def test_modes_can_only_tighten_their_cable() -> None:
    answer = cable_response(library()["cable_modes"], cycles=3)
    assert answer.force.min() >= 0
    assert answer.mean > 0


def test_the_moving_anchor_shakes_its_cable_at_the_drives_frequency(rig: Rig) -> None:
    quiet = Excitation(rest_s=0.0, motion_s=1.0, ramp_s=0.2, cable_offset_m=0.0)
    assert not simulate(rig, quiet, effects=()).cable_offset_m.any()
    shaken = simulate(rig, quiet, effects=[ActiveEffect("cable_end_forcing", cables=(1,))])
    assert np.abs(shaken.cable_offset_m[:, 0]).max() > 1e-4
    assert not shaken.cable_offset_m[:, 1:].any()
    offset = shaken.cable_offset_m[:, 0] - shaken.cable_offset_m[:, 0].mean()
    lines = np.abs(np.fft.rfft(offset * np.hanning(len(offset))))
    strongest_hz = np.fft.rfftfreq(len(offset), 1e-3)[lines.argmax()]
    assert abs(strongest_hz - quiet.frequency_hz) < 0.6


def test_damping_is_viscous_drag_quadratic_and_an_umbilical_a_spring() -> None:
    _, viscous = platform_response(library()["platform_damping"])
    assert viscous.share(3) < 1e-9
    drag, _ = platform_response(library()["air_drag"])
    more, _ = platform_response(library()["air_drag"], amplitude=0.04)
    assert more.quadrature[1] == pytest.approx(4 * drag.quadrature[1], rel=0.01)
    assert drag.share(3) == pytest.approx(0.2, abs=0.02)
    spring, _ = platform_response(library()["umbilical"])
    assert spring.in_phase[1] == pytest.approx(-10 * 0.02)


def test_an_umbilical_tied_on_beside_the_centre_turns_the_platform_back() -> None:
    """A spring k at an arm a: a turn by theta pulls with k a theta, and turns with k a^2 theta."""
    wrench = library()["umbilical"].wrench
    assert wrench is not None
    turned, arm, spring = 1e-4, 0.1, 200.0
    at = (arm, 0.0, 0.0)
    found = wrench(spring, 0.0, 0.0, *at, 0.0, 0.0, 0.0, 0.0, turned, 0.0, *([0.0] * 6))
    wanted = [0.0, 0.0, spring * arm * turned, 0.0, -spring * arm**2 * turned, 0.0]
    assert list(found) == pytest.approx(wanted, abs=1e-6)


# What belongs to one side.


def test_friction_at_the_pulley_is_not_seen_by_a_cell_behind_it(rig: Rig) -> None:
    behind = rig.model_copy(
        update={
            "cable": tuple(one.model_copy(update={"cell": CellPlace.WINCH}) for one in rig.cable)
        }
    )
    friction = [ActiveEffect("pulley_coulomb", {"coulomb_n": 1.0}, (1, 2))]
    near, far = (simulate(one, SHORT, effects=friction) for one in (rig, behind))
    assert np.array_equal(near.anchor_tension_n, far.anchor_tension_n)
    assert np.array_equal(near.tension_n, near.anchor_tension_n)
    step = near.tension_n - far.tension_n
    assert np.abs(step[:, :2]).max() == pytest.approx(1.0, abs=0.05)
    assert not step[:, 2:].any()


def test_the_cables_of_a_post_give_way_together(rig: Rig) -> None:
    # Pushed through cable 1 only, the post of cables 1 and 5 takes cable 5 along.
    frame = [ActiveEffect("frame_compliance", {"compliance_m_per_n": 1e-4})]
    machine = Machine.from_rig(rig)
    from model.extras import posts

    carrier, share = posts(machine)
    assert carrier[4] == carrier[0] == 0
    assert share[0] == 0.5
    run_ = simulate(rig, SHORT, effects=frame)
    assert run_.outcome.status == "ok"


def test_parameters_move_the_plant_and_not_the_drive(rig: Rig) -> None:
    heavier = simulate(rig, SHORT, effects=[ActiveEffect("mass", {"mass_share": 0.1})])
    assert heavier.pose[-1, 2] < -1e-5
    softer = ActiveEffect("stiffness", {"stiffness_share": -0.1}, (3,))
    machine = Task(rig, effects=[softer]).machine
    ratio = machine.stiffness / Machine.from_rig(rig).stiffness
    assert ratio == pytest.approx([1, 1, 0.9, 1, 1, 1, 1, 1])
