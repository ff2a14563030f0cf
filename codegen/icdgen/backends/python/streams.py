"""The envelope of a node's link as the source of its ``LINK.stream``."""

from __future__ import annotations

from collections.abc import Iterable

from icdgen.backends.python.literals import Call
from icdgen.protocol.declared import facts_of
from icdgen.protocol.envelope import EnvelopeField, Stream, StreamRow


def stream_call(form: Stream) -> Call:
    """The call that makes it."""
    parts: dict[str, object] = {
        "delimited_by": form.delimited_by,
        "header_bytes": form.header_bytes,
        "trailer_bytes": form.trailer_bytes,
        "length_plus": form.length_plus,
        "per_id": form.per_id,
        "fields": tuple(map(_field, form.fields)),
        "telecommands": _rows(form.telecommands),
        "telemetry": _rows(form.telemetry),
    }
    check = form.check
    if check:
        crc = {fact.name: getattr(check.crc, fact.name) for fact in facts_of(check.crc)}
        known = {key: value for key, value in crc.items() if value is not None}
        values = (check.kind, Call("link.CrcForm", (), known, is_flat=True))
        values += (check.covered_from, check.covered_trailer, check.is_seeded)  # type: ignore[assignment]
        parts["check"] = Call("link.CheckForm", values, {}, is_flat=True)
    return Call("link.Stream", (), parts)


def _field(one: EnvelopeField) -> Call:
    values = (one.role, one.in_trailer, one.at, one.size, one.shift, one.bits, one.little, one.values)
    return Call("link.EnvelopeField", values, {}, is_flat=True)


def _rows(rows: Iterable[StreamRow]) -> tuple[Call, ...]:
    return tuple(
        Call("link.StreamRow", (row.id, row.least, row.most, row.cuts_zeros, row.seed, *_reply(row)), {}, is_flat=True)
        for row in rows
    )


def _reply(row: StreamRow) -> tuple[int, ...]:
    return () if row.reply is None else (row.reply,)
