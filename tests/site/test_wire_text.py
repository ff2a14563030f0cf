"""Bytes on each bus and fields of packet formats, with their meanings in words."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.html import packet_formats, wire
from icdgen.backends.html.packet_formats import FormatField
from icdgen.backends.html.relations import Relations
from icdgen.icd.packets import declared_packets
from icdgen.loading import load
from icdgen.protocol import facts
from tests.conformance.icds import LINKS
from tests.features.outputs import icd_of
from tests.icd.files import loaded, status
from tests.limits import assert_limits
from tests.site.relay import RELAY


@pytest.fixture(scope="module")
def relay(tmp_path_factory):
    return icd_of(RELAY, tmp_path_factory.mktemp("relay"))


def lines_of(icd, node: str, name: str, data: bytes):
    """Return notes of the buses, and their lines as kind, text and title of each part."""
    (message,) = (each for each in icd.node(node).messages if each.name == name)
    buses = wire.buses(message, Relations(icd).wire(message), data)
    notes = {bus.name: bus.note for bus in buses}
    lines = {
        bus.name: [(line.label, *map(tuple, line.chunks)) for line in bus.lines]
        for bus in buses
    }
    return notes, lines


START = ("frame", "1F 7F", "start of message")
END = ("frame", "1F FF", "end of message")
WRITE = ("frame", "40", "address, write")


def test_each_part_of_a_transmission_has_its_meaning():
    icd = load([LINKS / "battery.yaml"]).icd
    notes, lines = lines_of(icd, "battery", "Set Heater", b"\x1f")
    assert notes == {
        "UART": "115,200 baud. 1F within id and data is sent as 1F 1F.",
        "I²C": "7-bit address 20.",
    }
    id, crc = ("id", "05", "id 5"), ("crc", "00 24", "crc")
    sent = ("data", "1F 1F", "data, 2 bytes")
    uart = [
        ("Telecommand", START, id, sent, END),
        ("with CRC", START, id, sent, lines["UART"][1][4], END),
    ]
    assert lines["UART"] == uart
    assert (uart[1][4][0], uart[1][4][2]) == (crc[0], crc[2])
    data = ("data", "1F", "data, 1 byte")
    assert lines["I²C"] == [
        ("Telecommand", WRITE, id, data),
        ("with CRC", WRITE, id, data, uart[1][4]),
    ]
    _, lines = lines_of(icd, "battery", "Cut Off", b"")
    assert lines["UART"][0] == ("Telecommand", START, ("id", "06", "id 6"), END)
    assert lines["I²C"][0] == ("Telecommand", WRITE, ("id", "06", "id 6"))
    _, lines = lines_of(icd, "battery", "Last Error", b"\0")
    # On I2C, only telecommands have a checksum.
    assert lines["I²C"] == [
        (
            "Request and answer",
            WRITE,
            ("id", "83", "id 131"),
            ("note", "repeated start", ""),
            ("frame", "41", "address, read"),
            ("data", "00", "data, 1 byte"),
        )
    ]


def test_24_bytes_are_shown_and_of_more_the_first_20_and_the_last_4():
    def is_complete(size: int) -> bool:
        text = wire._hex_text(bytes(range(size)))
        if "…" in text:
            first, last = text.split(" … ")
            assert bytes.fromhex(first) == bytes(range(20))
            assert bytes.fromhex(last) == bytes(range(size - 4, size))
        else:
            assert bytes.fromhex(text) == bytes(range(size))
        return "…" not in text

    assert_limits(is_complete, most=24)


@pytest.mark.parametrize(
    ("size", "labels", "note"),
    [
        (0, [""], ""),
        (8, [""], ""),
        (9, [" 1/2", " 2/2"], ""),
        (21, [" 1/3", " 2/3", " 3/3"], ""),
        (22, [" 1/4", " 2/4", None, " 4/4"], "… 1 more packet"),
        (29, [" 1/5", " 2/5", None, " 5/5"], "… 2 more packets"),
    ],
)
def test_of_many_can_packets_the_first_two_and_the_last_are_shown(
    shipped, size, labels, note
):
    name = "Trigger ADCS Loop with Simulated Sensor Data"
    notes, lines = lines_of(shipped, "cubeacp", name, bytes(range(1, size + 1)))
    assert notes["CAN"] == (
        "29-bit identifiers. Your own address stands as 0: put it in its place."
    )
    expected = ["" if each is None else f"Telecommand{each}" for each in labels]
    assert [line[0] for line in lines["CAN"]] == expected
    kind = (
        ("01130001", "TC Request: type 1, channel 19, source 0, destination 1")
        if size <= 8
        else ("07130001", "Extended TC Request: type 7, channel 19, source 0, destination 1")
    )  # fmt: skip
    for line in lines["CAN"]:
        if line[0]:
            assert line[1] == ("id", *kind)
        else:
            assert line[1:] == (("note", note, ""),)
    if size > 8:
        count = -(-size // 7)
        last = bytes(range(7 * count - 6, size + 1)).ljust(7, b"\0")
        assert lines["CAN"][0][2:] == (
            ("data", "01 02 03 04 05 06 07", "data, 7 bytes"),
            ("crc", f"{count - 1:02X}", "packets left"),
        )
        assert lines["CAN"][-1][2:] == (
            ("data", last.hex(" ").upper(), "data, 7 bytes"),
            ("crc", "00", "packets left"),
        )


def test_a_message_that_does_not_fit_on_can_has_no_packets(shipped):
    name = "Trigger ADCS Loop with Simulated Sensor Data"
    assert_limits(
        lambda size: "CAN" in lines_of(shipped, "cubeacp", name, bytes(size))[0],
        most=256 * 7,
    )


LINE = {"data_bits": 8, "parity": "none", "stop_bits": 1}


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ({}, ""),
        ({"baud_rate": 9600}, "9,600 baud. "),
        ({"baud_rate": 9600} | LINE, "9,600 baud, 8N1. "),
        (LINE | {"parity": "even", "stop_bits": 2}, "8E2. "),
        (LINE | {"parity": "odd"}, "8O1. "),
        ({"data_bits": 8, "parity": "none"}, ""),
    ],
)
@pytest.mark.parametrize("escapes_id", [True, False])
def test_the_serial_line_is_named_with_its_byte_stuffing(line, text, escapes_id):
    framing = SimpleNamespace(escape=0x0F, escaped=0xA5, escapes_id=escapes_id)
    within = "id and data" if escapes_id else "the data"
    assert wire._uart_note(line, framing) == (
        f"{text}0F within {within} is sent as 0F A5."
    )


def test_the_decoder_of_a_page_gets_ids_framing_and_checksums(relay):
    icd = load([LINKS / "battery.yaml"]).icd
    relations = Relations(icd)
    checksum = {
        "width": 16, "polynomial": 0x1021, "init": 0xFFFF, "reflect_in": False,
        "reflect_out": False, "xor_out": 0, "bytes": 2, "covers_id": True,
    }  # fmt: skip
    common = {"id_bits": 8, "crc": [checksum], "framing": [0x1F, 0x7F, 0xFF, 0x1F]}
    shown = {
        message.name: wire.page_facts(message, relations.wire(message))
        for message in icd.nodes[0].messages
    }
    assert shown["Set Heater"] == common | {
        "ids": [5], "id": 5, "command": True, "telemetry": None,
    }  # fmt: skip
    assert shown["Last Error"] == common | {
        "ids": [131], "id": 131, "command": False, "telemetry": 131,
    }  # fmt: skip
    relations = Relations(relay)
    counters = relay.nodes[0].messages[4]
    lengths = wire.page_facts(counters, relations.wire(counters))
    assert (lengths["lengths"], lengths["id_bits"], lengths["crc"]) == ([0, 2], 16, [])
    assert "framing" not in lengths and "can" not in lengths
    (beat,) = relay.nodes[0].messages[5:]
    assert "lengths" not in wire.page_facts(beat, relations.wire(beat))


def test_two_lengths_of_a_message_are_a_range(tmp_path):
    text = status("at: 0, name: Data, type: bytes, size: rest, up_to: 1", length=0)
    relations = Relations(loaded(tmp_path, text).icd)
    (message,) = relations.icd.nodes[0].messages
    shown = wire.page_facts(message, relations.wire(message))
    assert shown["lengths"] == [0, 1]


def test_framing_has_its_special_features_only_if_it_has_them():
    def framing_of(**flags) -> dict:
        values = {"escape": 1, "start": 2, "end": 0, "escaped": 4}
        framing = SimpleNamespace(
            **values, **{"escapes_id": True, "ignores_other": False} | flags
        )
        return wire.framing_facts(SimpleNamespace(framing=framing))

    assert framing_of() == {"framing": [1, 2, 0, 4]}
    assert framing_of(escapes_id=False) == framing_of() | {"plain_id": True}
    assert framing_of(ignores_other=True) == framing_of() | {"ignores_other": True}
    assert wire.framing_facts(SimpleNamespace(framing=None)) == {}


FIELDS = {
    "order": [
        ("sync", "header, bits 0 to 7", "begins a message", "193 (0xC1)"),
        ("id", "header, bits 8 to 15", "identifies the message: bits 8 to 15 of its id", ""),
        ("length", "header, bits 16 to 23", "says how long it is: of header, data and trailer", ""),
        ("id", "header, bits 24 to 31", "identifies the message: bits 0 to 7 of its id", ""),
        ("checksum", "trailer, bits 0 to 15", "shows damage", "crc, from the sync to the data"),
    ],
    "beat": [
        ("sync", "header, bits 0 to 15", "begins a message", "D2 D3"),
        ("checksum", "trailer, bits 0 to 7", "shows damage", "xor, from the sync to the data"),
    ],
    "refusal": [
        ("sync", "header, bits 0 to 7", "begins a message", "212 (0xD4)"),
        ("id", "header, bits 8 to 23", "identifies the message", ""),
        ("reason", "header, bits 24 to 31", "says why it was refused", "Reason", "url"),
        ("checksum", "trailer, bits 0 to 7", "shows damage", "xor, from the sync to the data"),
    ],
}  # fmt: skip
BOXES = {
    "order": "sync 8 bits, id 8 bits, length 8 bits, id 8 bits, data , checksum 16 bits",
    "question": "sync 8 bits, id 16 bits, reserved 2 bytes, checksum 8 bits",
    "refusal": "sync 8 bits, id 16 bits, reason 8 bits, reserved 1 byte, checksum 8 bits",
    "busy": "sync 16 bits, checksum 8 bits",
}


def test_fields_of_a_packet_are_shown_in_order_with_their_purpose(relay):
    (node,) = relay.nodes
    forms = {form.name: form for form in facts.of(relay, node).stream.packets}
    packets = {each.name: each for each in declared_packets(node.protocol["link"]).all}
    for name, rows in FIELDS.items():
        shown = packet_formats.format_fields(packets[name], {"Reason": "url"})
        assert shown == [FormatField(*row) for row in rows]
    for name, text in BOXES.items():
        boxes = packet_formats.packet_boxes(packets[name], forms[name])
        assert ", ".join(f"{role} {about}" for role, about, *_ in boxes) == text
        assert {share for _, _, share, _ in boxes} <= {1.0, 3.0}
    (box,) = packet_formats._field_boxes([{"role": "time", "bits": 40, "at": 8}])
    assert box == ("time", "40 bits", 2.5, "8")


LENGTH = {"role": "length", "bits": 8, "at": 0}


@pytest.mark.parametrize(
    ("row", "text"),
    [
        ({"role": "flags"}, "is the sender's choice"),
        (LENGTH, "says how long it is: of the data"),
        (LENGTH | {"plus": 2}, "says how long it is: of the data, + 2"),
        (LENGTH | {"plus": -1}, "says how long it is: of the data, − 1"),
        (
            LENGTH | {"counts": "message", "unit": 4, "byte_order": "little"},
            "says how long it is: of header, data and trailer, in units of 4 bytes, "
            "little endian",
        ),
        (LENGTH | {"unit": 1}, "says how long it is: of the data"),
        (
            {"role": "response_length", "unit": 2},
            "says how long the requested telemetry is, in units of 2 bytes",
        ),
        ({"role": "sequence"}, "counts messages"),
        ({"role": "sequence", "per": "id"}, "counts messages of each id"),
        ({"role": "sequence", "per": "link"}, "counts messages"),
    ],
)
def test_the_purpose_of_a_field_is_named_in_words(row, text):
    assert packet_formats._purpose_text(row) == text


@pytest.mark.parametrize(
    ("row", "text"),
    [
        ({"role": "id"}, ""),
        ({"role": "constant", "value": 0}, "0 (0x0)"),
        ({"role": "sync", "value": [0, 0xA5]}, "00 A5"),
        (
            {"role": "type", "value": {"telecommand": 0, "telemetry": 17}},
            "0 (0x0) in telecommands, 17 (0x11) in telemetry",
        ),
        ({"role": "reason", "enum": "Reason", "value": 3}, "Reason"),
        (
            {"role": "checksum", "checksum": "crc", "covers": {"from": "data", "to": "data"}},
            "crc, the data",
        ),
        (
            {"role": "checksum", "checksum": "crc", "covers": {"from": "id", "to": "data"}},
            "crc, from the id to the data",
        ),
    ],
)  # fmt: skip
def test_the_value_of_a_field_is_shown_in_its_notation(row, text):
    assert packet_formats._value_text(row) == text


def test_scripts_of_a_message_get_its_rows_and_those_without_a_length(relay):
    """The length of a beat shows where its packet ends, which has no length field."""
    (node,) = relay.nodes
    stream = facts.of(relay, node).stream
    contact, _, done, temperature, *_ = node.messages
    rows = {
        message.name: packet_formats.script_facts(stream, message)
        for message in (contact, done, temperature)
    }
    beat = [0x0204, 3, 3, 0, 3]
    assert rows["Set Contact"]["telecommand"] == [[0x0102, 2, 2, 0, 0]]
    # Temperature has the same id in the other direction.
    assert rows["Set Contact"]["telemetry"] == [beat]
    assert rows["Done"]["telecommand"] == []
    assert rows["Done"]["telemetry"] == [[0x0201, 0, 0, 0, 2], beat]
    assert rows["Temperature"]["telemetry"] == [[0x0102, 2, 2, 0, 2], beat]
    requested = {name: data["request"]["ids"] for name, data in rows.items()}
    assert requested == {"Set Contact": [], "Done": [], "Temperature": [0x0102]}
    every = packet_formats.script_facts(stream, with_responses=True)
    assert every["request"] == {"packet": 1, "ids": [0x0102, 0x0203]}
    assert len(every["telemetry"]) == 4 and "responses" not in rows["Done"]
    assert (every["id_pairs"], every["longest"]) == (2, 19)
    order, question = every["packets"][:2]
    assert (order["header"], order["trailer"], order["reserved"]) == (4, 2, 0)
    assert (question["content"], question["reserved"]) == ("request", 2)
    keys = {"role", "in_trailer", "at", "size", "shift", "bits", "little", "values"}
    more = [set(field) - keys for field in order["fields"]]
    assert more == [set(), {"id_shift"}, {"plus"}, set(), set()]
    assert "kind" not in order["check"] and question["check"]["kind"] == "xor"
    refusal, *_ = every["responses"]
    assert {each["packet"] for each in every["responses"]} == {4, 5, 6}
    assert refusal["reason"] == [3, 1, 0, 8, False] and "status" not in refusal
    assert refusal["names"] == ((1, "Too hot"), (2, "Locked"))
    assert refusal["about"]["telemetry"] == [0x0102, 0x0203]
