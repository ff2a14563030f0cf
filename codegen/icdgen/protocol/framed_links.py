"""Reader of the `link` section of a checked ICD, into the classes of
`icdgen.protocol.packet_formats`.

`stream_of` is the entry: it reads the packet formats and then the messages of both
directions with their packet, their checksum and their responses. `packet_format_of`
also serves the packets that respond on buses.
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


def bytes_of(fields: Iterable[Section]) -> int:
    """Return the number of bytes up to the end of the last field."""
    return -(-max((field["at"] + field["bits"] for field in fields), default=0) // 8)


def field_of(
    node: Node,
    declared: Section,
    in_trailer: bool,
    id_shift: int = 0,
    overhead: int = 0,
) -> PacketField:
    """Return a field of the header or trailer, from its mapping in the ICD.

    ``id_shift``: number of bits of the id below the part that this field has.
    ``overhead``: bytes of header and trailer.
    """
    at, bits = declared["at"], declared["bits"]
    first, last = at // 8, (at + bits - 1) // 8
    # Bits count from the first byte on. For msb0, bit 0 is the most significant bit of
    # that byte.
    shift = at % 8 if node.bit_order != "msb0" else (last + 1) * 8 - at - bits
    little = declared.get("byte_order", node.byte_order) == "little"
    unit = declared.get("unit", 1)
    # `plus` of the ICD is the device's own offset in units: -1 in CCSDS 133.0-B, where
    # the field has the number of bytes minus 1. `counts: message` includes header and
    # trailer. `PacketField.plus` is the sum in bytes.
    counts_message = declared.get("counts", DATA) == "message"
    plus = declared.get("plus", 0) * unit + (overhead if counts_message else 0)
    return PacketField(
        role="constant" if declared["role"] == "sync" else declared["role"],
        in_trailer=in_trailer,
        at=first,
        size=last - first + 1,
        shift=shift,
        bits=bits,
        little=little,
        values=(
            value_of(declared, TELECOMMAND, little),
            value_of(declared, TELEMETRY, little),
        ),
        id_shift=id_shift,
        unit=unit,
        plus=plus,
    )


def messages_of_direction(
    ids: Mapping[int, tuple[Variant, ...]],
    direction: str,
    packets: Packets,
    checksums: Checksums,
    exchanges: Mapping[str, Exchange],
    requestable_ids: Container[int] = (),
) -> tuple[StreamRow, ...]:
    """Return the messages of a direction.

    ``exchanges``: exchanges of telecommands, by name. ``requestable_ids``: ids of the
    telemetry that the packet of `Stream.request` can request. Messages that share an id
    form one row with the packet format, checksum seed and `may_end_early` of the first.
    Rule ICD174 ensures that they have the same of each, rule ICD178 that telecommands
    have the same responses.
    """
    rows = []
    for id, variants in sorted(ids.items()):
        messages = [variant.message for variant in variants]
        first = messages[0]
        exchange = next(
            (exchanges[each.name] for each in messages if each.name in exchanges), None
        )
        # A telecommand that can be sent as zero bytes can request its reply: it can
        # have no data, or has no field. (A constant is a field, too.)
        is_all_zeros = not first.layout.shortest or not raw_fields_in(first.layout)
        packet, *_ = packets.packets_of_message(first.name, direction)
        algorithm = algorithm_of(packet, checksums)
        rows.append(
            StreamRow(
                id=id,
                least=min(message.layout.shortest for message in messages),
                most=max(message.length for message in messages),
                cuts_zeros=bool(first.may_end_early),
                seed=algorithm.seeds.get(first.name, 0) if algorithm else 0,
                name=" or ".join(message.name for message in messages),
                exchange=exchange,
                repeats=all(message.repeat for message in messages),
                requests=exchange.reply if exchange and is_all_zeros else None,
                packet=packets.all.index(packet),
                is_requested=id in requestable_ids,
            )
        )
    return tuple(rows)


def _fields_named(fields: Iterable[Section], name: str) -> list[Section]:
    """Return the fields with a role or name."""
    return [field for field in fields if name in (field.get("role"), field.get("name"))]


def algorithm_of(packet: Packet, checksums: Checksums) -> ChecksumAlgorithm | None:
    """Return the algorithm of the checksum of a packet; None without one."""
    return next(
        (checksums[field["checksum"]] for field in packet.fields_of_role("checksum")),
        None,
    )


def check_of(packet: Packet, checksums: Checksums) -> Check | None:
    """Return the checksum of a packet; None without one."""
    field = next(iter(packet.fields_of_role("checksum")), None)
    if field is None:
        return None
    algorithm, covers = checksums[field["checksum"]], field["covers"]
    # Empty if `covers` names the data, which are between header and trailer.
    first = _fields_named(packet.header, covers["from"])[:1]
    last = _fields_named(packet.trailer, covers["to"])[-1:]
    return Check(
        algorithm=algorithm,
        covered_from=first[0]["at"] // 8 if first else bytes_of(packet.header),
        covered_trailer=bytes_of(last),
        is_seeded=bool(algorithm.seeds),
    )


def packet_format_of(
    node: Node, packets: Packets, packet: Packet, checksums: Checksums
) -> PacketFormat:
    """Return the format of a packet, with its fields, its content and its checksum."""
    header_bytes, trailer_bytes = bytes_of(packet.header), bytes_of(packet.trailer)
    overhead = header_bytes + trailer_bytes
    # By identity: mappings have no hash, and two fields can be equal.
    shifts = {id(declared): shift for declared, shift in id_shifts(packet.rows)}
    fields = tuple(
        field_of(node, declared, in_trailer, shifts.get(id(declared), 0), overhead)
        for in_trailer, part in ((False, packet.header), (True, packet.trailer))
        for declared in part
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
        header_bytes=header_bytes,
        trailer_bytes=trailer_bytes,
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
    telecommand_messages, telemetry_messages = (
        [variant.message for variants in of_id.values() for variant in variants]
        for of_id in (ids.telecommand, ids.telemetry)
    )
    packets = declared_packets(section, telecommand_messages)
    telemetry_by_name = {
        message.name: (message.telemetry_id, message)
        for message in telemetry_messages
        if message.telemetry_id is not None
    }
    formats = tuple(
        packet_format_of(node, packets, packet, checksums) for packet in packets.all
    )
    sources = Sources(node, packets, formats, enums, telemetry_by_name)
    commands = section.get("commands", {})
    exchanges = {
        message.name: exchange
        for message in telecommand_messages
        if (exchange := exchange_of(sources, commands, message))
    }
    sequences = [
        field for packet in packets.all for field in packet.fields_of_role("sequence")
    ]
    telecommands = messages_of_direction(
        ids.telecommand, TELECOMMAND, packets, checksums, exchanges
    )
    request, request_packet = None, packets.number_of(packets.requesting)
    if request_packet is not None:
        exchange = request_exchange(sources, section["requests"])
        request = TelemetryRequest(request_packet, exchange)
    # Built first without telemetry, because `Stream.confirming` is needed to find the
    # telemetry that can be requested. It uses only the telecommands and the request.
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
    excluded_ids = {row.requests for row in telecommands if row.requests is not None}
    excluded_ids |= {*stream.confirming}
    requestable_ids = set()
    for id, variants in ids.telemetry.items():
        messages = [variant.message for variant in variants]
        if all(
            is_requested(packets, message, ids.telecommand, excluded_ids)
            for message in messages
        ):
            requestable_ids.add(id)
    telemetry = messages_of_direction(
        ids.telemetry, TELEMETRY, packets, checksums, {}, requestable_ids
    )
    return replace(stream, telemetry=telemetry)
