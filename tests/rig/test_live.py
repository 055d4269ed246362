"""The live table: rates just now against what is expected, and no old tension shown as new."""

import io

import pytest
from rich.console import Console
from rig_stand_ins import simulated_line, with_bus

from cdpr8.rigfile import Rig
from rig.broadcast import open_bus
from rig.expected_rate import expected_rates
from rig.live import RecentRates, live_table
from rig.tally import Tally


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({}, 131.0),
        ({"baud": 38400}, 43.6),
        ({"sweep": "broadcast"}, 107.2),
        ({"sweep": "broadcast", "baud": 38400}, 38.0),
    ],
)
def test_the_expected_rate_is_that_of_the_protocol_notes_table(
    rig: Rig, keys: dict[str, object], expected: float
) -> None:
    rig = with_bus(rig, **keys)
    _, transport = simulated_line(rig)
    stations = open_bus(transport, rig).start()
    rates = expected_rates(stations, rig, transport.line)
    assert rates == pytest.approx(dict.fromkeys(range(1, 9), expected), rel=0.01)


def test_a_stream_is_expected_at_its_output_rate(rig: Rig) -> None:
    _, transport = simulated_line(rig)
    stations = open_bus(transport, rig).start()
    rates = expected_rates(stations, with_bus(rig, streaming=True), transport.line)
    assert rates == pytest.approx(dict.fromkeys(range(1, 9), 1200.0))


def test_the_rate_shown_is_that_of_the_last_seconds() -> None:
    rates = RecentRates()
    assert rates.at(0.0, {1: 0, 2: 0}) == {}
    for tenths in range(5, 105, 5):
        # The second falls silent at 5 s.
        now_s = tenths / 10
        found = rates.at(now_s, {1: round(100 * now_s), 2: round(100 * min(now_s, 5.0))})
    assert found == pytest.approx({1: 100.0, 2: 0.0})


def test_a_silent_cable_is_called_so_and_its_last_tension_is_not_shown(rig: Rig) -> None:
    tally = Tally(tension_n={1: 12.345, 2: 23.456}, expected_per_s=dict.fromkeys(range(1, 9), 131))
    tally.lose("no_answer", 3)
    table = live_table(rig, 10.0, tally, {1: 127.8, 2: 0.0}, 4.0, None)
    out = io.StringIO()
    Console(file=out, width=140).print(table)
    lines = out.getvalue().splitlines()
    first, second = (next(line for line in lines if f"{cable} front" in line) for cable in (1, 2))
    assert [each in first for each in ("127.8", "131", "12.345", "50", "#####....")] == [True] * 5
    assert "silent" in second
    assert "23.456" not in second
    assert "lost: requests without answer 3" in out.getvalue()
