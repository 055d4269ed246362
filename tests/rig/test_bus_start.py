"""The bus at its start: every node identified and set, and what does not fit refused by name."""

import pytest
from rig_stand_ins import HeldUp, simulated_line, with_bus

from cdpr8.errors import DeviceError, RigFileError
from cdpr8.rigfile import Rig
from rig.bus import Bus


def test_all_nodes_are_identified_set_and_read_back(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    stations = Bus(transport, rig).start()
    assert [station.identity.serial_number for station in stations] == [
        f"SIM{number:04d}" for number in range(1, 9)
    ]
    for node, station in zip(bus.nodes, stations, strict=True):
        for mnemonic, answer in station.state.settings.items():
            if mnemonic not in ("LIC", "TRC"):  # of several numbers
                assert node.settings[mnemonic] == int(answer)
        assert node.measuring
        assert (node.settings["TAS"], node.settings["ZTR"], node.settings["ASF"]) == (1, 0, 0)


def test_a_computer_that_stands_still_now_and_then_does_not_keep_a_bus_from_starting(
    rig: Rig,
) -> None:
    _, inner = simulated_line(rig)
    held = 0

    def held_s(request: bytes) -> float:
        # The first three answers of each amplifier's probe come 60 ms late.
        nonlocal held
        held += request.startswith(b"S0")
        return 0.06 if request.startswith(b"S0") and held % 19 < 3 else 0.0

    stations = Bus(HeldUp(inner, held_s), rig).start()
    assert {station.format.length for station in stations} == {6}
    assert held > 8 * 16


def test_a_missing_amplifier_is_named(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    bus.nodes[2].powered = False
    with pytest.raises(DeviceError, match=r"do not answer: cable 3 \(address 03\)"):
        Bus(transport, rig).start()


def test_an_empty_bus_is_told_with_its_speed(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    for node in bus.nodes:
        node.powered = False
    with pytest.raises(DeviceError, match="no amplifier answers at 115200 baud 8E1"):
        Bus(transport, rig).start()


def test_a_swapped_amplifier_is_refused(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    bus.nodes[4].serial_number = "1234567"
    with pytest.raises(DeviceError, match=r"cable 5.*serial number is '1234567'"):
        Bus(transport, rig).start()


def test_a_filter_the_dialect_lacks_is_refused_by_the_node_not_ignored(rig: Rig) -> None:
    rig = with_bus(rig, filter=10)
    bus, transport = simulated_line(rig)
    for node in bus.nodes:
        node._type_name = "AD104"
    with pytest.raises(DeviceError, match="filter = 10 is none of the AD104"):
        Bus(transport, rig).start()


@pytest.mark.parametrize("cof", [8, 9, 25, 152])
def test_formats_without_bus_mode_are_refused(rig: Rig, cof: int) -> None:
    _, transport = simulated_line(rig)
    with pytest.raises(RigFileError, match=f"output_format = {cof}"):
        Bus(transport, with_bus(rig, output_format=cof))


def test_two_cables_cannot_share_an_address(rig: Rig) -> None:
    cables = (rig.cable[0], *rig.cable[:7])
    _, transport = simulated_line(rig)
    with pytest.raises(RigFileError, match="cables 1 and 2 share amplifier address 1"):
        Bus(transport, rig.model_copy(update={"cable": cables}))
