"""Rows of the tables of framed links.

`icdgen.backends.c.links` declares the tables; here is one function per kind of row:
packet fields, messages, responses. Rows have the member order of structs in
``runtime/c/wire``.
"""

from __future__ import annotations

from icdgen.backends.c.facts import TableRow, boolean
from icdgen.backends.c.text import plain
from icdgen.icd.responses import AGAIN, KINDS
from icdgen.protocol.exchange import NumberPlace, Response
from icdgen.protocol.packet_formats import (
    NOTHING,
    REQUESTED,
    WORD,
    PacketField,
    PacketFormat,
    Stream,
    StreamRow,
)

_VERDICTS = (*KINDS, AGAIN)  # in the order of icd_verdict_t


def stream_sizes(form: Stream) -> list[tuple[str, int, str]]:
    """Return the sizes of buffers of a node with packets."""
    return [
        (
            "LONGEST",
            form.longest,
            "Buffer size of a decoder in bytes: the longest message with header and trailer.",
        ),
        (
            "LINE_BYTES",
            form.longest_line,
            "Largest size in bytes of an encoded message.",
        ),
        (
            "SEQUENCES",
            form.sequences,
            "Number of sequence counters that a decoder or a sender needs.",
        ),
        (
            "CLIENT_BYTES",
            form.longest + form.longest_request,
            "Buffer size in bytes of a client with one slot.",
        ),
        (
            "REQUEST_BYTES",
            form.longest_request,
            "Size in bytes that each further slot adds to CLIENT_BYTES.",
        ),
    ]


def field_row(field: PacketField) -> TableRow:
    """Return the row of a field of packets."""
    pair = field.values
    if field.role == "id":
        pair = field.id_shift, field.id_shift
    elif field.role in ("length", "response_length"):
        # The member is an unsigned word, so a negative number becomes its two's
        # complement.
        pair = field.plus & (1 << WORD) - 1, field.unit
    values = ", ".join(f"{value:#x}u" for value in pair)
    numbers = f"{field.at}u, {field.size}u, {field.shift}u, {field.bits}u, {boolean(field.little)}, {{{values}}}"
    return TableRow(
        f"{{ICD_FIELD_{field.role.upper()}, {boolean(field.in_trailer)}, {numbers}}}"
    )


def number_place(place: NumberPlace | None, offset: int = 0) -> str:
    """Return the initialiser of the place of a number; ``offset``: bytes in front of
    it. All zeros if there is no number.
    """
    if place is None:
        return "{0u, 0u, 0u, 0u, false}"
    numbers = (place.at + offset, place.size, place.shift, place.bits)
    return (
        f"{{{', '.join(f'{number}u' for number in numbers)}, {boolean(place.little)}}}"
    )


def verdict_name(verdict: str) -> str:
    """Return the enumerator of a verdict."""
    return f"ICD_VERDICT_{verdict.upper()}"


def verdict_mask(response: Response) -> str:
    """Return all that a response can mean, as a mask of verdicts."""
    meanings = {response.verdict, *(verdict for _, verdict in response.meanings)}
    return f"{sum(1 << _VERDICTS.index(each) for each in meanings):#x}u"


def only_id(form: Stream, packet: int, direction: str) -> int:
    """Return the id of the only message of a packet, 0 without one."""
    if form.packets[packet].content == REQUESTED:
        return 0
    ids = (row.id for row in form.rows(direction) if row.packet == packet)
    return min(ids, default=0)


def content_name(packet: PacketFormat) -> str:
    """Return what a packet contains, as the end of an enumerator."""
    return "nothing" if packet.content == NOTHING else packet.content


def stream_flags(form: Stream, row: StreamRow) -> list[str]:
    """Return the flags of a message in packets."""
    flags = {
        "CUTS_ZEROS": row.cuts_zeros,
        "REPEATS": row.repeats,
        "REQUESTS": row.requests is not None,
        "REQUESTED": row.is_requested,
        "NAMELESS": form.packets[row.packet].content == REQUESTED,
    }
    return [f"ICD_STREAM_{name}" for name, is_set in flags.items() if is_set]


def message_row(form: Stream, row: StreamRow, exchange: str | None) -> TableRow:
    """Return the row of a message in packets."""
    values = (
        f"{row.id:#x}u, {row.least}u, {row.most}u",
        " | ".join(stream_flags(form, row)) or "0u",
        f"{row.seed}u, {row.packet}u, {row.requests or 0:#x}u",
        exchange or "NULL",
    )
    return TableRow(f"{{{', '.join(values)}}}", plain(row.name))
