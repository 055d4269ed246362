"""The bristle by which friction sticks, and the smooth laws beside it."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from cdpr8.rigfile import Excitation, load_rig, packaged_rig_path
from model import ActiveEffect, simulate
from model.library.bristle import bent, eased, gives, held
from model.library.discovery import library
from model.library.smooth import gaussian
from tests.model.harness import cable_response

FRICTIONS = ("pulley_coulomb", "pulley_capstan", "pulley_stribeck", "pulley_presliding")


@pytest.mark.parametrize("name", FRICTIONS)
def test_below_its_own_length_friction_is_a_spring_that_loses_little(name: str) -> None:
    effect = library()[name]
    numbers = {one.name: one.default for one in effect.parameters}
    amplitude_m = 0.02 * numbers["presliding_m"]
    stuck = cable_response(effect, {"bristle_loss_s": 1e-5}, amplitude_m)
    assert stuck.in_phase[1] > 20.0 * abs(stuck.quadrature[1])
    # A spring's force goes with the way, whatever the speed.
    fast = cable_response(effect, {"bristle_loss_s": 1e-5}, amplitude_m, 20.0)
    assert fast.in_phase[1] == pytest.approx(stuck.in_phase[1], rel=0.02)


@pytest.mark.parametrize("name", FRICTIONS)
def test_the_loss_of_a_bristle_goes_with_the_speed_while_it_sticks(name: str) -> None:
    effect = library()[name]
    numbers = {one.name: one.default for one in effect.parameters}
    amplitude_m = 0.02 * numbers["presliding_m"]
    calm = cable_response(effect, {"bristle_loss_s": 1e-5}, amplitude_m, 10.0)
    lossy = cable_response(effect, {"bristle_loss_s": 2e-3}, amplitude_m, 10.0)
    more = lossy.quadrature[1] - calm.quadrature[1]
    assert more == pytest.approx(2.0 * np.pi * 10.0 * 2e-3 * calm.in_phase[1], rel=0.05)


def test_stribecks_curve_is_the_static_force_at_first_and_the_sliding_one_at_last() -> None:
    effect = library()["pulley_stribeck"]
    creeping = cable_response(effect, {"presliding_m": 2e-5}, 2e-4, 0.5)
    assert np.abs(creeping.force).max() == pytest.approx(1.4 * 0.3, rel=0.03)
    sliding = cable_response(effect, {"presliding_m": 2e-5}, 5e-3, 8.0)
    fastest = np.argmax(np.abs(sliding.rate))
    assert abs(sliding.force[fastest]) == pytest.approx(0.3, rel=0.02)


def test_stribecks_curve_may_fall_as_hess_and_soom_have_it() -> None:
    effect = library()["pulley_stribeck"]
    values = {"presliding_m": 2e-5, "bristle_loss_s": 0.0, "stribeck_m_per_s": 0.05}
    short, long = (
        cable_response(effect, {**values, "tail_share": share}, 5e-3, 4.0) for share in (0.0, 1.0)
    )
    fastest = np.argmax(np.abs(long.rate))
    times = long.rate[fastest] / 0.05
    assert abs(long.force[fastest]) == pytest.approx(0.3 * (1.0 + 0.4 / (1.0 + times**2)), rel=0.02)
    assert abs(short.force[fastest]) == pytest.approx(
        0.3 * (1.0 + 0.4 * np.exp(-(times**2))), rel=0.02
    )


def test_gaussian_is_what_it_says_and_never_overflows() -> None:
    x = np.linspace(-6.0, 6.0, 2001)
    assert np.abs(gaussian(x) - np.exp(-x * x)).max() < 1e-4
    assert gaussian(1e100) < 1e-100


@pytest.mark.parametrize("name", FRICTIONS)
def test_the_default_steps_follow_a_reversal_far_closer_than_a_cell_sees(name: str) -> None:
    rig = load_rig(packaged_rig_path())
    moved = rig.excitation.model_copy(update={"motion_s": 1.5})
    on = [ActiveEffect(name)]
    usual, close = (
        simulate(rig, excitation=moved, effects=on, output_rate_hz=333.0, step_s=step_s)
        for step_s in (None, 1.5e-4)
    )
    off = usual.tension_n - close.tension_n
    # A cell's noise is some 5 mN.
    assert float(np.sqrt(np.mean(off**2))) < 1e-3


@pytest.mark.parametrize("method", ["dp5", "dop853"])
@pytest.mark.parametrize("name", FRICTIONS)
def test_the_shortest_bristle_of_a_weak_friction_is_followed_however_fast_cables_slip(
    name: str, method: str
) -> None:
    rig = load_rig(packaged_rig_path())
    # Up to 0.3 m/s: it turns over as quickly as it ever does.
    moved = rig.excitation.model_copy(update={"motion_s": 1.5, "amplitude_deg": 5.0})
    effect = library()[name]
    shortest = next(one.low for one in effect.parameters if one.name == "presliding_m")
    (magnitude,) = (one for one in effect.parameters if one.magnitude)
    weak = {magnitude.name: [0.03 * magnitude.default] * 8, "presliding_m": shortest}
    usual, close = (
        simulate(
            rig, excitation=moved, effects=[ActiveEffect(name, weak)],
            output_rate_hz=333.0, method=method, step_s=step_s,
        )
        for step_s in (None, 1.5e-4)
    )  # fmt: skip
    off = usual.tension_n - close.tension_n
    assert float(np.sqrt(np.mean(off**2))) < 1e-3


@pytest.mark.parametrize("name", FRICTIONS)
@pytest.mark.parametrize("bent", [-0.6, 0.8])
def test_what_a_bristle_held_at_rest_is_missing_once_it_has_turned_over(
    name: str, bent: float
) -> None:
    effect = library()[name]
    (presliding_m,) = (one.default for one in effect.parameters if one.name == "presliding_m")
    amplitude_m = 20.0 * presliding_m
    plain = cable_response(effect, {}, amplitude_m)
    left = cable_response(effect, {"bent_at_rest": bent}, amplitude_m)
    slides = 0.5 * (plain.force.max() - plain.force.min())
    # Of Stribeck's law it is a share of the static friction, which is the most that is held.
    assert plain.mean - left.mean == pytest.approx(bent * slides, rel=0.15)
    assert left.force - left.mean == pytest.approx(plain.force - plain.mean, abs=0.02 * slides)


@pytest.mark.parametrize("name", FRICTIONS)
def test_a_bristle_bent_at_rest_holds_nothing_beside_the_pretension(name: str) -> None:
    effect = ActiveEffect(name, {"bent_at_rest": 0.7})
    rig = load_rig(packaged_rig_path())
    still = Excitation(rest_s=0.5, motion_s=0.1, ramp_s=0.05)
    found = simulate(rig, excitation=still, effects=[effect])
    at_rest = found.t_s < 0.4
    drift = found.tension_n[at_rest] - found.tension_n[0]
    assert np.abs(drift).max() < 0.01 * 0.7 * 0.3


@pytest.mark.parametrize(
    ("exponent", "presliding_m", "most"),
    [(1.0, 5e-6, 0.012), (1.5, 5e-5, 0.012), (2.0, 5e-5, 0.03)],
)
def test_friction_that_slips_is_what_a_bristle_without_delay_holds(
    exponent: float, presliding_m: float, most: float
) -> None:
    """LuGre's law and Dahl's, by short steps, against the one whose bristles turn over slowly."""
    step_s = 1e-6
    time_s = np.arange(0.0, 0.25, step_s)
    slip = 0.08 * np.sin(2.0 * np.pi * 8.0 * time_s)
    level = 1.0 + 0.8 * np.exp(-((slip / 0.02) ** 2))
    exact, ours = 0.0, 0.0
    missed, late = [], []
    for v, g in zip(slip.tolist(), level.tolist(), strict=True):
        late.append(ours - exact)
        missed.append(held(ours, v, presliding_m, g, exponent, -1.0) - exact)
        toward = 1.0 - exact / (g if v >= 0.0 else -g)
        exact += step_s * v * np.sign(toward) * abs(toward) ** exponent / presliding_m
        ours += step_s * bent(ours, v, presliding_m, g, exponent, -1.0)
    rms = [float(np.sqrt(np.mean(np.square(one)))) for one in (missed, late)]
    assert rms[0] < most
    assert rms[0] < rms[1]


@pytest.mark.parametrize("exponent", [1.0, 1.25, 1.5, 1.75, 2.0])
def test_a_bristle_eases_as_by_dahls_exponent(exponent: float) -> None:
    toward = np.linspace(0.0, 2.0, 401)
    off = toward * eased(toward, exponent) - toward**exponent
    exact = 2.0 * exponent % 1.0 == 0.0
    assert np.abs(off).max() < (1e-12 if exact else 0.02)


def _slid(law: Callable[[float, float], float]) -> NDArray[np.float64]:
    """A bristle that slides to and fro by short steps, after a turn: z' = law(z, sgn v) |v|."""
    step_s = 2e-6
    time_s = np.arange(0.0, 0.5, step_s)
    z, found = 0.0, np.empty_like(time_s)
    for i, v in enumerate((3e-3 * np.sin(2.0 * np.pi * 4.0 * time_s)).tolist()):
        found[i] = z
        z += step_s * abs(v) * law(z, 1.0 if v >= 0.0 else -1.0)
    return found[time_s > 0.25]


WAY_M = 5e-5


def _ours(elastic: float) -> Callable[[float, float], float]:
    return lambda z, sign: float(gives(sign * (1.0 - z * sign), 1.0, elastic) / WAY_M)


def test_bouc_wens_law_springs_as_it_is_bent_back() -> None:
    """Wen, J. Eng. Mech. Div. 102 (1976) 249, with beta = gamma = 0.5 and n = 1."""
    wen = _slid(lambda z, sign: (sign - 0.5 * abs(z) * sign - 0.5 * z) / WAY_M)
    assert _slid(_ours(0.0)) == pytest.approx(wen, abs=1e-3)


def test_an_elasto_plastic_bristle_is_met_far_closer_than_by_lugres_law() -> None:
    """Dupont et al., IEEE Trans. Autom. Control 47 (2002) 787, elastic below 0.45."""

    def dupont(z: float, sign: float) -> float:
        way = abs(z)
        if z * sign <= 0.0 or way <= 0.45:
            return sign / WAY_M
        yields = 0.5 + 0.5 * np.sin(np.pi * (way - 0.725) / 0.55) if way < 1.0 else 1.0
        return float(sign * (1.0 - yields * way) / WAY_M)

    exact = _slid(dupont)
    lugre, elastic = (np.std(_slid(_ours(share)) - exact) for share in (-1.0, 0.6))
    assert elastic < 0.25 * lugre


@pytest.mark.parametrize("name", FRICTIONS)
def test_a_bristle_that_springs_is_as_stiff_at_rest_as_one_that_does_not(name: str) -> None:
    effect = library()[name]
    numbers = {one.name: one.default for one in effect.parameters}
    amplitude_m = 0.02 * numbers["presliding_m"]
    always, never = (
        cable_response(effect, {"elastic_share": share}, amplitude_m) for share in (0.6, -1.0)
    )
    assert always.in_phase[1] == pytest.approx(never.in_phase[1], rel=0.05)
