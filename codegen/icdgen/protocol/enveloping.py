"""The `stream` section of a checked ICD -> the parts of `icdgen.protocol.envelope`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from icdgen.icd.model import Node
from icdgen.icd.variants import Ids, Variant
from icdgen.protocol.envelope import DATA, DIRECTIONS, ROLES, Check, EnvelopeField, Stream, StreamRow
from icdgen.protocol.sections import Crc

Section = Mapping[str, Any]


def bytes_of(bits: Iterable[tuple[int, int]]) -> int:
    """Whole bytes up to the last of the fields, given as place and width."""
    return -(-max((at + width for at, width in bits), default=0) // 8)


def field_of(node: Node, row: Section, in_trailer: bool) -> EnvelopeField:
    """A row of the header or trailer."""
    at, bits = row["at"], row["bits"]
    first, last = at // 8, (at + bits - 1) // 8
    shift = at % 8 if node.bit_order != "msb0" else (last + 1) * 8 - at - bits
    little = row.get("byte_order", node.byte_order) == "little"
    role = "constant" if row["role"] == "sync" else row["role"]
    size = last - first + 1
    return EnvelopeField(role, in_trailer, first, size, shift, bits, little, values_of(row, little))


def values_of(row: Section, little: bool) -> tuple[int, int]:
    """The values that a row holds in each direction; bytes stand in the order in which they are sent."""
    value = row.get("value", 0)
    sent, came = (value.get(direction, 0) if isinstance(value, Mapping) else value for direction in DIRECTIONS)
    return _number(sent, little), _number(came, little)


def _number(value: Any, little: bool) -> int:
    return int.from_bytes(bytes(value), "little" if little else "big") if isinstance(value, list) else value


def rows_of(
    ids: Mapping[int, tuple[Variant, ...]], seeds: Mapping[str, int], replies: Mapping[str, int]
) -> tuple[StreamRow, ...]:
    """The messages of a direction, those that share an id as one: in the envelope they are alike (ICD174)."""
    rows = []
    for id, those in sorted(ids.items()):
        messages = [one.message for one in those]
        least, most = min(one.layout.shortest for one in messages), max(one.length for one in messages)
        first, name = messages[0], " or ".join(one.name for one in messages)
        reply = next((replies[one.name] for one in messages if one.name in replies), None)
        rows.append(StreamRow(id, least, most, bool(first.may_end_early), seeds.get(first.name, 0), reply, name))
    return tuple(rows)


def place_of(rows: Iterable[Section], name: str, last: bool) -> Section | None:
    """The first or last row of that role."""
    found = [row for row in rows if row.get("role") == name]
    return found[-1 if last else 0] if found else None


def check_of(section: Section, checksums: Section) -> Check | None:
    """The checksum that a row asks for."""
    header, trailer = section.get("header", ()), section.get("trailer", ())
    row = place_of((*header, *trailer), "checksum", False)
    given = checksums.get(row.get("checksum", "")) if row else None
    if not given:
        return None
    kind = given["kind"]
    width, polynomial, init, xor_out = (given.get(key, 0) for key in ("width", "polynomial", "init", "xor_out"))
    reflected = given.get("reflect_in", False), given.get("reflect_out", False)
    crc = Crc(width, polynomial, init, *reflected, xor_out, given.get("empty"))
    first = place_of(header, given["covers"]["from"], False)
    last = place_of(trailer, given["covers"]["to"], True)
    return Check(
        kind,
        crc,
        first["at"] // 8 if first else bytes_of((one["at"], one["bits"]) for one in header),
        bytes_of([(last["at"], last["bits"])]) if last else 0,
        bool(given.get("seeds")),
    )


def stream_of(node: Node, section: Section, checksums: Section, ids: Ids) -> Stream:
    """What code makes of the section."""
    header, trailer = section.get("header", ()), section.get("trailer", ())
    fields = [field_of(node, row, row_in is trailer) for row_in in (header, trailer) for row in row_in]
    sizes = [bytes_of((row["at"], row["bits"]) for row in rows) for rows in (header, trailer)]
    length, sequence = (place_of((*header, *trailer), role, False) or {} for role in ("length", "sequence"))
    check = place_of((*header, *trailer), "checksum", False) or {}
    seeds = checksums.get(check.get("checksum", ""), {}).get("seeds", {})
    named = {one.message.name: id for id, those in ids.telemetry.items() for one in those}
    replies = {sent: named[came] for sent, came in section.get("replies", {}).items() if came in named}
    counts_all = length.get("counts", DATA) == "message"
    assert all(field.role in ROLES for field in fields)
    return Stream(
        delimited_by=section["delimited_by"],
        header_bytes=sizes[0],
        trailer_bytes=sizes[1],
        length_plus=length.get("plus", 0) + (sum(sizes) if counts_all else 0),
        per_id=sequence.get("per", "link") == "id",
        fields=tuple(fields),
        check=check_of(section, checksums),
        telecommands=rows_of(ids.telecommand, seeds, replies),
        telemetry=rows_of(ids.telemetry, seeds, {}),
    )
