"""The `link` of an ICD becomes packet formats, checksums and rows of messages."""

from __future__ import annotations

from dataclasses import asdict
from itertools import product

import pytest

from icdgen.icd.packets import declared_packets
from icdgen.protocol import facts
from icdgen.protocol.framed_links import (
    bytes_of,
    check_of,
    escaping_of,
    field_of,
    packet_format_of,
)
from icdgen.protocol.packet_formats import Escaping, Stream
from icdgen.protocol.sections import ChecksumAlgorithm
from tests.icd.files import loaded

ORDERS = (("little", "lsb0"), ("big", "msb0"))


def node_of(folder, byte_order="little", bit_order="lsb0"):
    head = f"{{name: demo, title: D, byte_order: {byte_order}, bit_order: {bit_order}}}"
    return loaded(folder, f"icdgen: 1\nnode: {head}\n").icd.nodes[0]


@pytest.mark.parametrize(
    ("places", "size"),
    [([], 0), ([(0, 1)], 1), ([(0, 8)], 1), ([(0, 9)], 2), ([(16, 8), (0, 8)], 3)],
)
def test_a_header_has_the_bytes_up_to_its_last_field(places, size):
    assert bytes_of({"at": at, "bits": bits} for at, bits in places) == size


def test_a_field_has_the_bits_that_the_icd_gives_it(tmp_path):
    frame = bytes((0x5A, 0xC3, 0x17, 0x8E, 0x69, 0xF0))
    for order, bit_order in ORDERS:
        node = node_of(tmp_path, order, bit_order)
        whole = int.from_bytes(frame, order)
        for at, bits in product(range(17), (1, 3, 8, 11, 16, 24)):
            field = field_of(node, {"at": at, "bits": bits, "role": "id"}, False)
            data = frame[field.at : field.at + field.size]
            number = int.from_bytes(data, "little" if field.little else "big")
            down = at if order == "little" else 8 * len(frame) - at - bits
            assert number >> field.shift & field.mask == whole >> down & (1 << bits) - 1
            assert field.size == (at + bits - 1) // 8 - at // 8 + 1


def field(folder, overhead=0, **keys):
    row = {"at": 8, "bits": 16, "role": "id", **keys}
    return field_of(node_of(folder), row, True, 4, overhead)


def test_a_field_has_its_role_place_and_part_of_the_id(tmp_path):
    assert asdict(field(tmp_path)) == {
        "role": "id",
        "in_trailer": True,
        "at": 1,
        "size": 2,
        "shift": 0,
        "bits": 16,
        "little": True,
        "values": (0, 0),
        "id_shift": 4,
        "unit": 1,
        "plus": 0,
    }
    assert field(tmp_path, role="sync").role == "constant"
    assert field(tmp_path, role="source").role == "source"
    assert not field(tmp_path, byte_order="big").little


@pytest.mark.parametrize(
    ("keys", "values"),
    [
        ({"value": 7}, (7, 7)),
        ({"value": {"telecommand": 1, "telemetry": 2}}, (1, 2)),
        ({"value": {"telemetry": 2}}, (0, 2)),
        ({"value": [0x12, 0x34]}, (0x3412, 0x3412)),
        ({"value": [0x12, 0x34], "byte_order": "big"}, (0x1234, 0x1234)),
    ],
)
def test_a_field_has_a_value_for_each_direction(tmp_path, keys, values):
    assert field(tmp_path, **keys).values == values


@pytest.mark.parametrize(
    ("keys", "unit", "plus"),
    [
        ({}, 1, 0),
        ({"plus": -1}, 1, -1),
        ({"plus": -1, "unit": 4}, 4, -4),
        ({"counts": "data"}, 1, 0),
        ({"counts": "message"}, 1, 9),
        ({"counts": "message", "plus": 2, "unit": 4}, 4, 17),
    ],
)
def test_a_length_counts_bytes_in_addition_to_the_data(tmp_path, keys, unit, plus):
    length = field(tmp_path, 9, role="length", **keys)
    assert (length.unit, length.plus) == (unit, plus)


SUM = ChecksumAlgorithm("sum", "sum", None, {})
SEEDED = ChecksumAlgorithm("seeded", "crc", None, {"Turn": 9})
HEADER = [
    {"at": 0, "bits": 8, "role": "sync", "value": 1},
    {"at": 8, "bits": 8, "role": "constant", "name": "Version"},
    {"at": 16, "bits": 8, "role": "id"},
]


def check(covers, trailer=(), checksum="sum", header=HEADER):
    """Return covered bytes of header and trailer."""
    rows = [
        *trailer,
        {"at": 8 * len(trailer), "bits": 8, "role": "checksum", "checksum": checksum,
         "covers": dict(zip(("from", "to"), covers.split(), strict=True))},
    ]  # fmt: skip
    (packet,) = declared_packets({"header": header, "trailer": rows}).all
    result = check_of(packet, {"sum": SUM, "seeded": SEEDED})
    return result.algorithm.name, result.covered_from, result.covered_trailer


@pytest.mark.parametrize(
    ("covers", "first"),
    [("sync data", 0), ("Version data", 1), ("constant data", 1), ("id data", 2),
     ("data data", 3)],
)  # fmt: skip
def test_a_checksum_covers_the_header_from_the_named_field_on(covers, first):
    assert check(covers) == ("sum", first, 0)


def test_a_checksum_covers_the_trailer_up_to_the_end_of_the_last_named_field():
    trailer = [
        {"at": 0, "bits": 8, "role": "constant"},
        {"at": 8, "bits": 16, "role": "source"},
        {"at": 24, "bits": 8, "role": "constant"},
    ]
    assert check("data source", trailer) == ("sum", 3, 3)
    assert check("data constant", trailer) == ("sum", 3, 4)
    assert check("data data", trailer) == ("sum", 3, 0)


def test_a_checksum_is_seeded_if_its_algorithm_has_seeds():
    def is_seeded(name):
        row = {"at": 0, "bits": 8, "role": "checksum", "checksum": name,
               "covers": {"from": "data", "to": "data"}}  # fmt: skip
        (packet,) = declared_packets({"trailer": [row]}).all
        return check_of(packet, {"sum": SUM, "seeded": SEEDED}).is_seeded

    assert (is_seeded("sum"), is_seeded("seeded")) == (False, True)
    (packet,) = declared_packets({"header": HEADER}).all
    assert check_of(packet, {}) is None


def test_other_delimiters_have_no_escape_bytes():
    assert escaping_of({"by": "slip", "escape": 1, "end": 2}) is None


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({}, Escaping(escape=16, end=3, data=16, start=None, ignores_other=False)),
        (
            {"data": 7, "start": 2, "other": "ignore"},
            Escaping(escape=16, end=3, data=7, start=2, ignores_other=True),
        ),
        (
            {"other": "error"},
            Escaping(escape=16, end=3, data=16, start=None, ignores_other=False),
        ),
    ],
)
def test_the_escape_byte_is_doubled_by_default(keys, expected):
    assert escaping_of({"by": "escape", "escape": 16, "end": 3, **keys}) == expected


ROW = "{at: 0, bits: 8, role: constant, value: %d}, {at: 8, bits: 8, role: id}"
LINK = f"""\
protocol:
  link:
    framing: {{by: cobs}}
    trailer: [{{at: 0, bits: 8, role: checksum, checksum: sum, covers: {{from: id, to: data}}}}]
    packets:
      refusal:
        from: device
        header: [{ROW % 1}, {{at: 16, bits: 8, role: reason, enum: Reason}}]
        reserved: 2
      command: {{from: host, header: [{ROW % 2}]}}
      read: {{from: host, header: [{ROW % 3}]}}
      answer: {{from: device, header: [{{at: 0, bits: 8, role: constant, value: 4}}]}}
      event:
        from: device
        header: [{ROW % 5}]
        messages: [Event, Long Event, Done, Hidden, Reply]
    commands: {{ack: {{message: Done, echo: Last}}, nak: {{packet: refusal, echo: id, reason: reason}}}}
    requests: {{packet: read, reserved: 3, response: answer}}
    checksums:
      sum: {{kind: sum, width: 8}}
    client: {{reply_timeout_ms: 100}}
enums:
  - {{name: Reason, members: [{{value: 1, name: Length}}]}}
messages:
  - {{name: Done, id: 6, kind: telemetry, length: 1, fields: [{{at: 0, bits: 8, name: Last, type: uint}}]}}
  - {{name: State, id: 7, kind: telemetry, length: 2, reserved: 2, may_end_early: zeros}}
  - {{name: Hidden, id: 8, kind: telemetry, length: 2, reserved: 2, requested: false}}
  - {{name: Event, id: 9, kind: telemetry, length: 4, reserved: 4}}
  - {{name: Long Event, id: 4, kind: telemetry, length: 9, reserved: 9}}
  - {{name: Reply, id: 10, kind: telemetry, length: 5, reserved: 5}}
  - {{name: Stop, id: 3, kind: telecommand, length: 0, repeat: true}}
  - {{name: Ask, id: 5, kind: telecommand, length: 2, reserved: 2, response: {{ack: none, reply: Reply}}}}
  - {{name: Ask More, id: 2, kind: telecommand, length: 1, response: {{ack: none, reply: Reply}},
     fields: [{{at: 0, bits: 8, name: Number, type: uint}}]}}
  - {{name: Quiet, id: 1, kind: telecommand, length: 1, reserved: 1, response: none}}
"""


@pytest.fixture(scope="module")
def stream(tmp_path_factory) -> Stream:
    result = loaded(tmp_path_factory.mktemp("icd"), LINK)
    assert result.ok, [finding.message for finding in result.findings]
    return facts.of(result.icd, result.icd.nodes[0]).stream


def test_packets_have_their_content_in_the_order_of_the_icd(stream):
    assert [
        (p.name, p.directions, p.content, p.header_bytes, p.trailer_bytes, p.reserved)
        for p in stream.packets
    ] == [
        ("refusal", ("telemetry",), "none", 3, 1, 2),
        ("command", ("telecommand",), "message", 2, 1, 0),
        ("read", ("telecommand",), "request", 2, 1, 3),
        ("answer", ("telemetry",), "requested", 1, 1, 0),
        ("event", ("telemetry",), "message", 2, 1, 0),
    ]
    assert [(f.role, f.in_trailer) for f in stream.packets[0].fields] == [
        ("constant", False),
        ("id", False),
        ("reason", False),
        ("checksum", True),
    ]


def test_messages_are_in_ascending_order_with_their_lengths_and_packets(stream):
    assert [
        (row.id, row.name, row.least, row.most, row.packet, row.cuts_zeros)
        for row in stream.telemetry
    ] == [
        (4, "Long Event", 9, 9, 4, False),
        (6, "Done", 1, 1, 4, False),
        (7, "State", 1, 2, 3, True),
        (8, "Hidden", 2, 2, 4, False),
        (9, "Event", 4, 4, 4, False),
        (10, "Reply", 5, 5, 4, False),
    ]
    assert [
        (row.id, row.name, row.least, row.most, row.packet, row.repeats)
        for row in stream.telecommands
    ] == [
        (1, "Quiet", 1, 1, 1, False),
        (2, "Ask More", 1, 1, 1, False),
        (3, "Stop", 0, 0, 1, True),
        (5, "Ask", 2, 2, 1, False),
    ]


def test_messages_have_no_seed_unless_the_checksum_has_one(stream):
    assert {row.seed for row in (*stream.telecommands, *stream.telemetry)} == {0}


def test_only_a_telecommand_of_zeros_requests_its_reply(stream):
    assert [(row.name, row.requests) for row in stream.telecommands] == [
        ("Quiet", None),
        ("Ask More", None),
        ("Stop", None),
        ("Ask", 10),
    ]
    assert [row.exchange is None for row in stream.telecommands] == [True] + [False] * 3


def test_the_packet_requests_telemetry_that_no_telecommand_does(stream):
    # `Done` only responds, `Hidden` is never requested, and events have another packet.
    assert [row.name for row in stream.telemetry if row.is_requested] == ["State"]
    assert (stream.request.packet, stream.requested_ids) == (2, {7, 10})
    assert stream.confirming == (6,)


SEEDS = """\
protocol:
  link:
    framing: {by: datagram}
    header:
      - {at: 0, bits: 8, role: id}
      - {at: 8, bits: 8, role: sequence, per: %s}
    trailer: [{at: 0, bits: 16, role: checksum, checksum: crc, covers: {from: id, to: data}}]
    checksums:
      crc: {kind: crc, width: 16, polynomial: 0x1021, init: 0, reflect_in: false,
            reflect_out: false, xor_out: 0, check: 0x31C3, seeds: {A: 50, B: 50, C: 7}}
messages:
  - {name: A, id: 1, kind: telemetry, length: 1, shares_id: true,
     fields: [{at: 0, bits: 8, name: Kind, type: uint, const: 3}]}
  - {name: B, id: 1, kind: telemetry, length: 4, reserved: 3, shares_id: true,
     fields: [{at: 0, bits: 8, name: Kind, type: uint, const: 4}]}
  - {name: C, id: 2, kind: telecommand, length: 1, reserved: 1}
"""


@pytest.mark.parametrize(
    ("per", "per_id", "sequences"), [("link", False, 1), ("id", True, 1)]
)
def test_messages_that_share_an_id_are_one_row(tmp_path, per, per_id, sequences):
    result = loaded(tmp_path, SEEDS % per)
    assert result.ok, [finding.message for finding in result.findings]
    stream = facts.of(result.icd, result.icd.nodes[0]).stream
    (row,) = stream.telemetry
    assert (row.name, row.least, row.most) == ("A or B", 1, 4)
    assert (row.seed, stream.telecommands[0].seed) == (50, 7)
    assert (stream.per_id, stream.sequences) == (per_id, sequences)
    assert stream.packets[0].check.is_seeded


def test_a_length_of_the_message_counts_header_and_trailer(tmp_path):
    rows = [{"at": 0, "bits": 24, "role": "length", "counts": "message"}]
    trailer = [{"at": 0, "bits": 8, "role": "constant"}]
    packets = declared_packets({"header": rows, "trailer": trailer})
    form = packet_format_of(node_of(tmp_path), packets, packets.all[0], {})
    assert form.fields[0].plus == 3 + 1


def test_parts_of_an_id_have_their_shift(tmp_path):
    rows = [
        {"at": 0, "bits": 4, "role": "id"},
        {"at": 4, "bits": 4, "role": "flags"},
        {"at": 8, "bits": 8, "role": "id"},
    ]
    trailer = [{"at": 0, "bits": 8, "role": "id"}]
    packets = declared_packets({"header": rows, "trailer": trailer})
    form = packet_format_of(node_of(tmp_path), packets, packets.all[0], {})
    assert [(f.role, f.in_trailer, f.id_shift) for f in form.fields] == [
        ("id", False, 16),
        ("flags", False, 0),
        ("id", False, 8),
        ("id", True, 0),
    ]
    assert (form.overhead, form.check, form.content) == (3, None, "message")
