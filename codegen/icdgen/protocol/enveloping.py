"""Reader of the `stream` section of a checked ICD, into the classes of
`icdgen.protocol.envelope`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from icdgen.icd.model import Node
from icdgen.icd.places import raw_fields_in
from icdgen.icd.variants import Ids, Variant
from icdgen.protocol.envelope import (
    DATA,
    DIRECTIONS,
    ROLES,
    Check,
    EnvelopeField,
    Stream,
    StreamRow,
)
from icdgen.protocol.exchange import Exchange
from icdgen.protocol.responding import exchange_of
from icdgen.protocol.sections import Crc

Section = Mapping[str, Any]


def bytes_of(bits: Iterable[tuple[int, int]]) -> int:
    """Return the number of bytes up to the end of the last field.

    ``bits``: position and width of each field in bits.
    """
    return -(-max((at + width for at, width in bits), default=0) // 8)


def field_of(node: Node, row: Section, in_trailer: bool) -> EnvelopeField:
    """Return the field of a row of the header or trailer."""
    at, bits = row["at"], row["bits"]
    first, last = at // 8, (at + bits - 1) // 8
    # Bits count from the first byte on. For msb0, bit 0 is the most significant bit of
    # that byte.
    shift = at % 8 if node.bit_order != "msb0" else (last + 1) * 8 - at - bits
    little = row.get("byte_order", node.byte_order) == "little"
    role = "constant" if row["role"] == "sync" else row["role"]
    size = last - first + 1
    return EnvelopeField(
        role, in_trailer, first, size, shift, bits, little, values_of(row, little)
    )


def values_of(row: Section, little: bool) -> tuple[int, int]:
    """Return the values of a row in both directions.

    A list of bytes is in sending order.
    """
    value = row.get("value", 0)
    sent, received = (
        value.get(direction, 0) if isinstance(value, Mapping) else value
        for direction in DIRECTIONS
    )
    return _number(sent, little), _number(received, little)


def _number(value: Any, little: bool) -> int:
    return (
        int.from_bytes(bytes(value), "little" if little else "big")
        if isinstance(value, list)
        else value
    )


def rows_of(
    ids: Mapping[int, tuple[Variant, ...]],
    seeds: Mapping[str, int],
    exchanges: Mapping[str, Exchange],
) -> tuple[StreamRow, ...]:
    """Return the messages of a direction.

    ``exchanges``: exchanges of telecommands, by name. Messages that share an id form
    one row; rules ICD174 and ICD178 ensure that they agree in the packet format and in
    their responses.
    """
    rows = []
    for id, variants in sorted(ids.items()):
        messages = [variant.message for variant in variants]
        first, name = messages[0], " or ".join(message.name for message in messages)
        exchange = next(
            (exchanges[each.name] for each in messages if each.name in exchanges), None
        )
        is_blank = not first.layout.shortest or not raw_fields_in(first.layout)
        rows.append(
            StreamRow(
                id,
                min(message.layout.shortest for message in messages),
                max(message.length for message in messages),
                bool(first.may_end_early),
                seeds.get(first.name, 0),
                name,
                exchange,
                all(message.repeat for message in messages),
                exchange.reply if exchange and is_blank else None,
            )
        )
    return tuple(rows)


def place_of(rows: Iterable[Section], name: str, last: bool) -> Section | None:
    """Return the first or last row of a role; None without such a row."""
    matches = [row for row in rows if row.get("role") == name]
    return matches[-1 if last else 0] if matches else None


def check_of(section: Section, checksums: Section) -> Check | None:
    """Return the checksum that a checksum row refers to."""
    header, trailer = section.get("header", ()), section.get("trailer", ())
    row = place_of((*header, *trailer), "checksum", False)
    declaration = checksums.get(row.get("checksum", "")) if row else None
    if not declaration:
        return None
    kind = declaration["kind"]
    width, polynomial, init, xor_out = (
        declaration.get(key, 0) for key in ("width", "polynomial", "init", "xor_out")
    )
    reflected = declaration.get("reflect_in", False), declaration.get(
        "reflect_out", False
    )
    crc = Crc(width, polynomial, init, *reflected, xor_out, declaration.get("empty"))
    first = place_of(header, declaration["covers"]["from"], False)
    last = place_of(trailer, declaration["covers"]["to"], True)
    return Check(
        kind,
        crc,
        (
            first["at"] // 8
            if first
            else bytes_of((row["at"], row["bits"]) for row in header)
        ),
        bytes_of([(last["at"], last["bits"])]) if last else 0,
        bool(declaration.get("seeds")),
    )


def stream_of(node: Node, section: Section, checksums: Section, ids: Ids) -> Stream:
    """Return the packet format of a `stream` section."""
    header, trailer = section.get("header", ()), section.get("trailer", ())
    fields = [
        field_of(node, row, row_in is trailer)
        for row_in in (header, trailer)
        for row in row_in
    ]
    sizes = [
        bytes_of((row["at"], row["bits"]) for row in rows) for rows in (header, trailer)
    ]
    # At most one field has each of these roles (checked by rules of the ICD).
    length, sequence = (
        place_of((*header, *trailer), role, False) or {}
        for role in ("length", "sequence")
    )
    check = place_of((*header, *trailer), "checksum", False) or {}
    seeds = checksums.get(check.get("checksum", ""), {}).get("seeds", {})
    telemetry = {
        variant.message.name: (id, variant.message)
        for id, variants in ids.telemetry.items()
        for variant in variants
    }
    commands = section.get("commands", {})
    exchanges = {
        variant.message.name: exchange
        for variants in ids.telecommand.values()
        for variant in variants
        if (exchange := exchange_of(node, commands, variant.message, telemetry.get))
    }
    # `counts: message` includes header and trailer in the length field.
    counts_all = length.get("counts", DATA) == "message"
    assert all(field.role in ROLES for field in fields)
    return Stream(
        delimited_by=section["delimited_by"],
        header_bytes=sizes[0],
        trailer_bytes=sizes[1],
        # `plus`: the device's own offset, for example CCSDS 133.0-B: bytes minus 1.
        length_plus=length.get("plus", 0) + (sum(sizes) if counts_all else 0),
        per_id=sequence.get("per", "link") == "id",
        fields=tuple(fields),
        check=check_of(section, checksums),
        telecommands=rows_of(ids.telecommand, seeds, exchanges),
        telemetry=rows_of(ids.telemetry, seeds, {}),
    )
