"""The bristle by which friction sticks, against LuGre's own law."""

import numpy as np

from model.library.bristle import bent, held


def test_friction_that_slips_is_what_a_bristle_without_delay_holds() -> None:
    """LuGre's own law, by short steps, against the one whose bristles turn over slowly."""
    presliding_m, step_s = 5e-6, 1e-6
    time_s = np.arange(0.0, 0.25, step_s)
    slip = 0.08 * np.sin(2.0 * np.pi * 8.0 * time_s)
    level = 1.0 + 0.8 * np.exp(-((slip / 0.02) ** 2))
    exact, ours = 0.0, 0.0
    missed, late = [], []
    for v, g in zip(slip, level, strict=True):
        late.append(ours - exact)
        missed.append(held(ours, v, presliding_m, g) - exact)
        exact += step_s * (v - abs(v) * exact / g) / presliding_m
        ours += step_s * bent(ours, v, presliding_m, g)
    rms = [float(np.sqrt(np.mean(np.square(one)))) for one in (missed, late)]
    assert rms[0] < 0.012
    assert rms[0] < rms[1]
