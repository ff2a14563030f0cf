"""Errors of packets that cannot be decoded: cut off, damaged, or not a message of the
ICD.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from icdgen_runtime.wire.envelope import Direction, EnvelopeField, Stream, StreamRow
from icdgen_runtime.wire.stream import _checksum, _get
from icdgen_runtime.wire.stuffing import Unstuffer

from icdgen.describe.ids import id_text
from icdgen.describe.numbers import byte_count
from icdgen.protocol.envelope import COBS, HDLC, LENGTH, PACKET, SLIP
from icdgen.recognize.reading import Endpoint
from icdgen.values.errors import BadLength, NotFound

_DATA_ALONE = "if these are the data of a message alone, name it: `icdgen decode {} MESSAGE FRAME`"
_ENDS = {SLIP: "C0", HDLC: "7E", COBS: "00"}
_BITS_OF_SYNC = 8  # constants of fewer bits occur in any data


class Fault(NamedTuple):
    """The reason why a packet cannot be decoded.

    ``rank``: how much of the header matches. The explanation with the highest rank is
    used. ``is_unknown``: no message has the id. ``is_of_message``: a message has the
    id. ``is_certain``: header, id and length match a message, which is unlikely by
    chance.
    """

    rank: int
    text: str
    help: str
    needed: int
    given: int
    is_unknown: bool = False
    is_of_message: bool = False
    is_certain: bool = False

    @property
    def error(self) -> BadLength | NotFound:
        """The exception for an input that consists of this packet."""
        if self.is_unknown:
            return NotFound(self.text, self.help)
        return BadLength(self.text, self.needed, self.given, self.help)


def has_sync(form: Stream) -> bool:
    """Return whether packets begin with a delimiter or with at least 8 constant bits."""
    constants = [
        field
        for field in form.fields
        if field.role == "constant" and not field.in_trailer
    ]
    return (
        form.delimited_by in (SLIP, HDLC)
        or sum(field.bits for field in constants) >= _BITS_OF_SYNC
    )


def begins_packet(form: Stream, direction: Direction, data: bytes) -> bool:
    """Return whether bytes begin with the delimiter or the constants of a direction."""
    if form.delimited_by in (SLIP, HDLC):
        return data[:1].hex().upper() == _ENDS[form.delimited_by]
    return (
        bool(data) and has_sync(form) and _bits_of_constants(form, direction, data) > 0
    )


def sync_text(form: Stream, direction: Direction) -> str:
    """Return the constant first bytes of packets, such as ``A5 5A``.

    It may be empty.
    """
    if form.delimited_by in (SLIP, HDLC):
        return _ENDS[form.delimited_by]
    constants = {
        field.at: field
        for field in form.fields
        if field.role == "constant" and not field.in_trailer
    }
    constant_bytes, at = b"", 0
    while (field := constants.get(at)) is not None and field.bits == 8 * field.size:
        constant_bytes += field.values[direction == "telemetry"].to_bytes(
            field.size, "little" if field.little else "big"
        )
        at += field.size
    return constant_bytes.hex(" ").upper()


def _bits_of_constants(form: Stream, direction: Direction, packet: bytes) -> int:
    """Return the number of matching constant bits in the header of a packet.

    Return -1 if a constant is wrong. The packet may be cut off.
    """
    bits = 0
    for field in form.fields:
        if field.role != "constant" or field.in_trailer or field.at >= len(packet):
            continue
        # Compare only the bytes that were received.
        received = packet[field.at : field.at + field.size]
        order: Literal["little", "big"] = "little" if field.little else "big"
        mask = ((1 << field.bits) - 1 << field.shift).to_bytes(field.size, order)[
            : len(received)
        ]
        value = field.values[direction == "telemetry"] << field.shift
        expected = value.to_bytes(field.size, order)[: len(received)]
        if any((a ^ b) & m for a, b, m in zip(received, expected, mask, strict=True)):
            return -1
        bits += sum(byte.bit_count() for byte in mask)
    return bits


def fault_of(
    endpoint: Endpoint, direction: Direction, packet: bytes, is_whole: bool
) -> Fault | None:
    """Return the reason why a packet without stuffing is not a message of a direction.

    Return None if it does not begin like a packet. ``is_whole``: its end was received,
    as far as this can be detected.
    """
    form, declared = endpoint.link.stream, endpoint.facts.stream
    assert form
    longest = endpoint.link.longest
    node, count = endpoint.node.name, len(packet)
    bits = _bits_of_constants(form, direction, packet)
    if bits < 0:
        return None
    field = form.of("id")
    rows = form.rows(direction)
    if field is None:  # a format without id has one message
        id = rows[0].id if rows else None
    else:
        id = _value(form, field, packet, is_whole)
    messages = (
        [variant.message for variant in getattr(endpoint.ids, direction).get(id, ())]
        if id is not None
        else []
    )
    row = next((row for row in rows if row.id == id), None)
    rank, title = bits, f"packet of {node}"
    if id is not None and field is not None:
        title += f" with the id {id_text(declared, id)}"
    # Ranks: constant bits of the header, plus 100 for a known id, 200 if only the
    # checksum is wrong, 300 if only the message is.
    if messages:
        rank += 100
        names = " or ".join(
            f"`{message.name}` ({direction} {id_text(declared, id or 0)})"
            for message in messages
        )
        title = f"packet of {node}, {names}"
    needed = _size(form, packet)
    if (
        needed is not None
        and not form.header_bytes + form.trailer_bytes <= needed <= longest
    ):
        text = f"a {title} says that it has {byte_count(needed)}; packets have up to {longest}"
        return Fault(
            rank,
            text,
            "a byte of the header is damaged, or bytes are missing",
            longest,
            count,
            is_of_message=bool(messages),
        )
    is_of_row = bool(
        row
        and needed
        and row.least <= needed - form.header_bytes - form.trailer_bytes <= row.most
    )
    is_certain = bool(messages) and (
        is_of_row or (needed is None and form.delimited_by in (SLIP, HDLC))
    )
    if not is_whole or (needed is not None and count < needed):
        expected = (
            f"{needed} are needed" if needed else f"its header has {form.header_bytes}"
        )
        if needed is None and count >= form.header_bytes and form.delimited_by in _ENDS:
            expected = f"the byte {_ENDS[form.delimited_by]} that ends it is missing"
        text = f"a {title} is cut off: {byte_count(count)} came, {expected}"
        help = f"check that the capture is complete; {_DATA_ALONE.format(node)}"
        return Fault(
            rank,
            text,
            help,
            needed or form.header_bytes,
            count,
            False,
            bool(messages),
            is_certain,
        )
    fault = _fault_of_whole(endpoint, direction, packet, title, row, rank, is_certain)
    return fault._replace(is_of_message=bool(messages))


def _fault_of_whole(
    endpoint: Endpoint,
    direction: Direction,
    packet: bytes,
    title: str,
    row: StreamRow | None,
    rank: int,
    is_certain: bool,
) -> Fault:
    """Return the fault of a packet that is not cut off."""
    form, node = endpoint.link.stream, endpoint.node.name
    assert form
    size, count = len(packet) - form.header_bytes - form.trailer_bytes, len(packet)
    if size < 0:
        least = form.header_bytes + form.trailer_bytes
        text = f"a {title} is cut off: {byte_count(count)} came, header and trailer have {least}"
        return Fault(rank, text, "check that the capture is complete", least, count)
    needed = _size(form, packet)
    if needed is not None and needed != count:
        text = f"a {title} has {byte_count(count)}, its length says {needed}"
        return Fault(
            rank, text, "bytes are missing, or too many, or damaged", needed, count
        )
    for field in form.fields:
        if field.role == "constant" and field.in_trailer:
            value, expected = (
                _get(form, field, packet, len(packet)),
                field.values[direction == "telemetry"],
            )
            if value != expected:
                text = f"a {title} ends with {_bytes_text(field, value)}, expected {_bytes_text(field, expected)}"
                return Fault(
                    rank,
                    text,
                    "bytes are missing, or too many, or damaged",
                    count,
                    count,
                )
    place = form.of("checksum")
    if place and form.check and (row is not None or not form.check.is_seeded):
        received, expected = _get(form, place, packet, len(packet)), _checksum(
            form, row, packet
        )
        if received != expected:
            text = f"a {title} has a wrong checksum: it is {_bytes_text(place, received)}, expected {_bytes_text(place, expected)}"
            help = (
                "a byte of it is damaged or missing, or the packet is of another node"
            )
            return Fault(rank + 200, text, help, count, count, is_certain=is_certain)
    if row is None:
        other: Direction = "telemetry" if direction == "telecommand" else "telecommand"
        place = form.of("id")
        id = _get(form, place, packet, count) if place else 0
        names = [
            f"`{variant.message.name}`"
            for variant in getattr(endpoint.ids, other).get(id, ())
        ]
        absence = (
            f"no {direction} with this id, but {other} {' or '.join(names)}"
            if names
            else "no message with this id"
        )
        text = f"a {title} and {byte_count(size)} of data is no message: {node} has {absence}"
        return Fault(
            rank + 300,
            text,
            f"`icdgen show {node}` lists its messages",
            0,
            count,
            is_unknown=True,
        )
    if not row.least <= size <= row.most:
        lengths = (
            f"{row.least}" if row.least == row.most else f"{row.least} to {row.most}"
        )
        text = f"a {title} has {byte_count(size)} of data, the ICD says {lengths}"
        return Fault(
            rank + 300,
            text,
            "bytes are missing, or too many",
            row.most,
            size,
            is_certain=True,
        )
    text = (
        f"a {title} has data that do not match the length and constants of the message"
    )
    return Fault(
        rank + 300, text, "a byte was damaged, or there are too many", size, size
    )


def packet_begun(
    endpoint: Endpoint, direction: Direction, data: bytes
) -> tuple[bytes, bool]:
    """Return the first packet without stuffing, and whether its end was received."""
    form = endpoint.link.stream
    assert form
    if form.delimited_by == PACKET:
        return data, True
    if form.delimited_by == LENGTH:
        needed = _size(form, data)
        return data[:needed], needed is not None and len(data) >= needed
    end = bytes.fromhex(_ENDS[form.delimited_by])
    line = Unstuffer(form.delimited_by, endpoint.link.longest)
    frames = line.feed(data)
    if frames:
        return frames[0].bytes, frames[0].fault is None
    frames = line.feed(end)
    return (frames[0].bytes if frames else b""), False


def _size(form: Stream, packet: bytes) -> int | None:
    """Return the length of the packet in its header, or None if it is missing."""
    field = form.of("length")
    if field is None or len(packet) < form.header_bytes:
        return None
    return (
        form.header_bytes
        + _get(form, field, packet, len(packet))
        - form.length_plus
        + form.trailer_bytes
    )


def _value(
    form: Stream, field: EnvelopeField, packet: bytes, is_whole: bool
) -> int | None:
    """Return the value of a field, or None if the packet is too short."""
    if field.in_trailer and not is_whole:
        return None
    if field.at + field.size > len(packet) or (
        field.in_trailer and len(packet) < form.trailer_bytes
    ):
        return None
    return _get(form, field, packet, len(packet))


def _bytes_text(field: EnvelopeField, value: int) -> str:
    """Return a value as transmitted bytes, or as a number if other fields share its
    bytes.
    """
    if field.shift or field.bits != 8 * field.size:
        return f"0x{value:X}"
    return (
        value.to_bytes(field.size, "little" if field.little else "big").hex(" ").upper()
    )
