"""Who answers on a bus, held against the rig file, before anything is set."""

from collections.abc import Mapping

from cdpr8.errors import DeviceError
from cdpr8.rigfile.schema import Amplifier, Rig
from rig.amplifier.dialogue import Dialogue, NoAnswerError
from rig.amplifier.node import NodeClient
from rig.amplifier.profile import Identity
from rig.assignment import amplifiers
from rig.station import check_identity
from rig.transport import Transport


def call_the_roll(dialogue: Dialogue, rig: Rig) -> dict[int, Identity]:
    """Identify the amplifiers of all cables.

    Parameters
    ----------
    dialogue
        Of the bus, silent.
    rig
        Which amplifier is on which cable.

    Returns
    -------
    dict
        Cable -> identity.

    Raises
    ------
    DeviceError
        One is silent, garbled, or another than the rig file's.
    """
    expected, transport = amplifiers(rig), dialogue.transport
    found: dict[int, Identity] = {}
    silent = []
    garbled: dict[int, bytes] = {}
    for cable, amplifier in expected.items():
        try:
            identity = NodeClient(dialogue, amplifier.address).identify()
        except NoAnswerError as fault:
            if fault.came:
                garbled[cable] = fault.came
                continue
            silent.append(cable)
            if len(silent) > 2 and not found:
                break
            continue
        check_identity(rig, cable, amplifier, identity, transport.name)
        found[cable] = identity
    if garbled:
        raise _garbled(garbled, silent, expected, transport)
    if silent:
        raise _silent(silent, found, expected, transport)
    return found


def _garbled(
    came: Mapping[int, bytes],
    silent: list[int],
    expected: Mapping[int, Amplifier],
    transport: Transport,
) -> DeviceError:
    cable = min(came)
    what = f"cable {cable}: amplifier {expected[cable].address:02d} answers garbled"
    if len(came) > 1:
        what += f", and {len(came) - 1} more do"
    if silent:
        addresses = (f"{expected[each].address:02d}" for each in silent)
        what += f", and nobody has address {', '.join(addresses)}"
    return DeviceError(
        f"{what} ({came[cable][:16]!r})",
        allowed="one amplifier at each address",
        where=transport.name,
        remedy="two may share the address: `rig set-address` gives one of them another by its "
        "serial number; else check wiring, baud and parity",
    )


def _silent(
    cables: list[int],
    found: Mapping[int, Identity],
    expected: Mapping[int, Amplifier],
    transport: Transport,
) -> DeviceError:
    where = transport.name
    if not found:
        return DeviceError(
            f"no amplifier answers at {transport.line}",
            where=where,
            remedy="check power and wiring, and baud and parity under [bus] in the rig file",
        )
    missing = ", ".join(
        f"cable {cable} (address {expected[cable].address:02d})" for cable in cables
    )
    return DeviceError(
        f"{len(cables)} of {len(expected)} amplifiers do not answer: {missing}",
        where=where,
        remedy="check their power, wiring and addresses; `rig scan` lists who answers",
    )
