"""Packet formats as values of the wire layer."""

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
from icdgen.backends.rust.text import mask
from icdgen.protocol.declared import facts_of
from icdgen.protocol.envelope import CRC, WORD, Check, EnvelopeField, Stream, StreamRow
from icdgen.protocol.exchange import Exchange, NumberPlace, Response

_DELIMITERS = {"none": "Packet"}


def stream_of(form: Stream) -> Brackets:
    """Return the expression of a packet format."""
    exchanges = form.exchanges
    indices = {exchange: index for index, exchange in enumerate(exchanges)}
    return struct(
        "Stream",
        part(
            "delimited_by",
            f"link::Delimiter::{_DELIMITERS.get(form.delimited_by) or variant(form.delimited_by)}",
        ),
        part("header_bytes", spelled(form.header_bytes)),
        part("trailer_bytes", spelled(form.trailer_bytes)),
        part("length_plus", spelled(form.length_plus)),
        part("per_id", spelled(form.per_id)),
        part("fields", rows(map(_field, form.fields))),
        part("check", some(_check(form.check) if form.check else None)),
        part("telecommands", rows(_row(row, indices) for row in form.telecommands)),
        part("telemetry", rows(_row(row, indices) for row in form.telemetry)),
        part("exchanges", rows(map(_exchange, exchanges))),
        part("confirming", flat_rows(map(spelled, form.confirming))),
    )


def _check(check: Check) -> Brackets:
    return struct(
        "CheckForm",
        part("kind", f"link::CheckKind::{variant(check.kind)}"),
        part("crc", _crc(check)),
        part("table", some("&TABLE" if check.kind == CRC else None)),
        part("covered_from", spelled(check.covered_from)),
        part("covered_trailer", spelled(check.covered_trailer)),
        part("is_seeded", spelled(check.is_seeded)),
    )


def tabulated(form: Stream | None) -> Brackets | None:
    """Return the CRC for which the wire layer gets a table; None for any other
    checksum.
    """
    check = form and form.check
    return _crc(check) if check and check.kind == CRC else None


def _crc(check: Check) -> Brackets:
    return flat(
        "CrcForm",
        **{
            member_name(fact): value_of(fact, check.crc) for fact in facts_of(check.crc)
        },
    )


def _field(field: EnvelopeField) -> Brackets:
    values = Brackets(
        "[", tuple(Item(mask(value, WORD)) for value in field.values), "]", True
    )
    return flat(
        "EnvelopeField",
        **{
            **members(field),
            "role": f"link::EnvelopeRole::{variant(field.role)}",
            "values": values,
        },
    )


def _row(row: StreamRow, indices: Mapping[Exchange, int]) -> Brackets:
    items = {key: value for key, value in members(row).items() if key != "name"}
    return flat(
        "StreamRow",
        **{
            **items,
            "exchange": some(indices[row.exchange] if row.exchange else None),
            "requests": some(row.requests),
        },
    )


def _exchange(exchange: Exchange) -> Brackets:
    return struct(
        "Exchange",
        part("sources", flat_rows(map(_place, exchange.sources))),
        part("responses", rows(map(_response, exchange.responses))),
        part("timeout_ms", spelled(exchange.timeout)),
    )


def _response(response: Response) -> Brackets:
    echoes = (
        flat("Echo", place=_place(echo.place), source=echo.source)
        for echo in response.echoes
    )
    meanings = (
        f"({spelled(value)}, {_verdict(meaning)})"
        for value, meaning in response.meanings
    )
    return struct(
        "Response",
        part("telemetry", spelled(response.telemetry)),
        part("verdict", _verdict(response.verdict)),
        part("echoes", flat_rows(echoes)),
        part("status", _optional_place(response.status)),
        part("meanings", flat_rows(meanings)),
        part("reason", _optional_place(response.reason)),
    )


def _optional_place(place: NumberPlace | None) -> Expression:
    return some(_place(place) if place else None)


def _place(place: NumberPlace) -> Brackets:
    return flat("NumberPlace", **members(place))


def _verdict(verdict: str) -> str:
    return f"link::Verdict::{variant(verdict)}"
