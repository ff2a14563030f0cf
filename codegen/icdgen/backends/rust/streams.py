"""Packet formats as values of the wire layer."""

from __future__ import annotations

from icdgen.backends.literals import Brackets, Item
from icdgen.backends.rust.facts import member_name, value_of
from icdgen.backends.rust.literals import (
    flat,
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

_DELIMITERS = {"none": "Packet"}


def stream_of(form: Stream) -> Brackets:
    """Return the expression of a packet format."""
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
        part("telecommands", rows(map(_row, form.telecommands))),
        part("telemetry", rows(map(_row, form.telemetry))),
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


def _row(row: StreamRow) -> Brackets:
    items = {key: value for key, value in members(row).items() if key != "name"}
    return flat("StreamRow", **{**items, "reply": some(row.reply)})
