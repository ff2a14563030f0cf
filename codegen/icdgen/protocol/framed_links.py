"""Reader of the `link` section of a checked ICD, into the classes of
`icdgen.protocol.packet_formats`.

`stream_of` is the entry: it reads the packet formats and then the messages of both
directions with their packet, their checksum and their responses.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import replace
from typing import Any

from icdgen.icd.enumeration import Enum
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Node
from icdgen.icd.packets import (
    Packet,
    Packets,
    declared_packets,
    id_shifts,
    is_requested,
    value_of,
)
from icdgen.icd.places import raw_fields_in
from icdgen.icd.variants import Ids, Variant
from icdgen.protocol.exchange import Exchange
from icdgen.protocol.packet_formats import (
    DATA,
    ESCAPE,
    MESSAGE,
    NOTHING,
    REQUEST,
    REQUESTED,
    ROLES,
    Check,
    Escaping,
    PacketField,
    PacketFormat,
    Stream,
    StreamRow,
    TelemetryRequest,
)
from icdgen.protocol.responding import Sources, exchange_of, request_exchange
from icdgen.protocol.sections import ChecksumAlgorithm

Section = Mapping[str, Any]
Checksums = Mapping[str, ChecksumAlgorithm]


def bytes_of(rows: Iterable[Section]) -> int:
    """Return the number of bytes up to the end of the last field."""
    return -(-max((row["at"] + row["bits"] for row in rows), default=0) // 8)


def field_of(
    node: Node, row: Section, in_trailer: bool, id_shift: int = 0, overhead: int = 0
) -> PacketField:
    """Return the field of a row of the header or trailer.

    ``id_shift``: position in the id of the lowest bit that this field has.
    ``overhead``: bytes of header and trailer.
    """
    at, bits = row["at"], row["bits"]
    first, last = at // 8, (at + bits - 1) // 8
    # Bits count from the first byte on. For msb0, bit 0 is the most significant bit of
    # that byte.
    shift = at % 8 if node.bit_order != "msb0" else (last + 1) * 8 - at - bits
    little = row.get("byte_order", node.byte_order) == "little"
    role = "constant" if row["role"] == "sync" else row["role"]
    size, unit = last - first + 1, row.get("unit", 1)
    # `plus` is the device's own offset, for example CCSDS 133.0-B: bytes minus 1.
    # `counts: message` includes header and trailer.
    counts_all = row.get("counts", DATA) == "message"
    plus = row.get("plus", 0) * unit + (overhead if counts_all else 0)
    return PacketField(
        role,
        in_trailer,
        first,
        size,
        shift,
        bits,
        little,
        (value_of(row, TELECOMMAND, little), value_of(row, TELEMETRY, little)),
        id_shift,
        unit,
        plus,
    )


def rows_of(
    ids: Mapping[int, tuple[Variant, ...]],
    direction: str,
    packets: Packets,
    checksums: Checksums,
    exchanges: Mapping[str, Exchange],
    requested: Container[int] = (),
) -> tuple[StreamRow, ...]:
    """Return the messages of a direction.

    ``exchanges``: exchanges of telecommands, by name. ``requested``: ids of telemetry
    that the packet of `Stream.request` requests. Messages that share an id form one
    row; rules ICD174 and ICD178 ensure that they agree in the packet format and in
    their responses.
    """
    rows = []
    for id, variants in sorted(ids.items()):
        messages = [variant.message for variant in variants]
        first, name = messages[0], " or ".join(message.name for message in messages)
        exchange = next(
            (exchanges[each.name] for each in messages if each.name in exchanges), None
        )
        # A message without values that a user could choose can request its reply.
        is_blank = not first.layout.shortest or not raw_fields_in(first.layout)
        packet, *_ = packets.packets_of_message(first.name, direction)
        algorithm = algorithm_of(packet, checksums)
        rows.append(
            StreamRow(
                id,
                min(message.layout.shortest for message in messages),
                max(message.length for message in messages),
                bool(first.may_end_early),
                algorithm.seeds.get(first.name, 0) if algorithm else 0,
                name,
                exchange,
                all(message.repeat for message in messages),
                exchange.reply if exchange and is_blank else None,
                packets.all.index(packet),
                id in requested,
            )
        )
    return tuple(rows)


def _covered(rows: Iterable[Section], name: str, last: bool) -> Section | None:
    """Return the first or last row with a role or name; None without such a row."""
    matches = [row for row in rows if name in (row.get("role"), row.get("name"))]
    return matches[-1 if last else 0] if matches else None


def algorithm_of(packet: Packet, checksums: Checksums) -> ChecksumAlgorithm | None:
    """Return the algorithm of the checksum of a packet; None without one."""
    return next(
        (checksums[row["checksum"]] for row in packet.fields_of_role("checksum")), None
    )


def check_of(packet: Packet, checksums: Checksums) -> Check | None:
    """Return the checksum of a packet; None without one."""
    for field in packet.fields_of_role("checksum"):
        algorithm, covers = checksums[field["checksum"]], field["covers"]
        first = _covered(packet.header, covers["from"], False)
        last = _covered(packet.trailer, covers["to"], True)
        covered_from = first["at"] // 8 if first else bytes_of(packet.header)
        covered_trailer = bytes_of([last]) if last else 0
        return Check(algorithm, covered_from, covered_trailer, bool(algorithm.seeds))
    return None


def packet_of(
    node: Node, packets: Packets, packet: Packet, checksums: Checksums
) -> PacketFormat:
    """Return a packet format."""
    sizes = [bytes_of(packet.header), bytes_of(packet.trailer)]
    # By identity: mappings have no hash, and two rows can be equal.
    shifts = {id(row): shift for row, shift in id_shifts(packet.rows)}
    fields = tuple(
        field_of(node, row, in_trailer, shifts.get(id(row), 0), sum(sizes))
        for in_trailer, rows in ((False, packet.header), (True, packet.trailer))
        for row in rows
    )
    assert all(field.role in ROLES for field in fields)
    content = MESSAGE
    if packet.name in packets.responding:
        content = NOTHING
    elif packets.answering is not None and packet.name == packets.answering:
        content = REQUESTED
    elif packets.only_requests(packet):
        content = REQUEST
    return PacketFormat(
        name=packet.name,
        directions=packet.directions,
        content=content,
        header_bytes=sizes[0],
        trailer_bytes=sizes[1],
        reserved=packets.reserved_in(packet),
        fields=fields,
        check=check_of(packet, checksums),
    )


def escaping_of(framing: Section) -> Escaping | None:
    """Return the escape characters of a link; None if another delimiter is used."""
    if framing["by"] != ESCAPE:
        return None
    # The default of `data` is the usual DLE framing, which doubles the escape byte.
    return Escaping(
        escape=framing["escape"],
        end=framing["end"],
        data=framing.get("data", framing["escape"]),
        start=framing.get("start"),
        ignores_other=framing.get("other") == "ignore",
    )


def stream_of(
    node: Node,
    section: Section,
    checksums: Checksums,
    ids: Ids,
    enums: Mapping[str, Enum],
) -> Stream:
    """Return the packet formats and messages of a `link` section.

    ``checksums`` and ``enums``: checksum algorithms and enumerations of the node, by
    name.
    """
    sent, received = (
        [variant.message for variants in of_id.values() for variant in variants]
        for of_id in (ids.telecommand, ids.telemetry)
    )
    packets = declared_packets(section, sent)
    telemetry = {
        message.name: (message.telemetry_id, message)
        for message in received
        if message.telemetry_id is not None
    }
    formats = tuple(
        packet_of(node, packets, packet, checksums) for packet in packets.all
    )
    sources = Sources(node, packets, formats, enums, telemetry)
    commands = section.get("commands", {})
    exchanges = {
        message.name: exchange
        for message in sent
        if (exchange := exchange_of(sources, commands, message))
    }
    sequences = [
        row for packet in packets.all for row in packet.fields_of_role("sequence")
    ]
    telecommands = rows_of(ids.telecommand, TELECOMMAND, packets, checksums, exchanges)
    request, requesting = None, packets.number_of(packets.requesting)
    if requesting is not None:
        exchange = request_exchange(sources, section["requests"])
        request = TelemetryRequest(requesting, exchange)
    # Without its telemetry for now: `confirming`, on which the requested telemetry
    # depends, uses only the telecommands and the request.
    stream = Stream(
        delimited_by=section["framing"]["by"],
        per_id=bool(sequences) and sequences[0].get("per") == "id",
        packets=formats,
        telecommands=telecommands,
        telemetry=(),
        request=request,
        escaping=escaping_of(section["framing"]),
    )
    # Telemetry that a telecommand requests, or that only responds, is not requested by
    # the packet.
    unrequested = {row.requests for row in telecommands if row.requests is not None}
    unrequested |= {*stream.confirming}
    requested = set()
    for id, variants in ids.telemetry.items():
        messages = [variant.message for variant in variants]
        if all(
            is_requested(packets, message, ids.telecommand, unrequested)
            for message in messages
        ):
            requested.add(id)
    rows_of_telemetry = rows_of(
        ids.telemetry, TELEMETRY, packets, checksums, {}, requested
    )
    return replace(stream, telemetry=rows_of_telemetry)
