"""Steps of a fit are as fine as noise asks: a strong ring takes more of them."""

from dataclasses import replace

import numpy as np
import pytest
from recorded_by import STILL, by_model

from analysis.diagnosis.fineness import FINER, MISSES, finer_steps
from analysis.diagnosis.machine import RecordedMachine
from analysis.diagnosis.recording import Recording
from analysis.diagnosis.sight import seen_by
from analysis.engine.system import Point
from analysis.engine.whiten import sigmas_of
from cdpr8.rigfile import Excitation
from model.simulator import run


@pytest.fixture(scope="module")
def let_go(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    # The motion ends at once, at the top of its swing: the platform rings on.
    excitation = Excitation(
        amplitude_deg=2.0, frequency_hz=1.5, motion_s=4.1667, ramp_s=0.0, rest_s=2.0, **STILL
    )
    return by_model(tmp_path_factory.mktemp("runs") / "let go", [], excitation)


def with_noise(recorded: Recording, times: float) -> Recording:
    """The same run, of which cells and camera are so much noisier."""
    bundles = tuple(replace(one, covariance=times**2 * one.covariance) for one in recorded.bundles)
    return replace(recorded, bundles=bundles)


def of(recorded: Recording) -> dict[str, float]:
    machine = RecordedMachine([recorded], ("stiffness",), workers=1)
    job = machine.job(Point(np.zeros(len(machine.nuisances))), 0)
    return finer_steps(recorded, job.task, job.sight)


def test_the_stronger_a_ring_the_finer_the_steps(let_go: Recording) -> None:
    assert of(with_noise(let_go, 100.0)) == {"dop853": 1.0, "dp5": 1.0}
    factors = [of(with_noise(let_go, times))["dop853"] for times in (100.0, 1.0, 0.1, 1e-6)]
    assert factors == sorted(factors)
    assert factors[1] > 1.0
    assert factors[-1] == FINER[-1]


def test_what_they_miss_is_far_below_the_noise(let_go: Recording) -> None:
    machine = RecordedMachine([let_go], ("stiffness",), workers=1)
    job = machine.job(Point(np.zeros(len(machine.nuisances))), 0)
    rate_hz = let_go.output_hz(job.task)
    exact = seen_by(let_go, run(job.task, step_s=5e-4, output_rate_hz=rate_hz), job.sight)

    def missed(name: str, step_s: float) -> float:
        seen = seen_by(let_go, run(job.task, name, step_s, rate_hz), job.sight)
        return max(
            float(np.sqrt(np.mean(((one - other) / sigmas_of(bundle)) ** 2)))
            for bundle, one, other in zip(let_go.bundles, seen, exact, strict=True)
        )

    factors = finer_steps(let_go, job.task, job.sight)
    assert missed(*job.task.thrifty(rate_hz, factors)) < 1.2 * MISSES
    assert missed(*job.task.thrifty(rate_hz)) > 2.0 * MISSES
