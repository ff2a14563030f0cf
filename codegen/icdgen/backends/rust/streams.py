"""The envelope of a node's link as a value of the wire layer."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.literals import Brackets, Item
from icdgen.backends.rust.facts import member_name, value_of
from icdgen.backends.rust.literals import flat, part, rows, some, spelled, struct
from icdgen.backends.rust.text import integer, mask
from icdgen.naming import camel
from icdgen.protocol.declared import facts_of
from icdgen.protocol.envelope import CRC, WORD, Check, EnvelopeField, Stream, StreamRow

_DELIMITERS = {"none": "Packet"}


def stream_of(form: Stream) -> Brackets:
    """The expression of an envelope."""
    check = None
    if form.check:
        given = form.check
        check = struct(
            "CheckForm",
            part("kind", f"link::CheckKind::{_camel(given.kind)}"),
            part("crc", _crc(given)),
            part("table", some("&TABLE" if given.kind == CRC else None)),
            part("covered_from", integer(given.covered_from)),
            part("covered_trailer", integer(given.covered_trailer)),
            part("is_seeded", spelled(given.is_seeded)),
        )
    return struct(
        "Stream",
        part("delimited_by", f"link::Delimiter::{_DELIMITERS.get(form.delimited_by) or _camel(form.delimited_by)}"),
        part("header_bytes", integer(form.header_bytes)),
        part("trailer_bytes", integer(form.trailer_bytes)),
        part("length_plus", integer(form.length_plus)),
        part("per_id", spelled(form.per_id)),
        part("fields", rows(map(_field, form.fields))),
        part("check", some(check)),
        part("telecommands", _rows(form.telecommands)),
        part("telemetry", _rows(form.telemetry)),
    )


def tabulated(form: Stream | None) -> Brackets | None:
    """The CRC whose table makes the checksum fast."""
    check = form and form.check
    return _crc(check) if check and check.kind == CRC else None


def _crc(check: Check) -> Brackets:
    return flat("CrcForm", **{member_name(fact): value_of(fact, check.crc) for fact in facts_of(check.crc)})


def _camel(word: str) -> str:
    return camel(tuple(word.split("_")))


def _field(one: EnvelopeField) -> Brackets:
    return flat(
        "EnvelopeField",
        role=f"link::EnvelopeRole::{_camel(one.role)}",
        in_trailer=one.in_trailer,
        at=one.at,
        size=one.size,
        shift=one.shift,
        bits=one.bits,
        little=one.little,
        values=Brackets("[", tuple(Item(mask(value, WORD)) for value in one.values), "]", True),
    )


def _rows(found: Iterable[StreamRow]) -> Brackets:
    return rows(map(_row, found))


def _row(row: StreamRow) -> Brackets:
    sizes = {"least": row.least, "most": row.most, "cuts_zeros": row.cuts_zeros}
    reply = None if row.reply is None else integer(row.reply)
    return flat("StreamRow", id=row.id, **sizes, seed=row.seed, reply=some(reply))
