"""Packet formats as values of the wire layer.

Input are the packet formats and exchanges of `icdgen.protocol`; output are struct
expressions of the types in ``runtime/rust/src/wire/link``. `icdgen.backends.rust.links`
puts them into the link of a node.
"""

from __future__ import annotations

from collections.abc import Mapping

from icdgen.backends.literals import Brackets, Item
from icdgen.backends.rust.facts import member_name, value_of
from icdgen.backends.rust.literals import (
    Expression,
    flat,
    flat_rows,
    members,
    part,
    rows,
    some,
    spelled,
    struct,
)
from icdgen.backends.rust.names import variant
from icdgen.backends.rust.text import mask, string
from icdgen.icd.buses import BUSES
from icdgen.protocol.declared import facts_of
from icdgen.protocol.exchange import (
    BusExchanges,
    Exchange,
    NumberPlace,
    Response,
    ResponsePoll,
)
from icdgen.protocol.packet_formats import (
    CRC,
    DIRECTIONS,
    NOTHING,
    WORD,
    Check,
    PacketField,
    PacketFormat,
    Stream,
    StreamRow,
)
from icdgen.protocol.sections import ChecksumAlgorithm, Crc

_CONTENTS = {NOTHING: "Nothing"}


def stream_of(form: Stream) -> Brackets:
    """Return the expression of packet formats and their messages."""
    # Messages share exchanges, so each row has the index of its exchange in the table.
    indices = {exchange: index for index, exchange in enumerate(form.exchanges)}
    tables = crc_tables(form)
    return struct(
        "Stream",
        part("delimited_by", _delimiter(form)),
        part("per_id", spelled(form.per_id)),
        part("packets", rows(_packet_form(packet, tables) for packet in form.packets)),
        part(
            "telecommands", rows(_stream_row(row, indices) for row in form.telecommands)
        ),
        part("telemetry", rows(_stream_row(row, indices) for row in form.telemetry)),
        part("exchanges", rows(map(_exchange_form, form.exchanges))),
        part("confirming", flat_rows(map(spelled, form.confirming))),
        part("request", some(_request_form(form, indices))),
    )


def bus_exchanges_of(exchanges: Mapping[str, BusExchanges]) -> Brackets:
    """Return the expression of the responses on each bus."""
    buses = ((bus, exchanges.get(bus)) for bus in BUSES)
    return struct(
        "PerBus", *(part(bus, some(_on_bus(on) if on else None)) for bus, on in buses)
    )


def _on_bus(exchanges: BusExchanges) -> Brackets:
    command = exchanges.command
    return struct(
        "BusExchanges",
        part("command", some(_exchange_form(command) if command else None)),
        part("request", _exchange_form(exchanges.request)),
    )


def _delimiter(form: Stream) -> Expression:
    delimiter = f"link::Delimiter::{variant(form.delimited_by)}"
    escaping = form.escaping
    if escaping is None:
        return delimiter
    start = escaping.start
    fields = flat(
        "Escaping",
        escape=f"{escaping.escape:#04x}",
        start=some(None if start is None else f"{start:#04x}"),
        end=f"{escaping.end:#04x}",
        data=f"{escaping.data:#04x}",
        ignores_other=escaping.ignores_other,
    )
    return fields.within(f"{delimiter}(", ")")


def _request_form(form: Stream, indices: Mapping[Exchange, int]) -> Brackets | None:
    request = form.request
    if request is None:
        return None
    return flat(
        "RequestForm",
        packet=request.packet,
        exchange=indices[request.exchange],
    )


def _packet_form(packet: PacketFormat, tables: Mapping[Brackets, str]) -> Brackets:
    host, device = DIRECTIONS
    content = _CONTENTS.get(packet.content) or variant(packet.content)
    return struct(
        "PacketForm",
        part("name", string(packet.name)),
        part("from_host", spelled(host in packet.directions)),
        part("from_device", spelled(device in packet.directions)),
        part("header_bytes", spelled(packet.header_bytes)),
        part("trailer_bytes", spelled(packet.trailer_bytes)),
        part("fields", rows(map(_packet_field, packet.fields))),
        part(
            "check", some(_check_form(packet.check, tables) if packet.check else None)
        ),
        part("content", f"link::Content::{content}"),
        part("reserved", f"&[0; {packet.reserved}]"),
    )


def crc_tables(form: Stream | None) -> dict[Brackets, str]:
    """Return the name of the lookup table of each CRC of the packets."""
    checks = [packet.check for packet in (form.packets if form else ())]
    crcs = [
        _crc_form(check.algorithm.crc)
        for check in checks
        if check and check.algorithm.kind == CRC
    ]
    return {
        crc: f"TABLE_{number}" if number > 1 else "TABLE"
        # Packets with the same CRC share its table, which is 256 words of read-only
        # memory.
        for number, crc in enumerate(dict.fromkeys(crcs), 1)
    }


def _check_form(check: Check, tables: Mapping[Brackets, str]) -> Brackets:
    crc = _crc_form(check.algorithm.crc)
    return struct(
        "CheckForm",
        part("algorithm", algorithm_of(check.algorithm)),
        part("table", some(f"&{tables[crc]}" if check.algorithm.kind == CRC else None)),
        part("covered_from", spelled(check.covered_from)),
        part("covered_trailer", spelled(check.covered_trailer)),
        part("is_seeded", spelled(check.is_seeded)),
    )


def algorithm_of(algorithm: ChecksumAlgorithm) -> Brackets:
    """Return the expression of the algorithm of a checksum."""
    return flat(
        "ChecksumAlgorithm",
        kind=f"link::CheckKind::{variant(algorithm.kind)}",
        crc=_crc_form(algorithm.crc),
    )


def _crc_form(crc: Crc) -> Brackets:
    return flat(
        "CrcForm",
        **{member_name(fact): value_of(fact, crc) for fact in facts_of(crc)},
    )


def _packet_field(field: PacketField) -> Brackets:
    values = Brackets(
        "[", tuple(Item(mask(value, WORD)) for value in field.values), "]", True
    )
    return flat(
        "PacketField",
        **{
            **members(field),
            "role": f"link::FieldRole::{variant(field.role)}",
            "values": values,
        },
    )


def _stream_row(row: StreamRow, indices: Mapping[Exchange, int]) -> Brackets:
    # The runtime identifies messages by their ids. Names would only need memory on the
    # target.
    items = {key: value for key, value in members(row).items() if key != "name"}
    return flat(
        "StreamRow",
        **{
            **items,
            "exchange": some(indices[row.exchange] if row.exchange else None),
            "requests": some(row.requests),
        },
    )


def _exchange_form(exchange: Exchange) -> Brackets:
    return struct(
        "Exchange",
        part("sources", flat_rows(map(_number_place, exchange.sources))),
        part("in_header", spelled(exchange.in_header)),
        part("responses", rows(map(_response_form, exchange.responses))),
        part("timeout_ms", spelled(exchange.timeout)),
        part("poll", some(_poll(exchange.poll) if exchange.poll else None)),
    )


def _poll(poll: ResponsePoll) -> Brackets:
    return flat("Poll", telemetry=poll.telemetry, until=_number_place(poll.until))


def _response_form(response: Response) -> Brackets:
    echoes = (
        flat("Echo", place=_number_place(echo.place), source=echo.source)
        for echo in response.echoes
    )
    meanings = (
        f"({spelled(value)}, {_verdict(meaning)})"
        for value, meaning in response.meanings
    )
    return struct(
        "Response",
        part("kind", f"link::ResponseKind::{_response_kind(response)}"),
        part("verdict", _verdict(response.verdict)),
        part("echoes", flat_rows(echoes)),
        part("status", _optional_place(response.status)),
        part("meanings", flat_rows(meanings)),
        part("reason", _optional_place(response.reason)),
        part("detail", _optional_place(response.detail)),
    )


def _response_kind(response: Response) -> str:
    if response.packet is not None:
        return f"Packet({response.packet})"
    id = response.telemetry
    return "Requested" if id is None else f"Telemetry({spelled(id)})"


def _optional_place(place: NumberPlace | None) -> Expression:
    return some(_number_place(place) if place else None)


def _number_place(place: NumberPlace) -> Brackets:
    return flat("NumberPlace", **members(place))


def _verdict(verdict: str) -> str:
    return f"link::Verdict::{variant(verdict)}"
