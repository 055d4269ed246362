"""Conversations byte for byte, against the protocol note's worked exchanges (section 10)."""

import pytest
from rig_stand_ins import (
    Conversation,
    HeldUp,
    simulated_line,
    virtual_clock,
    with_bus,
    without_noise,
)

from cdpr8.clock import VirtualClock
from cdpr8.errors import DeviceError
from cdpr8.rigfile import Rig
from rig.amplifier.dialogue import LATE_S, Dialogue, NoAnswerError
from rig.amplifier.maintenance import change_baud, readdress
from rig.amplifier.node import NodeClient, Settings, State
from rig.amplifier.probe import probe_format
from rig.amplifier.profile import AD101B, AD104, FIT, Identity, profile_of
from rig.bus import Bus
from rig.scan import scan
from rig.simulated.bus import SimulatedBus
from rig.simulated.node import SimulatedNode
from rig.simulated.rig import simulated_nodes
from rig.transport import LineSettings, MemoryTransport

OK = b"0\r\n"
SET_UP = [
    (b";S01;IDN?;", b'HBM,"AD104          ","1234567",P20\r\n'),
    # What it does to its digits, before any password; as a FIT answers.
    (b"LDW?;", b"0000000\r\n"),
    (b"LWT?;", b"1000000\r\n"),
    (b"LIC?;", b"0000000, 1000000, 0000000, 0000000\r\n"),
    (b"ZSE?;", b"00\r\n"),
    (b"TRC?;", b"0,0, 0000000,00,00\r\n"),
    (b"NOV?;", b"0000000\r\n"),
    (b"TAS?;", b"0\r\n"),
    (b"ZTR?;", b"0\r\n"),
    (b"TAV?;", b"0001234\r\n"),
    (b"CWT?;", b"1000000, 1000000\r\n"),
    (b"RSN?;", b"?\r\n"),
    (b"FMD0;", OK),
    (b"FMD?;", b"0\r\n"),
    (b"ASF1;", OK),
    (b"ASF?;", b"01\r\n"),
    (b"ICR0;", OK),
    (b"ICR?;", b"0\r\n"),
    (b"TAS1;", OK),
    (b"TAS?;", b"1\r\n"),
    (b"ZTR0;", OK),
    (b"ZTR?;", b"0\r\n"),
    (b"TEX172;", OK),
    (b"TEX?;", b"172\r\n"),
    (b"CSM0;", OK),
    (b"CSM?;", b"0\r\n"),
    (b"COF24;", OK),
    (b"COF?;", b"024\r\n"),
]
SETTINGS = Settings(cof=24, icr=0, asf=1)


def set_up(pairs: list[tuple[bytes, bytes]]) -> tuple[Conversation, State]:
    script = Conversation(pairs)
    node = NodeClient(Dialogue(script), 1)
    node.identify()
    return script, node.configure(SETTINGS)


FMD = SET_UP.index((b"FMD0;", OK))


def test_a_node_is_set_up_as_the_note_says() -> None:
    script, state = set_up(SET_UP)
    assert script.over
    assert state.settings["COF"] == "024"
    assert state.settings["ASF"] == "01"
    assert state.settings["LWT"] == "1000000"
    assert state.found["TAV"] == "0001234"


def test_a_user_scaling_is_taken_out_with_the_password() -> None:
    pairs = list(SET_UP)
    pairs[FMD:FMD] = [
        (b"NOV0;", b"?\r\n"),
        (b'SPW"AED";', OK),
        (b"NOV0;", OK),
        (b"NOV?;", b"0000000\r\n"),
    ]
    pairs[pairs.index((b"NOV?;", b"0000000\r\n"))] = (b"NOV?;", b"0050000\r\n")
    script, state = set_up(pairs)
    assert script.over
    assert (state.settings["NOV"], state.found["NOV"]) == ("0000000", "0050000")


def test_a_refused_setting_is_told() -> None:
    refused = (b"ASF1;", b"?\r\n")
    pairs = [*SET_UP[: FMD + 2], refused, (b'SPW"AED";', OK), refused]
    with pytest.raises(DeviceError, match=r"ASF1; was answered with \?"):
        set_up(pairs)


def test_a_setting_that_reads_back_wrong_is_refused() -> None:
    pairs = [*SET_UP[: FMD + 3], (b"ASF?;", b"05\r\n")]
    with pytest.raises(DeviceError, match="ASF reads 05 after 1 was accepted"):
        set_up(pairs)


def test_after_silence_the_line_is_cleared_and_the_question_asked_again() -> None:
    script = Conversation(
        [
            (b"IDN?;", b""),
            (b";", b'"AD104'),  # a late answer: thrown away with the line
            # This could be a late one too: not believed before a longer silence.
            (b"IDN?;", b'HBM,"AD104          ","1234567",P20\r\n'),
            (b"IDN?;", b'HBM,"AD104          ","1234567",P20\r\n'),
        ]
    )
    answer = Dialogue(script).ask(b"IDN?;")
    assert Identity.parse(answer).serial_number == "1234567"
    assert script.over
    assert script.clock.monotonic_s() > LATE_S


@pytest.mark.parametrize("held_s", [0.1, 0.13, 0.2, 0.3])
@pytest.mark.parametrize("held", [b"IDN?;", b"TEX?;", b"FMD0;", b"FMD?;"])
def test_a_late_answer_is_not_taken_for_that_to_the_next_question(
    rig: Rig, held: bytes, held_s: float
) -> None:
    bus, inner = simulated_line(rig)
    late = [held_s]
    transport = HeldUp(
        inner, lambda request: late.pop() if late and request.endswith(held) else 0.0
    )
    dialogue = Dialogue(transport)
    dialogue.tell(b";S98;STP;")
    for address in (7, 8):
        node = NodeClient(dialogue, address)
        assert node.identify().serial_number == f"SIM{address:04d}"
        found = node.configure(Settings(cof=24, icr=0, asf=1, csm=1)).settings
        assert found == found | {"TEX": "172", "CSM": "1", "FMD": "0", "ASF": "01", "COF": "024"}
        for mnemonic, answer in found.items():
            if mnemonic not in ("COF", "LIC", "TRC"):
                assert bus.nodes[address - 1].settings[mnemonic] == int(answer)
    assert late == []


def test_a_scan_tells_what_each_cell_gives_and_leaves_the_format_as_it_was(rig: Rig) -> None:
    bus, transport = simulated_line(without_noise(rig))
    Bus(transport, rig).start()
    bus.nodes[1].settings["NOV"] = 5000
    found = list(scan(transport, range(1, 9)))
    assert [node.settings["COF"] for node in bus.nodes] == [24] * 8
    assert found[1].signal_mv_per_v is None
    for each in (found[0], *found[2:]):
        assert each.signal_mv_per_v == pytest.approx((5.0 + 2.0 * each.address) / 50.0, abs=1e-5)


def test_an_amplifier_that_falls_silent_in_a_scan_is_listed_with_its_trouble(rig: Rig) -> None:
    bus, inner = simulated_line(rig)

    def fall_silent(request: bytes) -> float:
        if request == b"ASF?;":
            bus.nodes[1].powered = False
        return 0.0

    found = {each.address: each for each in scan(HeldUp(inner, fall_silent), range(2, 4))}
    assert found[2].identity is not None
    assert "ASF?; was not answered" in found[2].trouble
    assert found[2].settings == {"BDR": "115200,1", "COF": "009", "ICR": "0"}
    assert found[3].trouble == ""


def test_what_cannot_be_the_answer_is_no_answer() -> None:
    # "172" for an acknowledgement, twice: told as it came, and never as a refusal.
    pairs = [(b"CSM1;", b"172\r\n"), (b";", b"")] * 2 + [(b"CSM1;", b"172\r\n")]
    with pytest.raises(NoAnswerError, match=r"CSM1; was not answered \(only b'172"):
        NodeClient(Dialogue(Conversation(pairs)), 8).write("CSM", 1)


@pytest.mark.parametrize("times", [1, 100])
def test_a_scan_gives_no_address_anothers_late_answer(rig: Rig, times: int) -> None:
    _, inner = simulated_line(rig)
    late = [0.2] * times
    transport = HeldUp(
        inner, lambda request: late.pop() if late and request.startswith(b";S03") else 0.0
    )
    found = {each.address: each.identity for each in scan(transport, range(1, 9))}
    if times > 1:
        assert found.pop(3, None) is None  # given up
    for address, identity in found.items():
        assert identity is not None
        assert identity.serial_number == f"SIM{address:04d}"
    assert len(found) == (8 if times == 1 else 7)


def test_a_node_that_stays_silent_is_asked_three_times() -> None:
    script = Conversation([(b"IDN?;", b""), (b";", b"")] * 2 + [(b"IDN?;", b"")])
    with pytest.raises(NoAnswerError, match=r"IDN\?; was not answered"):
        Dialogue(script).ask(b"IDN?;")
    assert script.over


def test_one_that_has_answered_is_asked_more_often_before_a_run() -> None:
    # A computer that stands still again and again is not an amplifier that is gone.
    silence = [(b"COF?;", b""), (b";", b"")] * 6
    # After silence an answer is not believed before the question was put again.
    script = Conversation([*silence, *[(b"COF?;", b"009\r\n")] * 2])
    dialogue = Dialogue(script)
    with dialogue.patiently():
        assert dialogue.ask(b"COF?;") == b"009\r\n"
    assert script.over


@pytest.mark.parametrize(
    ("answer", "type_", "profile"),
    [
        (b'HBM,"AD104          ","1234567",P20\r\n', "AD104", AD104),
        (b'HBM,"AD103          ","1234567",P51\r\n', "AD103", AD101B),
        (b"HBM,FIT/5,0012345,P10\r\n", "FIT/5", FIT),
        (b"HBM,C16iC3/40t     ,M64702 ,P52\r\n", "C16iC3/40t", FIT),
    ],
)
def test_identities_are_read_leniently(answer: bytes, type_: str, profile: object) -> None:
    identity = Identity.parse(answer)
    assert identity.type == type_
    assert profile_of(identity) is profile


def test_nothing_is_assumed_of_an_unknown_type() -> None:
    with pytest.raises(DeviceError, match="number 1234567 is a 'WE2107', of which no dialect"):
        profile_of(Identity.parse(b'HBM,"WE2107         ","1234567",P61\r\n'))
    with pytest.raises(DeviceError, match="allowed: four parts"):
        Identity.parse(b"H\x00\xff\r\n")


@pytest.mark.parametrize("crlf", [True, False])
def test_whether_values_carry_crlf_is_probed(rig: Rig, crlf: bool) -> None:
    clock = virtual_clock()
    bus, transport = simulated_line(rig, clock=clock)
    for node in bus.nodes:
        node._crlf_in_bus_mode = crlf
    station = Bus(transport, rig).start()[0]
    assert station.format.crlf is crlf
    assert station.format.length == (6 if crlf else 4)


def test_values_that_fit_no_format_are_refused() -> None:
    script = Conversation([(b";", b""), *[(b"S01;", b"\x27\x10\x00")] * 16, (b";", b"")] * 3)
    with pytest.raises(DeviceError, match="fit 0 formats of COF 24: 27 10 00"):
        probe_format(Dialogue(script), 1, 24, 0)


def test_a_probe_whose_first_answers_stay_away_goes_on_asking() -> None:
    # Values of no length are not asked for: a serial port that gives none seems to be gone.
    silence = [(b";", b""), *[(b"S01;", b"")] * 3]
    values = [*[(b"S01;", b"\x00\x27\x10\x00\r\n")] * 16, (b";", b"")]
    script = Conversation(silence + values)
    assert probe_format(Dialogue(script), 1, 24, 0).crlf
    assert script.over


def test_a_probe_asks_again_for_values_that_a_busy_computer_was_late_for() -> None:
    value = (b"S01;", b"\x00\x27\x10\x00\r\n")
    late = [(b"S01;", b""), (b"S01;", b"\x00\x27")]
    script = Conversation(
        [(b";", b""), value, *late, *[value] * 7, *late, *[value] * 8, (b";", b"")]
    )
    assert probe_format(Dialogue(script), 1, 24, 0).crlf
    assert script.over


class Told:
    """A simulated node and a line to it, for one-off questions."""

    def __init__(self, nodes: tuple[SimulatedNode, ...], transport: MemoryTransport) -> None:
        self.nodes, self.transport = nodes, transport

    def __call__(self, text: bytes) -> bytes:
        self.transport.write(text)
        return self.transport.drain(0.05)


@pytest.fixture
def tell(rig: Rig) -> Told:
    bus, transport = simulated_line(without_noise(rig))
    tell = Told(bus.nodes, transport)
    tell(b";S98;STP;")
    return tell


def test_the_simulated_node_holds_its_side_of_the_worked_exchange(tell: Told) -> None:
    tell.nodes[0].signal._tension_at = lambda t_s: 50.0 + 0.0 * t_s  # 1 mV/V
    for address in range(2, 9):
        tell(b";S%02d;COF24;" % address)
    assert tell(b";S01;IDN?;") == b'HBM,"FIT/5          ","SIM0001",P20\r\n'
    assert tell(b"COF?;") == b"009\r\n"
    assert tell(b"NOV5000;") == b"?\r\n"  # locked before the password
    assert tell(b'SPW"AED";') == OK
    for setting in (b"NOV0;", b"FMD0;", b"ASF0;", b"ICR0;", b"TAS1;", b"ZTR0;", b"TEX172;"):
        assert tell(setting) == OK
    assert tell(b"COF?;") == b"009\r\n"
    assert tell(b"CSM0;COF24;") == OK + OK
    assert tell(b"ICR9;") == b"?\r\n"
    assert tell(b";S98;MSV?0;") == b""
    assert tell(b"S01;") == bytes.fromhex("27 10 00 08 0D 0A")
    assert tell(b"S09;") == b""
    assert tell(b";S98;STP;") == b""
    assert tell(b"S01;") == b""


def test_a_virgin_node_is_readdressed_by_its_serial_number(tell: Told) -> None:
    assert tell(b';S98;ADR20,"SIM0003";') == b""
    assert tell(b";S20;IDN?;").endswith(b'"SIM0003",P20\r\n')
    assert tell(b";S03;IDN?;") == b""
    assert tell(b";S04;ADR?;") == b"04\r\n"


def test_nodes_are_active_after_power_on_and_answer_all_at_once(rig: Rig) -> None:
    _, transport = simulated_line(rig)
    transport.write(b"ADR?;")
    received = transport.read(4, 0.1)
    assert received.damaged
    transport.write(b";S98;STP;ADR?;")
    assert transport.drain(0.1) == b""


def test_settings_are_volatile_until_saved(tell: Told) -> None:
    assert tell(b";S02;ASF3;ASF?;") == OK + b"03\r\n"
    tell(b"RES;")
    tell.transport.clock.sleep_until(10.0)
    assert tell(b";S02;ASF?;") == b"05\r\n"
    assert tell(b"ASF3;TDD1;") == OK + OK
    tell(b"RES;")
    tell.transport.clock.sleep_until(20.0)
    assert tell(b";S02;ASF?;") == b"03\r\n"
    assert tell(b"TDD0;ASF?;") == OK + b"05\r\n"


def test_a_node_at_another_speed_is_not_heard(tell: Told) -> None:
    assert tell(b";S05;BDR?;") == b"115200,1\r\n"
    assert tell(b"BDR38400,1;") == b""  # answered at the new speed
    assert tell(b";S05;IDN?;") == b""


def test_commands_end_with_lf_but_a_selection_does_not(tell: Told) -> None:
    assert tell(b";S06;ICR?\n") == b"0\r\n"
    assert tell(b"S07\n") == b""
    assert tell(b";ADR?;") == b"07\r\n"  # only the semicolon completed it


def test_text_formats_and_counted_streams(tell: Told) -> None:
    tell.nodes[0].signal._tension_at = lambda t_s: 25.0 + 0.0 * t_s
    assert tell(b";S01;ASF0;MSV?;") == OK + b" 0250000,01,008\r\n"
    assert tell(b"COF3;MSV?2;") == OK + b" 0250000\r\n" * 2
    assert tell(b"COF8;MSV?;") == OK + bytes.fromhex("13 88 00 08 0D 0A")
    assert tell(b"ESR?;") == b"000\r\n"
    assert tell(b"XYZ1;ESR?;") == b"?\r\n032\r\n"


def test_the_checksum_replaces_the_status_where_there_is_no_parity(rig: Rig) -> None:
    plain = with_bus(rig, parity="none")
    _, transport = simulated_line(plain)
    station = Bus(transport, plain).start()[0]
    assert station.state.settings["CSM"] == "1"
    assert simulated_nodes(rig, None, 0.0, 0)[0].settings["PARITY"] == 1


def test_readdressing_is_verified_and_saved(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    transport.write(b";S98;STP;")
    dialogue = Dialogue(transport)
    assert readdress(dialogue, "SIM0003", 20).serial_number == "SIM0003"
    bus.nodes[2].power_on(0.0)
    assert bus.nodes[2].settings["ADR"] == 20
    with pytest.raises(DeviceError):  # the address is taken: two answer at once
        readdress(dialogue, "SIM0004", 20)
    assert bus.nodes[3]._eeprom["ADR"] == 4


def test_readdressing_is_sent_as_the_note_says() -> None:
    script = Conversation(
        [
            (b';S98;ADR03,"1234567";', b""),
            (b";S03;IDN?;", b'HBM,"AD104          ","1234567",P20\r\n'),
            (b"TDD1;", OK),
        ]
    )
    readdress(Dialogue(script), "1234567", 3)
    assert script.over


def at_speed(bus: SimulatedBus, baud: int) -> MemoryTransport:
    bus.line = LineSettings(baud, "even")
    return MemoryTransport(bus, bus.line, virtual_clock_of(bus))


def virtual_clock_of(bus: SimulatedBus) -> VirtualClock:
    clock = virtual_clock()
    clock.advance(100.0 + bus.line.baud)
    return clock


def test_a_bus_changes_its_speed_together_and_saves_it_last(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    transport.write(b";S98;STP;")
    addresses = tuple(range(1, 9))
    change_baud(Dialogue(transport), addresses, 38400, 1, lambda: at_speed(bus, 38400))
    for node in bus.nodes:
        node.power_on(0.0)
        assert (node.settings["BAUD"], node.settings["PARITY"]) == (38400, 1)


def test_a_power_cycle_undoes_a_change_of_speed_that_one_node_missed(rig: Rig) -> None:
    bus, transport = simulated_line(rig)
    transport.write(b";S98;STP;")
    bus.nodes[4].powered = False
    with pytest.raises(DeviceError):
        change_baud(Dialogue(transport), tuple(range(1, 9)), 38400, 1, lambda: at_speed(bus, 38400))
    for node in bus.nodes:
        node.power_on(0.0)
        assert node.settings["BAUD"] == 115200
