"""Packet formats and rows of a stream, and the sizes from which generated code has its
buffers.
"""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.stream import stream_encode

from icdgen.protocol import facts
from icdgen.protocol.exchange import Exchange, Response
from icdgen.protocol.packet_formats import (
    Escaping,
    PacketField,
    PacketFormat,
    Stream,
    StreamRow,
    TelemetryRequest,
)
from tests.features.outputs import icd_of
from tests.links import link

LINK = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0}}
protocol:
  link:
    framing: {framing}
    header: [{{at: 0, bits: 8, role: id}}]
messages:
  - name: Block
    id: 0x7D
    kind: telemetry
    length: {length}
    fields: [{{at: 0, bits: 8, name: Numbers, type: uint, count: {length}}}]
"""
ESCAPE = "{by: escape, escape: 0x7D, start: 0, end: 0xFF, data: 0x2F}"


@pytest.mark.parametrize(
    ("framing", "length", "line"),
    [
        ("{by: slip}", 20, 42 + 2 - 1),  # a first byte 7D is not escaped
        ("{by: hdlc}", 20, 42 + 2),
        (ESCAPE, 20, 42 + 4),
        ("{by: cobs}", 1, 2 + 2),
        ("{by: cobs}", 252, 253 + 2),
        ("{by: cobs}", 254, 255 + 3),
        ("{by: cobs}", 506, 507 + 3),
        ("{by: cobs}", 508, 509 + 4),
    ],
)
def test_the_longest_line_has_space_for_a_message_of_the_worst_bytes(
    framing, length, line, tmp_path
):
    icd = icd_of(LINK.format(framing=framing, length=length), tmp_path)
    stream = facts.of(icd, icd.node("demo")).stream
    assert stream.longest == length + 1
    lines = [
        len(stream_encode(link(icd, "demo"), 0x7D, bytes([byte] * length), "telemetry"))
        for byte in range(256)
    ]
    assert max(lines) == line
    assert line <= stream.longest_line <= line + 1


def packet(
    name="p",
    *fields,
    directions=("telecommand", "telemetry"),
    head=0,
    tail=0,
    reserved=0,
):
    return PacketFormat(
        name=name, directions=directions, content="message", header_bytes=head,
        trailer_bytes=tail, reserved=reserved, fields=fields, check=None,
    )  # fmt: skip


def field(role, bits=8):
    return PacketField(role, False, 0, 1, 0, bits, False, (0, 0))


def row(id, most=0, packet=0, **more):
    return StreamRow(id, 0, most, False, 0, f"M{id}", packet=packet, **more)


def stream(*packets, by="length", per_id=False, telecommands=(), telemetry=(), **more):
    return Stream(
        delimited_by=by, per_id=per_id, packets=packets or (packet(),),
        telecommands=telecommands, telemetry=telemetry, **more,
    )  # fmt: skip


def exchange(*telemetry, verdict="ack", packet=None):
    responses = tuple(
        Response(id, verdict, (), None, (), None, (), packet) for id in telemetry
    )
    return Exchange((), responses, 0)


def test_the_first_field_of_a_role_counts():
    first, second = field("id"), field("id")
    form = packet("p", field("type"), first, second, head=3, tail=2)
    assert form.of("id") is first and form.of("sequence") is None
    assert form.overhead == 5
    assert [field("id", bits).mask for bits in (1, 8, 32)] == [1, 255, 2**32 - 1]


def test_rows_and_packets_are_those_of_a_direction():
    both, sent = packet("both"), packet("sent", directions=("telecommand",))
    tested = stream(sent, both, telecommands=(row(1),), telemetry=(row(2), row(3)))
    assert [each.id for each in tested.rows("telecommand")] == [1]
    assert [each.id for each in tested.rows("telemetry")] == [2, 3]
    assert tested.packets_of("telecommand") == (sent, both)
    assert tested.packets_of("telemetry") == (both,)


def test_the_sender_chooses_values_of_the_first_field_of_each_role():
    source, other, status = field("source"), field("source"), field("status")
    tested = stream(
        packet("a", field("constant"), source),
        packet("b", other, status, field("length"), directions=("telemetry",)),
    )
    assert tested.chosen("telecommand") == {"source": source}
    assert tested.chosen("telemetry") == {"source": source, "status": status}


def test_sizes_are_those_of_the_longest_message_and_packet():
    small, large = packet(head=2, tail=1), packet(head=9, tail=3, reserved=4)
    rows = {"telecommands": (row(1, 5), row(2, 30)), "telemetry": (row(3, 20, 1),)}
    tested = stream(small, large, **rows)
    assert (tested.longest_data, tested.longest_request, tested.longest) == (30, 30, 33)
    request = TelemetryRequest(1, exchange())
    few = {"telecommands": (row(1, 3),), "telemetry": (row(3, 20, 1),)}
    asked = stream(small, large, request=request, **few)
    assert (asked.longest_data, asked.longest_request, asked.longest) == (20, 4, 32)
    empty = stream(small, large)
    assert (empty.longest_data, empty.longest_request, empty.longest) == (0, 0, 16)


@pytest.mark.parametrize(
    ("by", "length", "line"),
    [
        ("slip", 10, 22),
        ("hdlc", 10, 22),
        ("cobs", 10, 12),
        ("cobs", 253, 255),
        ("cobs", 254, 257),
        ("cobs", 508, 512),
        ("length", 10, 10),
        ("datagram", 10, 10),
    ],
)
def test_the_longest_line_has_each_byte_escaped_and_delimiters(by, length, line):
    assert stream(by=by, telemetry=(row(1, length),)).longest_line == line


def test_a_start_byte_and_an_end_byte_are_escaped():
    def line(start):
        escaping = Escaping(escape=1, end=2, data=3, start=start, ignores_other=False)
        return stream(
            by="escape", telemetry=(row(1, 10),), escaping=escaping
        ).longest_line

    assert (line(None), line(0), line(7)) == (22, 24, 24)


def test_a_decoder_has_a_sequence_counter_for_each_id_or_one():
    counted = packet("c", field("sequence"))
    rows = {"telecommands": (row(1), row(2)), "telemetry": (row(3), row(4), row(5))}
    assert stream(packet(), **rows).sequences == 0
    assert stream(packet(), counted, **rows).sequences == 1
    assert stream(packet(), counted, per_id=True, **rows).sequences == 3
    rows = {"telecommands": (row(1), row(2)), "telemetry": (row(3),)}
    assert stream(counted, per_id=True, **rows).sequences == 2
    assert stream(counted, per_id=True).sequences == 1
    assert stream(packet(), per_id=True, **rows).sequences == 0


def test_equal_exchanges_are_one_and_that_of_requests_is_last():
    first, second, request = exchange(7), exchange(8), exchange(9)
    rows = (row(1, exchange=second), row(2), row(3, exchange=first),
            row(4, exchange=exchange(8)))  # fmt: skip
    tested = stream(telecommands=rows, request=TelemetryRequest(0, request))
    assert tested.exchanges == (second, first, request)
    assert stream(telecommands=rows).exchanges == (second, first)


def test_confirming_telemetry_responds_and_is_never_a_reply():
    rows = (
        row(1, exchange=exchange(9, 7, None)),
        row(2, exchange=exchange(8, verdict="reply")),
        row(3, exchange=exchange(8, 5, verdict="nak")),
    )
    assert stream(telecommands=rows).confirming == (5, 7, 9)
    request = TelemetryRequest(0, exchange(6, verdict="nak"))
    assert stream(telecommands=rows, request=request).confirming == (5, 6, 7, 9)


def test_telemetry_is_requested_by_telecommands_or_by_a_packet():
    own, by_packet = exchange(1), exchange(2)
    request = TelemetryRequest(0, by_packet)
    sent = row(1, exchange=own, requests=7)
    asked, other = row(8, is_requested=True), row(9)
    rows = {"telecommands": (sent, row(2)), "telemetry": (asked, other)}
    tested = stream(request=request, **rows)
    assert tested.requested_ids == {7, 8}
    assert [tested.exchange_of(each) for each in (sent, asked, other)] == [
        own, by_packet, None,
    ]  # fmt: skip
    assert stream(**rows).exchange_of(asked) is None
