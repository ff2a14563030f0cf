"""Packet format of a link on the pages: its fields, the bytes that it adds to a
message, and data for scripts.

Fields are shown as the ICD declares them; bytes are computed by the Python runtime. The
scripts of the site decode packets by the data of `script_facts`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, replace
from typing import Any

from icdgen_runtime.wire.link import Link
from icdgen_runtime.wire.packet_formats import Direction
from icdgen_runtime.wire.stream import stream_encode, stream_encode_request

from icdgen.describe.ids import pair_bytes
from icdgen.describe.numbers import bit_range
from icdgen.frozen import NamedTuple
from icdgen.icd.model import Message
from icdgen.icd.packets import Packet, id_shifts
from icdgen.protocol.exchange import NumberPlace, Response
from icdgen.protocol.packet_formats import (
    COBS,
    CRC,
    DATA,
    DATAGRAM,
    DIRECTIONS,
    GIVEN,
    HDLC,
    LENGTH,
    NOTHING,
    REQUEST,
    SLIP,
    Check,
    PacketField,
    PacketFormat,
    Stream,
)
from icdgen.protocol.sections import ChecksumAlgorithm
from icdgen.wording import count

Section = Mapping[str, Any]

ENDS = {
    LENGTH: "where its length says",
    SLIP: "at the byte C0: in the message C0 is sent as DB DC, and DB as DB DD (SLIP, RFC 1055)",
    HDLC: "at the byte 7E: in the message 7E is sent as 7D 5E, and 7D as 7D 5D (HDLC, RFC 1662)",
    COBS: "at the byte 00; zeros in the message are stuffed (COBS)",
    DATAGRAM: "with the packet that carries it",
}


def end_of(form: Stream) -> str:
    """Return where a message ends, as a part of a sentence."""
    escaping = form.escaping
    if escaping is None:
        return ENDS[form.delimited_by]
    escape, end, data = (
        f"{byte:02X}" for byte in (escaping.escape, escaping.end, escaping.data)
    )
    start = escaping.start
    begin = "its first byte" if start is None else f"{start:02X}"
    return f"at the bytes {escape} {end}, and begins with {escape} and {begin}; in between, {escape} is sent as {escape} {data}"


_ROLES = {
    "sync": "begins a message",
    "constant": "is always the same",
    "id": "identifies the message",
    "length": "says how long it is",
    "response_length": "says how long the requested telemetry is",
    "sequence": "counts messages",
    "source": "says who sends",
    "destination": "says whom it is for",
    "status": "says whether it succeeded",
    "reason": "says why it was refused",
    "checksum": "shows damage",
}
# Attributes of a field that the decoder in JavaScript reads.
_FIELD_KEYS = ("role", "in_trailer", "at", "size", "shift", "bits", "little", "values")


class FormatField(NamedTuple):
    """Field of the packet format: role, position, purpose and value."""

    role: str
    place: str
    about: str
    value: str
    url: str = ""  # of the enumeration of its values
    name: str = ""


def script_facts(
    form: Stream, message: Message | None = None, with_responses: bool = False
) -> dict[str, object]:
    """Return the data on the packet formats for scripts.

    ``message``: include only rows of this message. ``with_responses``: include the
    meaning of packets without a message.
    """
    # A message page contains only its own rows, which keeps it small.
    ids: dict[str, set[int | None]] | None = None
    if message is not None:
        ids = {
            "telecommand": {message.telecommand_id},
            "telemetry": {message.telemetry_id},
        }
    # The length of other messages shows where packets without a length field end.
    unmeasured = [
        index
        for index, packet in enumerate(form.packets)
        if form.delimited_by == LENGTH and not packet.of("length")
    ]
    script_data: dict[str, object] = {
        "delimited_by": form.delimited_by,
        "longest": form.longest,
        "given": GIVEN,
        "packets": [_packet_data(packet) for packet in form.packets],
    }
    if form.escaping:
        script_data["escaping"] = {
            key: value
            for key, value in asdict(form.escaping).items()
            if value is not None
        }
    if size := pair_bytes(form):
        script_data["id_pairs"] = size
    for direction in DIRECTIONS:
        script_data[direction] = [
            [row.id, row.least, row.most, row.seed, row.packet]
            for row in form.rows(direction)
            if ids is None or row.id in ids[direction] or row.packet in unmeasured
        ]
    if form.request:
        requested = [row.id for row in form.telemetry if row.is_requested]
        script_data["request"] = {
            "packet": form.request.packet,
            "ids": [id for id in requested if ids is None or id in ids["telemetry"]],
        }
    responses = list(_response_data(form))
    if responses and with_responses:
        script_data["responses"] = responses
    return script_data


def _packet_data(packet: PacketFormat) -> dict[str, object]:
    """Return the data on a packet format for scripts."""
    packet_data: dict[str, object] = {
        "name": packet.name,
        "directions": packet.directions,
        "content": packet.content,
        "reserved": packet.reserved,
        "header": packet.header_bytes,
        "trailer": packet.trailer_bytes,
        "fields": [_field_data(field) for field in packet.fields],
    }
    if packet.check:
        packet_data["check"] = _check_data(packet.check)
    return packet_data


def _field_data(field: PacketField) -> dict[str, object]:
    # Left out if they have no effect: the index of frames is loaded by every page.
    defaults = {"id_shift": 0, "unit": 1, "plus": 0}
    own = {name: getattr(field, name) for name in defaults}
    more = {name: value for name, value in own.items() if value != defaults[name]}
    return {**{name: getattr(field, name) for name in _FIELD_KEYS}, **more}


def _check_data(check: Check) -> dict[str, object]:
    places = {
        "from": check.covered_from,
        "trailer": check.covered_trailer,
        "seeded": check.is_seeded,
    }
    return {**checksum_facts(check.algorithm), **places}


def _response_data(form: Stream) -> Iterator[dict[str, object]]:
    """Yield what each packet without a message says about which messages: the verdict,
    and where status and reason are in the frame.
    """
    ids: dict[Response, dict[str, list[int]]] = {}
    for direction in ("telemetry", "telecommand"):
        for row in form.rows(direction):
            exchange = form.exchange_of(row)
            for response in exchange.responses if exchange else ():
                if response.packet is not None:
                    # Responses that differ only in their echoes are equal for a reader.
                    about = ids.setdefault(replace(response, echoes=()), {})
                    about.setdefault(direction, []).append(row.id)
    for response, about in ids.items():
        response_data: dict[str, object] = {
            "packet": response.packet,
            "verdict": response.verdict,
            "about": about,
        }
        if response.status:
            response_data["status"] = _place_data(response.status)
            response_data["meanings"] = response.meanings
        if response.reason:
            response_data["reason"] = _place_data(response.reason)
            response_data["names"] = response.reasons
        yield response_data


def _place_data(place: NumberPlace) -> list[object]:
    return [place.at, place.size, place.shift, place.bits, place.little]


def checksum_facts(algorithm: ChecksumAlgorithm) -> dict[str, object]:
    """Return kind and parameters for scripts. A CRC has no kind there."""
    numbers = {
        k: value for k, value in asdict(algorithm.crc).items() if value is not None
    }
    return numbers if algorithm.kind == CRC else {"kind": algorithm.kind, **numbers}


def packet_boxes(
    packet: Packet, form: PacketFormat
) -> list[tuple[str, str, float, str]]:
    """Return text, subtitle, share of the width, and bit number of each field and of
    the data.
    """
    data = [("data", "", 3.0, "")]
    # Such packets carry no message, only zeros if they have data at all.
    if form.content in (REQUEST, NOTHING):
        size = count(form.reserved, "byte")
        data = [("reserved", size, 3.0, "")] if form.reserved else []
    return [*_field_boxes(packet.header), *data, *_field_boxes(packet.trailer)]


def _field_boxes(rows: Iterable[Section]) -> Iterator[tuple[str, str, float, str]]:
    for row in sorted(rows, key=lambda row: int(row["at"])):
        # The minimum width leaves room for the name of the role.
        yield (
            row["role"],
            f"{row['bits']} bits",
            max(1.0, row["bits"] / 16),
            f"{row['at']}",
        )


def format_fields(packet: Packet, enum_urls: Mapping[str, str]) -> list[FormatField]:
    """Return each field, in order.

    ``enum_urls``: links to the enumerations, by name.
    """
    id_parts = dict(_id_parts(packet))
    fields = []
    for part, rows in (("header", packet.header), ("trailer", packet.trailer)):
        for row in sorted(rows, key=lambda row: int(row["at"])):
            fields.append(
                FormatField(
                    row["role"],
                    f"{part}, {bit_range(row['at'], row['bits'])}",
                    _purpose_text(row) + id_parts.get(id(row), ""),
                    _value_text(row),
                    enum_urls.get(row.get("enum", ""), ""),
                    row.get("name", ""),
                )
            )
    return fields


def _id_parts(packet: Packet) -> Iterator[tuple[int, str]]:
    """Yield the identity of each field of the id, and which bits of the id it has; none
    if the id is one field.
    """
    parts = list(id_shifts(packet.rows))
    for row, shift in parts if len(parts) > 1 else ():
        yield id(row), f": {bit_range(shift, row['bits'])} of its id"


def _purpose_text(row: Section) -> str:
    about = _ROLES.get(row["role"], "is the sender's choice")
    if row["role"] == "length":
        about += (
            ": of header, data and trailer"
            if row.get("counts") == "message"
            else ": of the data"
        )
        about += _unit_text(row)
        about += (
            f", {'+' if row['plus'] > 0 else '−'} {abs(row['plus'])}"
            if row.get("plus")
            else ""
        )
    if row["role"] == "response_length":
        about += _unit_text(row)
    if row["role"] == "sequence" and row.get("per") == "id":
        about += " of each id"
    return about + (f", {row['byte_order']} endian" if "byte_order" in row else "")


def _unit_text(row: Section) -> str:
    unit = row.get("unit", 1)
    return f", in units of {unit} bytes" if unit > 1 else ""


def _value_text(row: Section) -> str:
    if row["role"] == "checksum":
        return f"{row['checksum']}, {_covered(row['covers'])}"
    if "enum" in row:
        return str(row["enum"])
    value = row.get("value")
    if isinstance(value, Mapping):
        return ", ".join(
            f"{_number_text(number)} in {direction}{'s' * (direction == 'telecommand')}"
            for direction, number in value.items()
        )
    return "" if value is None else _number_text(value)


def _number_text(value: int | list[int]) -> str:
    return (
        " ".join(f"{byte:02X}" for byte in value)
        if isinstance(value, list)
        else f"{value} (0x{value:X})"
    )


def _covered(covers: Mapping[str, str]) -> str:
    first, last = covers["from"], covers["to"]
    return f"the {DATA}" if first == last == DATA else f"from the {first} to the {last}"


class TransmittedPart(NamedTuple):
    """Transmitted bytes with their meaning."""

    kind: str
    data: bytes
    title: str


def packet_parts(
    form: Stream, link: Link, id: int, direction: Direction, data: bytes
) -> list[TransmittedPart]:
    """Return the parts of a message in its packet format, before byte stuffing."""
    sent = stream_encode(_unstuffed(link), id, data, direction)
    # An id has one row per direction.
    (row,) = (row for row in form.rows(direction) if row.id == id)
    return _split_parts(form.packets[row.packet], sent)


def request_parts(form: Stream, link: Link, telemetry_id: int) -> list[TransmittedPart]:
    """Return the parts of the packet that requests telemetry, before byte stuffing;
    none if no packet does.
    """
    rows = [row for row in form.telemetry if row.id == telemetry_id]
    if form.request is None or not any(row.is_requested for row in rows):
        return []
    sent = stream_encode_request(_unstuffed(link), telemetry_id)
    return _split_parts(form.packets[form.request.packet], sent)


def _unstuffed(link: Link) -> Link:
    """Return the link without delimiter: byte stuffing would move the borders of the
    parts.
    """
    assert link.stream
    return link._replace(stream=link.stream._replace(delimited_by="datagram"))


def _split_parts(packet: PacketFormat, sent: bytes) -> list[TransmittedPart]:
    # Kinds are classes of the style sheet.
    head, end = packet.header_bytes, len(sent) - packet.trailer_bytes
    before, behind = (
        ", ".join(f.role for f in packet.fields if f.in_trailer == where)
        for where in (False, True)
    )
    of_packet = f" of {packet.name}" if packet.name else ""
    parts = [
        TransmittedPart("id", sent[:head], f"header{of_packet}: {before}"),
        TransmittedPart("data", sent[head:end], f"data, {count(end - head, 'byte')}"),
        TransmittedPart("crc", sent[end:], f"trailer{of_packet}: {behind}"),
    ]
    return [part for part in parts if part.data]
