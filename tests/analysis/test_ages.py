"""How old values are when an amplifier that runs on its own is asked for them."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from analysis.diagnosis.ages import SINGLY, ages
from analysis.diagnosis.channels import tension_of
from analysis.engine.bundle import Bundle
from cdpr8.runfolder import Run
from cdpr8.runfolder.records import Node
from rig.simulated.plant import PlatformTrajectory

MakeRun = Callable[..., Run]


def test_requests_in_step_with_the_output_leave_one_age_for_a_whole_run() -> None:
    asked_s = np.arange(0.0, 12.0, 0.04)
    found = ages(asked_s, 1.0 / 300.0)
    assert found.singly < 0.1
    assert found.together > 0.9
    assert found.throughout == pytest.approx(0.8, abs=0.25)


def test_requests_at_uneven_times_have_ages_of_their_own() -> None:
    random = np.random.default_rng(2)
    asked_s = np.cumsum(0.0078 + random.normal(0.0, 0.00028, 1500))
    assert ages(asked_s, 1.0 / 1200.0) == SINGLY


def test_even_requests_out_of_step_run_through_all_ages() -> None:
    asked_s = np.arange(0.0, 12.0, 0.00787)
    assert ages(asked_s, 1.0 / 1200.0) == SINGLY


def test_what_wanders_is_shared_for_a_while_and_not_throughout() -> None:
    random = np.random.default_rng(4)
    asked_s = np.arange(0.0, 30.0, 0.025) + np.cumsum(random.normal(0.0, 4e-5, 1200))
    found = ages(asked_s, 1.0 / 600.0)
    assert 0.05 < found.singly < 0.95
    assert found.throughout < 0.5 * found.together


def test_of_few_requests_nothing_is_told() -> None:
    assert ages(np.array([0.0, 1.5, 3.2]), 1.0 / 600.0) == SINGLY


def test_what_comes_unasked_has_no_age(make_run: MakeRun, frictionless: PlatformTrajectory) -> None:
    recorded = make_run(frictionless)
    node = Node(cable=1, address=1, output_period_s=0.004, sampling_sigma_s=1e-3)

    def bundle(sweep: str) -> Bundle:
        start = recorded.start.model_copy(update={"sweep": sweep, "nodes": (node,)})
        run = replace(recorded, start=start)
        return tension_of(run, 1, start.excitation, 0.0, []).bundle

    asked, unasked = bundle("polled"), bundle("streaming")
    assert (asked.late is None, asked.jitter is None) == (False, True)
    assert (unasked.late is None, unasked.jitter is None) == (True, False)
