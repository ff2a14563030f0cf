"""Packet formats and exchanges in generated Rust are exactly those of the link."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen.backends.literals import written
from icdgen.backends.rust.streams import (
    _exchange_form,
    _response_form,
    bus_exchanges_of,
    crc_tables,
    stream_of,
)
from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.protocol.exchange import (
    BusExchanges,
    Echo,
    Exchange,
    NumberPlace,
    Response,
    ResponsePoll,
)
from icdgen.protocol.packet_formats import Escaping, TelemetryRequest
from tests.conformance.icds import LINKS


def text_of(value):
    return written(value, lambda text, indent: f"{indent}// {text}")


@pytest.fixture
def stream():
    icd = load([LINKS / "escaped.yaml"]).icd
    return facts.of(icd, icd.nodes[0]).stream


def packet_field(role, in_trailer, at, size):
    return (
        f"link::PacketField {{ role: link::FieldRole::{role}, in_trailer: {in_trailer},"
        f" at: {at}, size: {size}, shift: 0, bits: {8 * size}, little: true,"
        " values: [0x0000_0000, 0x0000_0000], id_shift: 0, unit: 1, plus: 0 }"
    )


def row(id, length):
    return (
        f"link::StreamRow {{ id: {id}, least: {length}, most: {length},"
        " cuts_zeros: false, seed: 0, exchange: None, repeats: false, requests: None,"
        " packet: 0, is_requested: false }"
    )


ESCAPING = (
    "link::Escaping { escape: 0x1f, start: Some(0x7f), end: 0xff, data: 0x2f,"
    " ignores_other: false }"
)
ALGORITHM = (
    "link::ChecksumAlgorithm { kind: link::CheckKind::Crc, crc: link::CrcForm {"
    " width: 16, polynomial: 0x1021, init: 0xffff, reflect_in: false,"
    " reflect_out: false, xor_out: 0x0000, empty: None } }"
)
STREAM = f"""\
link::Stream {{
    delimited_by: link::Delimiter::Escape({ESCAPING}),
    per_id: false,
    packets: &[
        link::PacketForm {{
            name: "",
            from_host: true,
            from_device: true,
            header_bytes: 2,
            trailer_bytes: 2,
            fields: &[
                {packet_field("Id", "false", 0, 1)},
                {packet_field("Sequence", "false", 1, 1)},
                {packet_field("Checksum", "true", 0, 2)},
            ],
            check: Some(link::CheckForm {{
                algorithm: {ALGORITHM},
                table: Some(&TABLE),
                covered_from: 0,
                covered_trailer: 0,
                is_seeded: false,
            }}),
            content: link::Content::Message,
            reserved: &[0; 0],
        }},
    ],
    telecommands: &[
        {row(1, 0)},
        {row(255, 6)},
    ],
    telemetry: &[
        {row(31, 1)},
        {row(127, 60)},
    ],
    exchanges: &[],
    confirming: &[],
    request: None,
}}"""


def test_a_stream_has_its_packets_and_messages(stream):
    assert text_of(stream_of(stream)) == STREAM


def test_messages_refer_to_their_exchanges_by_index(stream):
    first, second = Exchange((), (), 1), Exchange((), (), 2)
    telecommands = [
        replace(row, exchange=exchange, requests=requests)
        for row, exchange, requests in zip(
            stream.telecommands, (first, second), (None, 1000), strict=True
        )
    ]
    form = replace(
        stream,
        telecommands=tuple(telecommands),
        request=TelemetryRequest(packet=0, exchange=second),
    )
    text = text_of(stream_of(form))
    assert "exchange: Some(0), repeats: false, requests: None" in text
    assert "exchange: Some(1), repeats: false, requests: Some(1_000)" in text
    assert "request: Some(link::RequestForm { packet: 0, exchange: 1 })," in text
    assert text.index("timeout_ms: 1,") < text.index("timeout_ms: 2,")


@pytest.mark.parametrize(
    ("directions", "content", "expected"),
    [
        (("telecommand",), "nothing", ("true", "false", "Nothing")),
        (("telemetry",), "request", ("false", "true", "Request")),
        (("telecommand", "telemetry"), "requested", ("true", "true", "Requested")),
    ],
)
def test_a_packet_has_its_senders_and_content(stream, directions, content, expected):
    (packet,) = stream.packets
    packet = replace(
        packet, directions=directions, content=content, reserved=3, check=None
    )
    text = text_of(stream_of(replace(stream, packets=(packet,))))
    host, device, kind = expected
    assert f"from_host: {host},\n            from_device: {device},\n" in text
    assert (
        "            check: None,\n"
        f"            content: link::Content::{kind},\n"
        "            reserved: &[0; 3],\n"
    ) in text


def test_a_checksum_without_table_is_computed(stream):
    (packet,) = stream.packets
    algorithm = replace(packet.check.algorithm, kind="sum")
    packet = replace(packet, check=replace(packet.check, algorithm=algorithm))
    form = replace(stream, packets=(packet,))
    assert crc_tables(form) == {}
    text = text_of(stream_of(form))
    assert "kind: link::CheckKind::Sum, crc:" in text and "table: None," in text


def test_packets_with_the_same_checksum_share_a_table(stream):
    (packet,) = stream.packets
    other = replace(
        packet,
        check=replace(
            packet.check,
            algorithm=replace(
                packet.check.algorithm,
                crc=replace(packet.check.algorithm.crc, init=0),
            ),
        ),
    )
    bare = replace(packet, check=None)
    tables = crc_tables(replace(stream, packets=(packet, bare, packet, other)))
    assert list(tables.values()) == ["TABLE", "TABLE_2"]
    assert ["init: 0xffff" in text_of(crc) for crc in tables] == [True, False]
    assert crc_tables(None) == {}


@pytest.mark.parametrize(
    ("start", "text"), [(None, "None"), (0x7F, "Some(0x7f)"), (0, "Some(0x00)")]
)
def test_escape_characters_are_part_of_the_delimiter(stream, start, text):
    escaping = Escaping(escape=5, end=0xFF, data=0x1F, start=start, ignores_other=True)
    form = text_of(stream_of(replace(stream, escaping=escaping)))
    assert (
        "    delimited_by: link::Delimiter::Escape(link::Escaping { escape: 0x05,"
        f" start: {text}, end: 0xff, data: 0x1f, ignores_other: true }}),\n"
    ) in form


PLACE = NumberPlace(at=0, size=2, shift=4, bits=12, little=True)
TEXT = "link::NumberPlace { at: 0, size: 2, shift: 4, bits: 12, little: true }"


def test_a_response_has_its_echoes_status_and_reason():
    response = Response(
        telemetry=1000,
        verdict="ack",
        echoes=(Echo(PLACE, 1),),
        status=PLACE,
        meanings=((0, "ack"), (2000, "busy")),
        reason=PLACE,
        reasons=(),
        detail=PLACE,
    )
    assert text_of(_response_form(response)) == (
        "link::Response {\n"
        "    kind: link::ResponseKind::Telemetry(1_000),\n"
        "    verdict: link::Verdict::Ack,\n"
        f"    echoes: &[link::Echo {{ place: {TEXT}, source: 1 }}],\n"
        f"    status: Some({TEXT}),\n"
        "    meanings: &[(0, link::Verdict::Ack), (2_000, link::Verdict::Busy)],\n"
        f"    reason: Some({TEXT}),\n"
        f"    detail: Some({TEXT}),\n"
        "}"
    )


@pytest.mark.parametrize(
    ("telemetry", "packet", "kind"),
    [
        (0, None, "Telemetry(0)"),
        (None, None, "Requested"),
        (None, 0, "Packet(0)"),
        (None, 2, "Packet(2)"),
    ],
)
def test_a_response_is_telemetry_or_a_packet(telemetry, packet, kind):
    response = Response(telemetry, "nak", (), None, (), None, (), packet)
    assert text_of(_response_form(response)) == (
        "link::Response {\n"
        f"    kind: link::ResponseKind::{kind},\n"
        "    verdict: link::Verdict::Nak,\n"
        "    echoes: &[],\n"
        "    status: None,\n"
        "    meanings: &[],\n"
        "    reason: None,\n"
        "    detail: None,\n"
        "}"
    )


def test_an_exchange_has_its_time_out_and_poll():
    exchange = Exchange((PLACE, PLACE), (), 3000, 1, ResponsePoll(0, PLACE))
    assert text_of(_exchange_form(exchange)) == (
        "link::Exchange {\n"
        f"    sources: &[{TEXT}, {TEXT}],\n"
        "    in_header: 1,\n"
        "    responses: &[],\n"
        "    timeout_ms: 3_000,\n"
        f"    poll: Some(link::Poll {{ telemetry: 0, until: {TEXT} }}),\n"
        "}"
    )


def test_exchanges_are_listed_for_each_bus():
    bare = Exchange((), (), 0)
    form = text_of(
        bus_exchanges_of(
            {"i2c": BusExchanges(None, bare), "can": BusExchanges(bare, bare)}
        )
    )
    lines = form.splitlines()
    assert [
        line.strip() for line in lines if line.startswith("    ") and line[4] != " "
    ] == [
        "uart: None,",
        "i2c: Some(link::BusExchanges {",
        "}),",
        "can: Some(link::BusExchanges {",
        "}),",
    ]
    assert "        command: None,\n        request: link::Exchange {\n" in form
    assert "        command: Some(link::Exchange {\n" in form
