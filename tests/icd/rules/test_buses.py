"""Links on buses: responses, reasons of refusals, message types and packets."""

from __future__ import annotations

import pytest

import icdgen.icd.rules.buses  # noqa: F401
from tests.icd.files import findings
from tests.icd.rules.rows import messages, rows
from tests.limits import assert_limits

UART = "uart: {line: {baud_rate: 9600}}"
I2C = "i2c: {write: {address_7bit: 0x57}, read: {address_7bit: 0x57}}"
PARTS = (
    ("Type", "type", 5),
    ("Channel", "channel", 8),
    ("From", "source", 8),
    ("To", "destination", 8),
)
CAN = (
    "can: {identifier: ["
    + ", ".join("{{name: {}, role: {}, bits: {}}}".format(*part) for part in PARTS)
    + "]}"
)
PING = "messages:\n  - {name: Ping, id: 1, kind: telecommand, length: 0}\n"


def link(*buses: str, **keys: str | list[str]) -> str:
    """Return a link; the packets, commands and other keys are in lines of their own."""
    text = f"protocol:\n  link:\n    buses: {{{', '.join(buses)}}}\n"
    for key, value in keys.items():
        if isinstance(value, str):
            text += f"    {key}: {{{value}}}\n"
        else:
            text += f"    {key}:\n" + "".join(f"      {line}\n" for line in value)
    return text


def acknowledge(fields: str = "{bits: 8, role: id}, {bits: 8, role: status}") -> str:
    return f"acknowledge: {{from: device, buses: [uart], header: [{fields}]}}"


ACK = "packet: acknowledge, echo: id, status: status, success: [0]"
OUTCOME = (
    PING
    + """\
  - name: Outcome
    id: 129
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Id, type: uint}
      - {at: 8, bits: 1, name: Done, type: bool}
      - {at: 16, bits: 8, name: Result, type: uint}
"""
)


@pytest.mark.parametrize(
    ("ack", "missing", "help"),
    [
        (ACK, "", ""),
        ("packet: acknowledge, echo: id, status: status", "`success`", "it"),
        ("packet: acknowledge, success: [0]", "`echo` and `status`", "them"),
        ("packet: acknowledge", "`echo`, `status` and `success`", "them"),
    ],
)
def test_all_keys_that_an_acknowledge_lacks_are_named(tmp_path, ack, missing, help):
    text = link(UART, packets=acknowledge(), commands=f"ack: {{{ack}}}") + PING
    reported = [f for f in findings(tmp_path, text) if f.code == "ICD105"]
    assert [f.message for f in reported] == (
        [f"`ack` on `uart` has no {missing}"] if missing else []
    )
    for finding in reported:
        assert finding.help.startswith(f"add {help}, or write the response")


@pytest.mark.parametrize(
    ("ack", "missing"),
    [
        ("Outcome", "`echo`, `until`, `status` and `success`"),
        ("{message: Outcome, echo: Id, status: Result, success: [0]}", "`until`"),
        ("{message: Outcome, echo: Id, until: Done, status: Result, success: [0]}", ""),
    ],
)
def test_all_keys_that_telemetry_needs_as_a_response_are_named(tmp_path, ack, missing):
    text = link(I2C, commands=f"ack: {ack}") + OUTCOME
    expected = [f"`ack` on `i2c` has no {missing}"] if missing else []
    assert messages(tmp_path, text, "ICD105") == expected


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ("{bits: 8, role: id}, {bits: 8, role: status}", []),
        ("{bits: 8, role: status}, {bits: 8, role: id}", []),
        (
            "{bits: 8, role: id}, {bits: 7, role: status}",
            ["`status` is not one byte, which an acknowledge on the UART has for it"],
        ),
        (
            "{bits: 4, role: constant}, {bits: 8, role: id}, {bits: 8, role: status}",
            [
                "`id` is not one byte, which an acknowledge on the UART has for it",
                "`status` is not one byte, which an acknowledge on the UART has for it",
            ],
        ),
        (
            "{bits: 8, role: flags, name: id}, {bits: 8, role: flags, name: status}",
            [
                "`id` has the role `flags`, not `id`",
                "`status` has the role `flags`, not `status`",
            ],
        ),
    ],
)
def test_id_and_status_of_an_acknowledge_are_bytes(tmp_path, fields, expected):
    text = link(UART, packets=acknowledge(fields), commands=f"ack: {{{ACK}}}") + PING
    reported = messages(tmp_path, text, "ICD105")
    assert [text for text in reported if "not" in text] == expected


def test_an_acknowledge_repeats_nothing_but_the_id(tmp_path):
    ack = ACK.replace("echo: id", "echo: {id: id}")
    text = link(UART, packets=acknowledge(), commands=f"ack: {{{ack}}}") + PING
    assert messages(tmp_path, text, "ICD105") == [
        "an acknowledge on the UART repeats the id only"
    ]


ENUM = "enums:\n  - {name: Code, members: [{value: 0, name: Fine}, {value: 1, name: Length}, {value: 2, name: Value}]}\n"


def reasons(text: str, success: str = "[0, 7]", enum: str = ", enum: Code") -> str:
    fields = f"{{bits: 8, role: id}}, {{bits: 8, role: status{enum}}}"
    ack = ACK.replace("[0]", success)
    commands = f"ack: {{{ack}}}, reasons: {{{text}}}"
    return link(UART, packets=acknowledge(fields), commands=commands) + ENUM + PING


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("length: 1, value: 2, checksum: 3", []),
        ("length: Length, value: Value", []),
        ("length: Length, value: 1", ["1 stands for both `length` and `value`"]),
        ("length: 7", ["7 stands for both `success` and `length`"]),
        ("length: Fine", ["0 stands for both `success` and `length`"]),
        (
            "length: 3, value: 3, checksum: 3",
            [
                "3 stands for both `length` and `value`",
                "3 stands for both `length` and `checksum`",
            ],
        ),
        ("length: Lenght", ["no refusal has the reason `Lenght`"]),
        ("length: 1, assumptions: {length: Usual.}", []),
        ("length: 256, value: 2", ["256 does not fit 8 bits of `status`"]),
    ],
)
def test_each_reason_has_a_code_of_its_own_that_fits_the_status(
    tmp_path, text, expected
):
    assert messages(tmp_path, reasons(text), "ICD105") == expected


def test_reasons_fit_the_bits_of_the_status(tmp_path):
    def is_accepted(number: int) -> bool:
        text = reasons(f"length: {number}", enum="")
        return messages(tmp_path, text, "ICD105") == []

    assert_limits(is_accepted, most=255)


def test_each_type_of_a_message_on_can_belongs_to_the_first(tmp_path):
    packets = [
        "a: {from: host, type: 0}",
        "b: {from: device, type: 1}",
        "c: {from: device, type: 0}",
        "d: {from: device, type: 2}",
        "e: {from: device, type: 0}",
        "f: {from: device, type: 1}",
    ]
    assert rows(tmp_path, link(CAN, packets=packets), "ICD104") == [
        "9:31 the type 0 already belongs to `a` (line 7)",
        "11:31 the type 0 already belongs to `a` (line 7)",
        "12:31 the type 1 already belongs to `b` (line 8)",
    ]


@pytest.mark.parametrize(
    ("segment", "expected"),
    [
        ("from: host, type: 3, segment_of: order", ""),
        (
            "from: device, type: 3, segment_of: order",
            "`order` is not sent by the same side",
        ),
        ("from: device, type: 3, segment_of: frame", ""),
        (
            "from: host, type: 3, segment_of: ordre",
            "there is no packet `ordre` on `can`",
        ),
        ("from: host, type: 3, segment_of: wire", "there is no packet `wire` on `can`"),
    ],
)
def test_a_part_of_a_message_is_sent_by_the_same_side_on_can(
    tmp_path, segment, expected
):
    packets = [
        "order: {from: host, type: 1}",
        "frame: {from: device, type: 2}",
        "wire: {from: device, buses: [uart], header: [{bits: 8, role: id}]}",
        f"part: {{{segment}}}",
    ]
    text = link(CAN, UART, packets=packets)
    assert messages(tmp_path, text, "ICD095") == ([expected] if expected else [])


def test_keys_of_the_link_are_reported_once_for_the_first_bus_without_effect(tmp_path):
    """A response that a bus declares itself replaces that of the link there."""
    about = "source: {page: 3}, assumptions: {echo: Usual.}"
    commands = [
        "source: {page: 3}",
        "assumptions: {ack: Usual.}",
        f"ack: {{{ACK}, message: Outcome, busy: [1], {about}}}",
        "busy: Outcome",
        "reasons: {busy: 3, length: 2}",
    ]
    text = link(UART, I2C, packets=acknowledge(), commands=commands) + OUTCOME
    assert rows(tmp_path, text, "ICD117") == [
        "10:74 `message` has no effect on `uart`",
        "10:92 `busy` has no effect on `uart`",
        "11:7 `busy` has no effect on `uart`",
        "12:17 `busy` has no effect on `uart`",
    ]
    own = UART.replace("9600}", f"9600}}, commands: {{ack: {{{ACK}}}}}")
    text = link(own, I2C, packets=acknowledge(), commands=commands[2:3]) + OUTCOME
    assert rows(tmp_path, text, "ICD117") == []


@pytest.mark.parametrize(
    "key", ["buses: [uart]", "optional: true", "type: 3", "segment_of: a"]
)
def test_keys_of_packets_on_buses_have_no_effect_on_framed_links(tmp_path, key):
    field = "bits: 8, role: checksum, checksum: sum, covers: {from: data, to: data}"
    field += ", optional: true" if key.startswith("optional") else ""
    packet = "" if key.startswith("optional") else f", {key}"
    text = f"""\
protocol:
  link:
    framing: {{by: slip}}
    packets:
      a: {{from: device, header: [{{bits: 8, role: id}}], trailer: [{{{field}}}]}}
      b: {{from: host{packet}, header: [{{bits: 8, role: id}}]}}
    checksums: {{sum: {{kind: sum, width: 8}}}}
"""
    name = key.partition(":")[0]
    place = "7:139" if name == "optional" else "8:23"
    assert rows(tmp_path, text, "ICD175") == [
        f"{place} `{name}` has no effect on framed links"
    ]


CRC = "crc: {{kind: crc, width: {}, polynomial: 7, init: 0, reflect_in: false, reflect_out: false, xor_out: 0}}"
FIELD = "{{bits: {}, role: checksum, checksum: crc, covers: {{from: {}, to: {}}}}}"


def checked(*fields: str, width: int = 8) -> str:
    packets = [
        f"p{n}: {{from: {'host' if n % 2 else 'device'}, trailer: [{field}]}}"
        for n, field in enumerate(fields)
    ]
    return link(UART, packets=packets, checksums=CRC.format(width))


@pytest.mark.parametrize(
    ("first", "last", "is_right"),
    [
        ("data", "data", True),
        ("id", "data", True),
        ("data", "id", False),
        ("id", "id", False),
        ("length", "data", False),
    ],
)
def test_a_checksum_on_buses_covers_the_data_or_id_and_data(
    tmp_path, first, last, is_right
):
    text = checked(FIELD.format(8, first, last))
    wrong = "on buses, a checksum covers the data, or id and data"
    assert messages(tmp_path, text, "ICD175") == [wrong] * (not is_right)


def test_a_checksum_on_buses_has_whole_bytes(tmp_path):
    for bits, is_right in ((7, False), (8, True), (9, False), (16, True)):
        text = checked(FIELD.format(bits, "id", "data"), width=bits)
        wrong = "on buses, a checksum has whole bytes"
        assert messages(tmp_path, text, "ICD175") == [wrong] * (not is_right)


def test_checksums_of_packets_are_compared_with_the_first(tmp_path):
    """Only the first key that differs is reported."""
    same, other = FIELD.format(8, "data", "data"), FIELD.format(16, "id", "data")
    assert rows(tmp_path, checked(same, same), "ICD175") == []
    text = "`{}` is not that of the other packets, and a node has one checksum"
    assert messages(tmp_path, checked(same, other), "ICD175") == [text.format("bits")]
    covers = FIELD.format(8, "id", "data")
    assert messages(tmp_path, checked(same, covers), "ICD175") == [
        text.format("covers")
    ]
    assert messages(tmp_path, checked(other, same), "ICD175") == [text.format("bits")]


TELEMETRY = "messages:\n" + "".join(
    f"  - {{name: {name}, id: {id}, kind: telemetry, length: 0}}\n"
    for name, id in (("Ping", 130), ("Pong", 131))
)
BYTE = "{{bits: 8, role: constant, value: {}}}"
ONE_BYTE = "a message that is sent unasked has one constant byte in place of the id"
ONE_MESSAGE = "the constant in place of the id stands for one message"


@pytest.mark.parametrize(
    ("header", "listed", "expected"),
    [
        (BYTE.format(7), ", messages: [Ping]", []),
        (BYTE.format(130), ", messages: [Ping]", []),
        (
            BYTE.format(131),
            ", messages: [Ping]",
            ["131 is the id of `Pong`, so a receiver could not tell them apart"],
        ),
        (BYTE.format(7), ", messages: [Pin]", ["the node has no telemetry `Pin`"]),
        (BYTE.format(7), ", messages: [Ping, Pong]", [ONE_MESSAGE]),
        (BYTE.format(7), "", [ONE_MESSAGE]),
        (f"{BYTE.format(7)}, {BYTE.format(8)}", ", messages: [Ping]", [ONE_BYTE]),
        (BYTE.format(7).replace("8", "16"), ", messages: [Ping]", [ONE_BYTE]),
        (BYTE.format(7).replace("constant", "sync"), ", messages: [Ping]", [ONE_BYTE]),
    ],
)
def test_a_constant_byte_stands_for_one_message(tmp_path, header, listed, expected):
    packet = f"unasked: {{from: device, buses: [uart], header: [{header}]{listed}}}"
    text = link(UART, packets=packet) + TELEMETRY
    assert messages(tmp_path, text, "ICD175") == expected


def test_no_two_packets_begin_with_the_same_constant(tmp_path):
    packet = "{}: {{from: device, buses: [uart], header: [{}], messages: [{}]}}"
    packets = [
        packet.format("a", BYTE.format(7), "Ping"),
        packet.format("b", BYTE.format(8), "Pong"),
        packet.format("c", BYTE.format(7), "Pong"),
        packet.format("d", BYTE.format(7), "Ping"),
    ]
    assert rows(tmp_path, link(UART, packets=packets) + TELEMETRY, "ICD175") == [
        "9:48 the packet `a` begins with 7, too",
        "10:48 the packet `a` begins with 7, too",
    ]


def test_a_second_packet_of_messages_is_reported_once(tmp_path):
    """For the first bus that has both."""
    trailer = f"trailer: [{FIELD.format(8, 'data', 'data')}]"
    packets = [
        f"a: {{from: host, buses: [i2c], {trailer}}}",
        f"b: {{from: both, {trailer}}}",
        f"c: {{from: device, buses: [i2c], {trailer}}}",
        f"d: {{from: device, buses: [uart], {trailer}}}",
    ]
    text = link(UART, I2C, packets=packets, checksums=CRC.format(8))
    assert rows(tmp_path, text, "ICD175") == [
        "8:17 telecommand on `i2c` is in the packet `a` already",
        "9:17 telemetry on `i2c` is in the packet `b` already",
        "10:17 telemetry on `uart` is in the packet `b` already",
    ]
