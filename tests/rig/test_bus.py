"""The bus on a virtual clock: its rate, and the times of its values."""

from dataclasses import replace

import numpy as np
import pytest
from rig_stand_ins import WavePlatform, simulated_line, with_bus, without_noise

from cdpr8.rigfile import Rig
from rig.bus import Bus
from rig.transport import Received

SWEEPS_PER_S = {9600: 10.9, 38400: 43.6, 57600: 65.5, 115200: 131.0}
"""Protocol note, section 9: bus mode, 4 bytes and CRLF, eight nodes, no turnaround."""


def sweeps(rig: Rig, seconds: float) -> float:
    _, transport = simulated_line(rig)
    bus = Bus(transport, rig)
    stations = bus.start()
    start_s, count = transport.clock.monotonic_s(), 0
    while transport.clock.monotonic_s() < start_s + seconds:
        bus.take(stations[count % 8])
        count += 1
    return count / 8 / (transport.clock.monotonic_s() - start_s)


@pytest.mark.parametrize(("baud", "expected"), SWEEPS_PER_S.items())
def test_nine_tenths_of_the_theoretical_sweep_rate(rig: Rig, baud: int, expected: float) -> None:
    assert 0.9 * expected <= sweeps(with_bus(rig, baud=baud), 3.0) <= 1.01 * expected


def test_without_crlf_sweeps_are_faster(rig: Rig) -> None:
    assert 0.9 * 164 <= sweeps(with_bus(rig, output_format=24 + 32), 1.0) <= 1.01 * 164


@pytest.mark.parametrize("output_rate", [0, 3])
def test_sampling_instants_are_right_within_a_third_of_the_output_period(
    rig: Rig, output_rate: int
) -> None:
    # A ramp without noise: the value itself says when it was sampled.
    rig = with_bus(without_noise(rig), output_rate=output_rate)
    slope = 2.0
    _, transport = simulated_line(rig, WavePlatform(slope_n_per_s=slope))
    bus = Bus(transport, rig)
    stations = bus.start()
    period_s = stations[0].period_s
    errors = []
    for count in range(4000):
        station = stations[count % 8]
        value = bus.take(station)
        tension_n = station.scaling.tension_n(value.reading.digits)
        true_s = (tension_n - 5.0 - 2.0 * station.cable) / slope
        # An average over a period belongs to its middle.
        true_s += 0.5 * (period_s - 1 / 1200)
        errors.append(value.sampled_s - true_s)
        assert value.request_s < value.received_s
    assert np.sqrt(np.mean(np.square(errors))) < 0.35 * period_s
    assert abs(np.mean(errors)) < 0.05 * period_s


@pytest.mark.parametrize(
    ("held_s", "output_rate", "timed"),
    [(0.0, 0, True), (0.001, 0, True), (0.003, 0, False), (0.003, 3, True), (0.01, 3, False)],
)
def test_a_value_held_up_for_more_than_its_period_has_no_known_time(
    rig: Rig, held_s: float, output_rate: int, timed: bool
) -> None:
    rig = with_bus(without_noise(rig), output_rate=output_rate)
    _, transport = simulated_line(rig, WavePlatform(slope_n_per_s=2.0))
    bus = Bus(transport, rig)
    stations = bus.start()
    for station in stations:
        assert bus.take(station).timed
    read = transport.read

    def read_late(count: int, deadline_s: float) -> Received:
        received = read(count, deadline_s)
        return replace(received, last_byte_s=received.last_byte_s + held_s)

    transport.read = read_late
    value = bus.take(stations[0])
    assert value.timed is timed
    # Held up on the way back: at most half of what adapters do is taken for the way there.
    station = stations[0]
    true_s = (station.scaling.tension_n(value.reading.digits) - 7.0) / 2.0
    if held_s == 0.001:
        assert value.sampled_s - true_s < station.period_s / 2 + 0.0003


def test_a_thread_that_stood_still_after_a_request_pulls_no_later_value(rig: Rig) -> None:
    rig = without_noise(rig)
    _, transport = simulated_line(rig, WavePlatform(slope_n_per_s=0.5))
    bus = Bus(transport, rig)
    stations = bus.start()
    write = transport.write
    origin_s = transport.clock.monotonic_s()
    for node in transport._far_end.nodes:
        node.signal.begin(origin_s)

    def write_and_stand_still(data: bytes) -> None:
        write(data)
        transport.clock.sleep_until(transport.clock.monotonic_s() + 5e-3)

    transport.write = write_and_stand_still
    bus.take(stations[0])
    transport.write = write
    errors_s = []
    for _ in range(200):
        value = bus.take(stations[0])
        true_s = (stations[0].scaling.tension_n(value.reading.digits) - 7.0) / 0.5
        errors_s.append(value.sampled_s - origin_s - true_s)
    assert abs(np.mean(errors_s[20:])) < 0.1 * stations[0].period_s
