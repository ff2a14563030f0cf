"""Transmitted bytes of a message on UART, I2C and CAN, computed by the Python runtime.

Buses that the ICD does not describe are omitted.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from icdgen_runtime.wire.can import CanMessage, can_split
from icdgen_runtime.wire.errors import TooLongError, UnsupportedError
from icdgen_runtime.wire.i2c import i2c_write
from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.packet_formats import Direction
from icdgen_runtime.wire.stream import stream_encode, stream_encode_request
from icdgen_runtime.wire.uart import uart_encode

from icdgen.backends.html import packet_formats
from icdgen.frozen import NamedTuple
from icdgen.icd.buses import CAN, bus_link
from icdgen.icd.model import Message, buses_of
from icdgen.protocol.facts import Facts
from icdgen.protocol.sections import Can, Framing
from icdgen.wording import count

_SHOWN = 24  # maximum number of shown data bytes


class WireChunk(NamedTuple):
    """Bytes of one meaning as text.

    ``kind`` is frame, id, data, crc or note.
    """

    kind: str
    text: str
    title: str


class WireLine(NamedTuple):
    """Bytes of one transmission."""

    label: str
    chunks: list[WireChunk]


@dataclass
class Bus:
    name: str
    note: str
    lines: list[WireLine]


class Speaker(NamedTuple):
    """Node that uses a message: its facts, the section of its ICD, and its ``LINK``."""

    facts: Facts
    section: dict[str, Any]
    link: Link


class Wire(NamedTuple):
    """Transmission of a message: protocol of the declaring node, and the nodes with a
    checksum.
    """

    facts: Facts
    section: dict[str, Any]
    link: Link
    checked: list[Speaker]


def buses(message: Message, wire: Wire, data: bytes) -> list[Bus]:
    """Return the bytes of the message on each bus.

    ``data``: shown frame.
    """
    results = [
        make(message, wire, data)
        for make in (_packet_bus, _uart_bus, _i2c_bus, _can_bus)
    ]
    return [bus for bus in results if bus is not None]


def page_facts(message: Message, wire: Wire) -> dict[str, object]:
    """Return the data of the decoder of a page: framing, ids and checksums."""
    facts: dict[str, object] = {
        "ids": list(message.ids),
        "id_bits": wire.facts.node.id_bits,
        "id": (
            message.telecommand_id
            if message.telecommand_id is not None
            else message.telemetry_id
        ),
        "command": message.telecommand_id is not None,
        "telemetry": message.telemetry_id,
        "crc": [crc_facts(speaker.facts) for speaker in wire.checked],
    }
    if len(message.layout.lengths) > 1:
        facts["lengths"] = [message.layout.shortest, message.layout.lengths.step]
    facts |= framing_facts(wire.facts)
    if wire.facts.stream:
        facts["stream"] = packet_formats.script_facts(wire.facts.stream, message)
    if wire.facts.can:
        facts["can"] = can_facts(wire.facts.can)
    return facts


def framing_facts(facts: Facts) -> dict[str, object]:
    """Return the framing bytes of the UART with its special features; empty without
    framing.
    """
    framing = facts.framing
    if framing is None:
        return {}
    framing_data: dict[str, object] = {
        "framing": [framing.escape, framing.start, framing.end, framing.escaped]
    }
    if not framing.escapes_id:
        framing_data["plain_id"] = True
    if framing.ignores_other:
        framing_data["ignores_other"] = True
    return framing_data


def can_facts(form: Can) -> dict[str, object]:
    """Return shift and width of the parts of an identifier, types by kind, and
    positions in extended packets.
    """
    can_data: dict[str, object] = {
        "parts": {role: [part.shift, part.bits] for role, part in form.parts.items()},
        "types": form.types,
        "extended_types": form.extended_types,
        "data_bytes": form.data_bytes,
        "node": form.node_address,
    }
    if form.extended:
        extended = form.extended
        can_data["extended"] = [
            extended.data_bytes,
            extended.left_at,
            extended.left_in_last,
            extended.fill,
            extended.bytes,
        ]
    return can_data


def crc_facts(facts: Facts) -> dict[str, object]:
    """Return parameters of the message checksum, its size and byte order, and whether
    it covers the id.
    """
    form = facts.checksum
    assert form is not None
    crc_data = packet_formats.checksum_facts(form.algorithm) | {"bytes": form.bytes}
    flags = {"covers_id": form.covers_id, "little": facts.little and form.bytes > 1}
    return crc_data | {key: True for key, value in flags.items() if value}


def _hex_text(data: bytes) -> str:
    if len(data) <= _SHOWN:
        return data.hex(" ").upper()
    return f"{data[: _SHOWN - 4].hex(' ').upper()} … {data[-4:].hex(' ').upper()}"


def _data_chunks(data: bytes) -> list[WireChunk]:
    return (
        [WireChunk("data", _hex_text(data), f"data, {count(len(data), 'byte')}")]
        if data
        else []
    )


def _checked_speaker(wire: Wire, direction: str, bus: str) -> Speaker | None:
    """Return the node whose checksum is shown for messages of the direction."""
    for speaker in wire.checked:
        form = speaker.facts.checksum
        assert form is not None
        # The first node with a checksum on this bus stands for all.
        if bus in (
            form.telecommand_buses
            if direction == "telecommand"
            else form.telemetry_buses
        ):
            return speaker
    return None


def _crc_chunk(sent: bytes, speaker: Speaker, direction: str, bus: str) -> WireChunk:
    form = speaker.facts.checksum
    assert form is not None
    is_telecommand = direction == "telecommand"
    always = form.telecommand_always if is_telecommand else form.telemetry_always
    text = form.algorithm.name + ("" if bus in always else ", optional")
    return WireChunk("crc", _hex_text(sent), text)


def _packet_bus(message: Message, wire: Wire, data: bytes) -> Bus | None:
    form = wire.facts.stream
    if form is None:
        return None
    lines: list[WireLine] = []
    ids: dict[Direction, int | None] = {
        "telecommand": message.telecommand_id,
        "telemetry": message.telemetry_id,
    }
    for direction, id in ids.items():
        if id is None:
            continue
        if direction == "telemetry" and (
            parts := packet_formats.request_parts(form, wire.link, id)
        ):
            requested = stream_encode_request(wire.link, id)
            lines += _packet_lines("Request", parts, requested)
        parts = packet_formats.packet_parts(form, wire.link, id, direction, data)
        sent = stream_encode(wire.link, id, data, direction)
        lines += _packet_lines(direction.capitalize(), parts, sent)
    return Bus("Packet", f"A packet ends {packet_formats.end_of(form)}.", lines)


def _packet_lines(
    label: str, parts: list[packet_formats.TransmittedPart], sent: bytes
) -> Iterator[WireLine]:
    """Yield a line with the parts of a packet.

    If byte stuffing changed the packet, a second line has the transmitted bytes.
    """
    yield WireLine(
        label,
        [WireChunk(part.kind, _hex_text(part.data), part.title) for part in parts],
    )
    if sent != b"".join(part.data for part in parts):
        yield WireLine(
            "in wire order",
            [WireChunk("data", _hex_text(sent), "stuffed, between delimiters")],
        )


def _uart_bus(message: Message, wire: Wire, data: bytes) -> Bus | None:
    if wire.facts.framing is None:
        return None
    lines = []
    if message.telecommand_id is not None:
        lines.append(
            WireLine(
                "Telecommand", _uart_chunks(wire.link, message.telecommand_id, data)
            )
        )
        lines += _uart_lines_with_crc(wire, "telecommand", message.telecommand_id, data)
    if message.telemetry_id is not None:
        lines.append(
            WireLine("Request", _uart_chunks(wire.link, message.telemetry_id, b""))
        )
        lines.append(
            WireLine("Answer", _uart_chunks(wire.link, message.telemetry_id, data))
        )
        lines += _uart_lines_with_crc(wire, "telemetry", message.telemetry_id, data)
    return Bus(
        "UART",
        _uart_note(buses_of(wire.section)["uart"].get("line", {}), wire.facts.framing),
        lines,
    )


def _uart_lines_with_crc(
    wire: Wire, direction: str, id: int, data: bytes
) -> Iterator[WireLine]:
    checked = _checked_speaker(wire, direction, "uart")
    if checked:
        chunks = _uart_chunks(wire.link, id, data, checked, direction)
        yield WireLine("with CRC", chunks)


def _uart_chunks(
    link: Link,
    id: int,
    data: bytes,
    checked: Speaker | None = None,
    direction: str = "",
) -> list[WireChunk]:
    """Return the transmitted bytes, split at the borders of id, data and checksum."""
    # On the UART, a message has the bytes of an I2C write between the framing bytes.
    body = i2c_write(checked.link if checked else link, id, data, checked is not None)
    line = uart_encode(link, body)
    # Byte stuffing moves the borders. A part ends where the end of message would begin if
    # only the parts up to it were sent. Start and end of message have 2 bytes each.
    ends = [
        2,
        *(
            len(uart_encode(link, body[:size])) - 2
            for size in (1, 1 + len(data), len(body))
        ),
    ]
    start, id_sent, data_sent, check_sent = (
        line[at:to] for at, to in zip([0, *ends], ends, strict=False)
    )
    chunks = [
        WireChunk("frame", _hex_text(start), "start of message"),
        WireChunk("id", _hex_text(id_sent), f"id {id}"),
    ]
    chunks += _data_chunks(data_sent)
    if checked:
        chunks.append(_crc_chunk(check_sent, checked, direction, "uart"))
    return [*chunks, WireChunk("frame", _hex_text(line[ends[-1] :]), "end of message")]


def _uart_note(section: dict[str, Any], framing: Framing) -> str:
    parts = [f"{section['baud_rate']:,} baud"] if "baud_rate" in section else []
    if {"data_bits", "parity", "stop_bits"} <= section.keys():
        parity = section["parity"]
        parts.append(
            f"{section['data_bits']}{'N' if parity == 'none' else parity[0].upper()}{section['stop_bits']}"
        )
    within = "id and data" if framing.escapes_id else "the data"
    doubled = f"{framing.escape:02X} within {within} is sent as {framing.escape:02X} {framing.escaped:02X}"
    return ", ".join(parts) + (". " if parts else "") + doubled + "."


def _i2c_bus(message: Message, wire: Wire, data: bytes) -> Bus | None:
    address = wire.facts.i2c_address
    if address is None:
        return None
    # The first byte has the 7-bit address and, as lowest bit, the direction: 0 to
    # write, 1 to read (UM10204, 3.1.10).
    write = WireChunk("frame", f"{address << 1:02X}", "address, write")
    lines = []
    if message.telecommand_id is not None:
        sent = [write, _id_chunk(message.telecommand_id), *_data_chunks(data)]
        lines.append(WireLine("Telecommand", sent))
        lines += _lines_with_crc(
            wire, "telecommand", message.telecommand_id, data, sent
        )
    if message.telemetry_id is not None:
        how = "repeated start" if wire.facts.i2c_repeated_start else "stop and start"
        restart = WireChunk(
            "note",
            how,
            " or ".join(buses_of(wire.section)["i2c"].get("telemetry_request", [])),
        )
        read = WireChunk("frame", f"{address << 1 | 1:02X}", "address, read")
        answer = [
            write,
            _id_chunk(message.telemetry_id),
            restart,
            read,
            *_data_chunks(data),
        ]
        lines.append(WireLine("Request and answer", answer))
        lines += _lines_with_crc(wire, "telemetry", message.telemetry_id, data, answer)
    return Bus("I²C", f"7-bit address {address:02X}.", lines)


def _id_chunk(id: int) -> WireChunk:
    return WireChunk("id", f"{id:02X}", f"id {id}")


def _lines_with_crc(
    wire: Wire, direction: str, id: int, data: bytes, sent: list[WireChunk]
) -> Iterator[WireLine]:
    checked = _checked_speaker(wire, direction, "i2c")
    if checked:
        checked_bytes = i2c_write(checked.link, id, data, True)
        yield WireLine(
            "with CRC",
            [
                *sent,
                _crc_chunk(checked_bytes[1 + len(data) :], checked, direction, "i2c"),
            ],
        )


def _can_bus(message: Message, wire: Wire, data: bytes) -> Bus | None:
    form = wire.facts.can
    if form is None:
        return None
    node = form.node_address
    lines: list[WireLine] = []
    if message.telecommand_id is not None:
        sent = CanMessage("telecommand", message.telecommand_id, 0, node, data)
        lines += _can_lines(wire, form, sent, "Telecommand")
    if message.telemetry_id is not None:
        lines += _can_lines(
            wire, form, CanMessage("request", message.telemetry_id, 0, node), "Request"
        )
        lines += _can_lines(
            wire,
            form,
            CanMessage("reply", message.telemetry_id, node, 0, data),
            "Answer",
        )
    bits = sum(part.bits for part in form.parts.values())
    note = f"{bits}-bit identifiers. Your own address stands as 0: put it in its place."
    return Bus("CAN", note, lines) if lines else None


def _can_lines(
    wire: Wire, form: Can, message: CanMessage, label: str
) -> Iterator[WireLine]:
    """Yield one packet, or the extended packets of a long message; of many, the first
    two and the last.
    """
    try:
        packets = can_split(wire.link, message)
    # Such a message cannot be sent on CAN; the other buses show it.
    except (TooLongError, UnsupportedError):
        return
    if len(packets) == 1 and len(message.data) <= form.data_bytes:
        yield WireLine(
            label,
            [
                _identifier_chunk(wire, form, packets[0].id),
                *_data_chunks(packets[0].data),
            ],
        )
        return
    assert form.extended is not None
    for index, packet in enumerate(packets):
        if 2 <= index < len(packets) - 1:
            if index == 2:
                yield WireLine(
                    "",
                    [
                        WireChunk(
                            "note", f"… {count(len(packets) - 3, 'more packet')}", ""
                        )
                    ],
                )
            continue
        left_at = form.extended.left_at
        left = WireChunk("crc", _hex_text(packet.data[left_at:]), "packets left")
        chunks = [
            _identifier_chunk(wire, form, packet.id),
            *_data_chunks(packet.data[:left_at]),
            left,
        ]
        yield WireLine(f"{label} {index + 1}/{len(packets)}", chunks)


def _identifier_chunk(wire: Wire, form: Can, id: int) -> WireChunk:
    parts = {
        role: id >> part.shift & (1 << part.bits) - 1
        for role, part in form.parts.items()
    }
    packets = bus_link(wire.section["link"], CAN).packets.all
    name = next(
        packet.name for packet in packets if packet.section.get("type") == parts["type"]
    )
    addressing = f"channel {parts['channel']}, source {parts['source']}, destination {parts['destination']}"
    bits = sum(part.bits for part in form.parts.values())
    return WireChunk(
        "id", f"{id:0{(bits + 3) // 4}X}", f"{name}: type {parts['type']}, {addressing}"
    )
