"""A simulated device on a UART: responses, faults and statistics, without a port."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from types import SimpleNamespace

import pytest
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen import codec
from icdgen.errors import UserError
from icdgen.protocol import facts
from icdgen.sim.computer import Computer
from icdgen.sim.faults import Faults, InjectedFault, parse
from icdgen.sim.line import UartLine
from icdgen.sim.settings import SimulationSettings
from icdgen.sim.storage import DeviceStorage
from icdgen.sim.values import allowed_values
from tests.conformance.icds import icd_of

ICD = icd_of()
FACTS = facts.of(ICD, ICD.node("cubeacp"))
RESET = next(m for m in FACTS.telecommands.values() if m.expects_reset)
ATTITUDE = FACTS.telemetry[146]
SET = 17  # a telecommand of six bytes with an acknowledge


def line(*faults: str | InjectedFault, node: str = "cubeacp", **settings) -> UartLine:
    own = SimulationSettings(**settings)
    computer = Computer(ICD, ICD.node(node), own, DeviceStorage())
    chosen = [parse(each) if isinstance(each, str) else each for each in faults]
    return UartLine(computer, Faults(Random(1), chosen))


def give(device: UartLine, now: int, message: bytes) -> None:
    device.received(now, uart_encode(device.link, message))


def sent(device: UartLine, now: int) -> list[bytes]:
    """Return the messages that are due."""
    return [e.message for e in UartDecoder(device.link).feed(device.take(now))]


def test_a_request_is_answered_with_the_id_and_the_frame():
    device = line()
    program = device.computer.program
    program.values.update(ATTITUDE, {"Estimated Roll Angle": 1234})
    give(device, 5, bytes([146]))
    assert sent(device, 5) == [bytes([146]) + program.values.frame(ATTITUDE)]
    assert program.counts == {"requests": 1}
    assert sent(device, 5) == []


def test_a_request_with_data_and_one_of_an_unknown_id_have_no_answer():
    device = line()
    ids = FACTS.telemetry_ids
    unknown = next(id for id in range(ids.last, 0, -1) if id not in FACTS.telemetry)
    assert ids.first <= unknown <= ids.last
    for message in (bytes([146, 0]), bytes([unknown])):
        give(device, 0, message)
        assert sent(device, 0) == []
    assert device.computer.program.counts == {}


def test_ids_of_the_range_of_telemetry_are_requests_and_others_telecommands():
    reason = FACTS.reasons["unknown_id"]
    first, last = FACTS.telemetry_ids.first, FACTS.telemetry_ids.last
    for id in (first - 1, first, first + 1, last - 1, last, (last + 1) % 256):
        device = line()
        give(device, 0, bytes([id]))
        is_request = first <= id <= last
        counts = device.computer.program.counts
        assert counts.get("telecommands", 0) == (not is_request), id
        if not is_request and id not in FACTS.telecommands:
            assert sent(device, 0) == [bytes([id, reason])]


def test_an_acknowledge_follows_after_the_time_of_processing():
    device = line(processing_ms=30)
    give(device, 100, bytes([SET]) + bytes(6))
    assert device.deadline == 130
    assert sent(device, 129) == []
    assert sent(device, 130) == [bytes([SET, 0])]


def test_a_telecommand_during_the_processing_of_another_is_lost():
    device = line(processing_ms=30)
    for now in (100, 129, 130):
        give(device, now, bytes([SET]) + bytes(6))
    assert sent(device, 200) == [bytes([SET, 0])] * 2
    assert device.computer.program.counts == {"telecommands": 2, "overrun": 1}


@pytest.mark.parametrize(
    ("fault", "answers", "code"),
    [
        ("nak=1", [bytes([SET, FACTS.reasons["value"]])], FACTS.reasons["value"]),
        ("nak=1:3", [bytes([SET, 3])], 3),
        ("silence=1", [], 0),
        ("foreign=1", [bytes([SET ^ 1, 0])], 0),
        ("drop=1@telecommand", [], None),
        ("drop=1@acknowledge", [], 0),
        ("duplicate=1@telecommand", [bytes([SET, 0])] * 2, 0),
        ("duplicate=1@acknowledge", [bytes([SET, 0])] * 2, 0),
        ("drop=1@upload", [bytes([SET, 0])], 0),
        ("drop=1@request,reply", [bytes([SET, 0])], 0),
    ],
)
def test_faults_change_the_response_to_a_telecommand(fault, answers, code):
    device = line(fault)
    give(device, 0, bytes([SET]) + bytes(6))
    assert sent(device, 0) == answers
    expected = (0, 0) if code is None else (SET, code)
    assert device.computer.program.last[:2] == expected


@pytest.mark.parametrize(
    ("fault", "count", "requests"),
    [
        ("drop=1@request", 0, 0),
        ("drop=1@reply", 0, 1),
        ("duplicate=1@request", 2, 2),
        ("duplicate=1@reply", 2, 1),
        ("drop=1@telecommand,acknowledge,packet,log", 1, 1),
    ],
)
def test_faults_of_requests_and_replies_are_separate(fault, count, requests):
    device = line(fault)
    give(device, 0, bytes([146]))
    assert len(sent(device, 0)) == count
    assert device.computer.program.counts.get("requests", 0) == requests


def test_packets_of_an_upload_have_the_faults_of_uploads():
    packet = next(
        id
        for id, message in facts.of(ICD, ICD.node("bootloader")).telecommands.items()
        if line(node="bootloader").computer.program.counterpart.is_packet(message)
    )
    for fault, count in (("upload", 0), ("telecommand", 1)):
        device = line(f"drop=1@{fault}", node="bootloader")
        give(device, 0, bytes([packet, 0, 0]) + bytes(20))
        assert device.computer.program.counts.get("telecommands", 0) == count


def test_a_message_without_bytes_is_ignored():
    device = line("cut=1@telecommand")
    give(device, 0, bytes([1]))
    assert (sent(device, 0), device.computer.program.counts) == ([], {})


def test_a_reset_is_not_acknowledged_and_starts_the_boot_program():
    device = line(boot_ms=500)
    node = ICD.node(RESET.node)
    data = codec.encode(node, RESET, allowed_values(ICD, RESET))
    give(device, 10, bytes([RESET.telecommand_id]) + data)
    assert sent(device, 10) == []
    assert device.computer.program.node.name == "bootloader"
    assert device.deadline == 510
    device.received(509, b"")
    assert device.computer.program.node.name == "bootloader"
    device.received(510, b"")
    assert device.computer.program.node.name == "cubeacp"


def test_errors_of_the_framing_are_counted_by_their_kind():
    escape, start = FACTS.framing.escape, FACTS.framing.start
    begin = bytes([escape, start])
    longest = FACTS.longest_telecommand
    broken = {
        begin + b"\x11" + begin + b"\x92" + bytes([escape, FACTS.framing.end]): {
            "uart_incomplete": 1,
            "requests": 1,
        },
        begin + bytes([17, escape, 2]): {"uart_protocol": 1},
        begin + bytes(longest): {},
        begin + bytes(longest + 1): {"overrun": 1},
    }
    for data, counts in broken.items():
        device = line()
        device.received(0, data)
        assert device.computer.program.counts == counts, data.hex()


def test_a_log_is_sent_with_its_period_and_on_demand():
    device = line()
    section = ICD.protocol_of(ICD.node("cubeacp"))["unsolicited_log"]["configured_by"]
    message = next(
        m for m in FACTS.telecommands.values() if m.name == section["message"]
    )
    mask = bytearray(FACTS.mask.size)
    raw = allowed_values(ICD, message) | {
        section["fields"]["mask"]: bytes([128, *mask[1:]]),
        section["fields"]["period"]: 2,
    }
    period = 2 * section["period_unit_ms"]
    data = codec.encode(ICD.node("cubeacp"), message, raw)
    device.log(0)
    (first,) = sent(device, 0)
    give(device, 7, bytes([message.telecommand_id]) + data)
    assert sent(device, 7) == [bytes([message.telecommand_id, 0])]
    assert device.deadline == 7 + period
    device.tick(6 + period)
    assert sent(device, 6 + period) == []
    device.tick(7 + period)
    (log,) = sent(device, 7 + period)
    assert (log[0], first[0]) == (device.link.log_message.id,) * 2
    assert len(log) > len(first)
    assert device.deadline == 7 + 2 * period


def test_bytes_that_are_due_are_one_piece():
    device = line()
    for _ in range(2):
        give(device, 0, bytes([146]))
    (piece,) = device.pieces(0)
    assert [e.message[0] for e in UartDecoder(device.link).feed(piece)] == [146, 146]
    assert device.pieces(0) == [b""]


def test_a_device_without_acknowledges_and_outcomes_cannot_refuse():
    assert line().no_refusal == ""
    computer = line().computer
    for polled, acknowledged, is_able in (
        (None, False, False),
        (None, True, True),
        (FACTS.polled, False, True),
    ):
        telecommands = {
            id: replace(each, acknowledge=acknowledged)
            for id, each in FACTS.telecommands.items()
        }
        computer.program.facts = SimpleNamespace(
            polled=polled, telecommands=telecommands, longest_telecommand=20
        )
        device = UartLine(computer, Faults(Random(1), []))
        assert (device.no_refusal == "") is is_able


def test_reasons_of_a_refusal_are_names_or_numbers():
    device = line()
    names = device.reasons
    assert names and all(map(device.is_reason, names))
    assert device.is_reason("3") and not device.is_reason("nonsense")
    with pytest.raises(UserError) as error:
        device.fault("nak=1:nonsense")
    assert error.value.help == f"reasons: {', '.join(names)}"
    with pytest.raises(UserError, match="no response of a busy device; only a framed"):
        device.fault("busy=1")
