"""Errors of packets that cannot be decoded: cut off, damaged, or not a message of the
ICD.

`fault_of` explains bytes that begin like a packet of a framed link, with every packet
format of the link, and returns the explanation that matches most of the header.
"""

from __future__ import annotations

from typing import Literal

from icdgen_runtime.wire.packet_formats import (
    Direction,
    PacketField,
    PacketForm,
    Response,
    Stream,
    StreamRow,
)

# A report on a damaged packet must show what the decoder compared, so it uses private
# functions of the decoder.
from icdgen_runtime.wire.stream import (
    ReceivedPacket,
    _checksum,
    _get,
    _id_of,
    _received_packets,
)
from icdgen_runtime.wire.stuffing import unstuffer

from icdgen.describe.ids import id_text
from icdgen.describe.numbers import byte_count
from icdgen.frozen import NamedTuple
from icdgen.protocol.packet_formats import COBS, DATAGRAM, ESCAPE, HDLC, LENGTH, SLIP
from icdgen.recognize.reading import Endpoint
from icdgen.values.errors import BadLength, NotFound

_DATA_ALONE = "if these are the data of a message alone, name it: `icdgen decode {} MESSAGE FRAME`"
_ENDS = {SLIP: "C0", HDLC: "7E", COBS: "00"}
_DELIMITED_AHEAD = (SLIP, HDLC, ESCAPE)  # packets also begin with a delimiter
_BITS_OF_SYNC = 8  # constants of fewer bits occur in any data


class FrameFault(NamedTuple):
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


def has_sync(form: Stream, direction: Direction) -> bool:
    """Return whether packets begin with a delimiter or with at least 8 constant bits."""
    return form.delimited_by in _DELIMITED_AHEAD or all(
        _sync_bits(packet) >= _BITS_OF_SYNC for packet in form.packets_of(direction)
    )


def _sync_bits(packet: PacketForm) -> int:
    """Return the number of constant bits of the header."""
    return sum(
        field.bits
        for field in packet.fields
        if field.role == "constant" and not field.in_trailer
    )


def begins_packet(form: Stream, direction: Direction, data: bytes) -> bool:
    """Return whether bytes begin with the delimiter or the constants of a direction."""
    if form.escaping and form.escaping.start is None:
        has_escape = data[:1] == bytes((form.escaping.escape,))
        # An escape byte at the end of the data can begin a packet, too: `all` of
        # nothing is true.
        return has_escape and all(map(form.escaping.begins, data[1:2]))
    if form.delimited_by in _DELIMITED_AHEAD:
        return data.startswith(_opening(form))
    return data != b"" and any(
        _sync_bits(packet) >= _BITS_OF_SYNC
        and _bits_of_constants(packet, direction, data) > 0
        for packet in form.packets_of(direction)
    )


def _opening(form: Stream) -> bytes:
    """Return the delimiter in front of packets."""
    if form.escaping:
        start = form.escaping.start
        return bytes((form.escaping.escape, *([] if start is None else [start])))
    return bytes.fromhex(_ENDS[form.delimited_by])


def _closing_text(form: Stream) -> str:
    """Return the text for a missing end of a packet; empty without a delimiter."""
    if form.escaping:
        ending = bytes((form.escaping.escape, form.escaping.end)).hex(" ").upper()
        return f"the bytes {ending} that end it are missing"
    end = _ENDS.get(form.delimited_by)
    return f"the byte {end} that ends it is missing" if end else ""


def sync_text(stream: Stream, form: PacketForm, direction: Direction) -> str:
    """Return the constant first bytes of packets, such as ``A5 5A``.

    It may be empty.
    """
    if stream.delimited_by in _DELIMITED_AHEAD:
        return _opening(stream).hex(" ").upper()
    constants = {
        field.at: field
        for field in form.fields
        if field.role == "constant" and not field.in_trailer
    }
    constant_bytes, at = b"", 0
    while (field := constants.get(at)) is not None and field.bits == 8 * field.size:
        # A constant has a value for each direction: telecommands first.
        constant_bytes += field.values[direction == "telemetry"].to_bytes(
            field.size, "little" if field.little else "big"
        )
        at += field.size
    return constant_bytes.hex(" ").upper()


def _bits_of_constants(form: PacketForm, direction: Direction, packet: bytes) -> int:
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
        mask_of_field = (1 << field.bits) - 1 << field.shift
        mask = mask_of_field.to_bytes(field.size, order)[: len(received)]
        value = field.values[direction == "telemetry"] << field.shift
        expected = value.to_bytes(field.size, order)[: len(received)]
        if any((a ^ b) & m for a, b, m in zip(received, expected, mask, strict=True)):
            return -1
        bits += sum(byte.bit_count() for byte in mask)
    return bits


def fault_of(
    endpoint: Endpoint, direction: Direction, packet: bytes, is_whole: bool
) -> FrameFault | None:
    """Return the reason why a packet without stuffing is not a message of a direction.

    Return None if it does not begin like a packet. ``is_whole``: its end was received,
    as far as this can be detected.
    """
    form = endpoint.link.stream
    assert form
    faults = [
        _fault_in(endpoint, direction, received, packet, is_whole)
        for received in _received_packets(form, direction)
    ]
    return max(filter(None, faults), key=lambda fault: fault.rank, default=None)


def is_refusal(response: Response, frame: bytes) -> bool:
    """Return whether a packet refuses the telecommand or request, also for a time."""
    return response.verdict_of(frame) not in ("ack", "progress")


def reason_text(response: Response, frame: bytes) -> str:
    """Return the reason of a refusal; empty if the packet has none."""
    if response.reason is None or not is_refusal(response, frame):
        return ""
    code = response.reason.of(frame)
    return dict(response.reasons).get(code, str(code))


class _Attempt(NamedTuple):
    """Bytes that begin like a packet of one format, with what is known about them."""

    endpoint: Endpoint
    direction: Direction
    received: ReceivedPacket
    packet: bytes
    id: int | None  # None: no id, or it was not received
    row: StreamRow | None  # message of the id
    title: str  # name of the packet in a report
    # Constant bits of the header, plus 100 for a known id, 200 if only the checksum is
    # wrong, 300 if only the message is
    rank: int
    is_certain: bool = False


def _fault_in(
    endpoint: Endpoint,
    direction: Direction,
    received: ReceivedPacket,
    packet: bytes,
    is_whole: bool,
) -> FrameFault | None:
    """Return the reason why the bytes are not a packet of a format; None if they do not
    begin like one.
    """
    stream, form = endpoint.link.stream, received.form
    assert stream
    delimiter, longest = stream.delimited_by, endpoint.link.longest
    count = len(packet)
    bits = _bits_of_constants(form, direction, packet)
    if bits < 0:
        return None
    has_id = form.of("id") is not None
    id = _id(form, packet, is_whole)
    row = received.row(id) if id is not None or not has_id else None
    title = _title(endpoint, direction, received, id, row)
    rank = bits + (100 if row else 0)
    attempt = _Attempt(endpoint, direction, received, packet, id, row, title, rank)
    needed = packet_size(stream, received, packet)
    if needed is not None and not form.overhead <= needed <= longest:
        text = f"a {title} says that it has {byte_count(needed)}; packets have up to {longest}"
        return FrameFault(
            rank,
            text,
            "a byte of the header is damaged, or bytes are missing",
            longest,
            count,
            is_of_message=row is not None,
        )
    least, most = received.bounds(row)
    if received.lengths and needed is not None:
        is_certain = row is not None and least <= needed - form.overhead <= most
    else:
        is_certain = row is not None and delimiter in _DELIMITED_AHEAD
    # Without a length field, only the message of the id says where the packet ends.
    is_unmeasured = delimiter == LENGTH and not received.lengths
    if is_unmeasured and row is None and form.tells_message:
        if id is not None or not has_id:
            return _no_message(attempt, None)
    if not is_whole or (needed is not None and count < needed):
        if needed:
            expected = f"{needed} are needed"
        else:
            expected = f"its header has {form.header_bytes}"
        if needed is None and count >= form.header_bytes:
            expected = _closing_text(stream) or expected
        text = f"a {title} is cut off: {byte_count(count)} came, {expected}"
        data_alone = _DATA_ALONE.format(endpoint.node.name)
        return FrameFault(
            rank,
            text,
            f"check that the capture is complete; {data_alone}",
            needed or form.header_bytes,
            count,
            is_of_message=row is not None,
            is_certain=is_certain,
        )
    fault = _fault_of_whole(attempt._replace(is_certain=is_certain))
    return fault._replace(is_of_message=row is not None)


def _title(
    endpoint: Endpoint,
    direction: Direction,
    received: ReceivedPacket,
    id: int | None,
    row: StreamRow | None,
) -> str:
    """Return what a packet is called in a report."""
    node, declared = endpoint.node.name, endpoint.facts.stream
    title = f"packet of {node}"
    if not received.form.tells_message:
        title = f"packet `{received.form.name}` of {node}"
    if row is None:
        if id is not None:
            title += f" with the id {id_text(declared, id)}"
        return title
    is_request = received.requested.get(row.id) is row
    sent: Direction = "telemetry" if is_request else direction
    names = " or ".join(
        f"`{variant.message.name}` ({sent} {id_text(declared, row.id)})"
        for variant in getattr(endpoint.ids, sent).get(row.id, ())
    )
    return f"{title}, {'request of ' if is_request else ''}{names}"


def _fault_of_whole(attempt: _Attempt) -> FrameFault:
    """Return the fault of a packet that is not cut off.

    The order of the checks is that of the decoder: length, constants, checksum, message.
    """
    received, packet, row = attempt.received, attempt.packet, attempt.row
    title, rank = attempt.title, attempt.rank
    form, count = received.form, len(packet)
    stream = attempt.endpoint.link.stream
    assert stream
    size = count - form.overhead
    if size < 0:
        least = form.overhead
        text = f"a {title} is cut off: {byte_count(count)} came, header and trailer have {least}"
        help = "check that the capture is complete"
        return FrameFault(rank, text, help, least, count)
    needed = packet_size(stream, received, packet)
    if needed is not None and needed != count:
        text = f"a {title} has {byte_count(count)}, its length says {needed}"
        help = "bytes are missing, or too many, or damaged"
        return FrameFault(rank, text, help, needed, count)
    for field, expected in received.constants:
        value = _get(form, field, packet, count)
        if field.in_trailer and value != expected:
            text = f"a {title} ends with {_bytes_text(field, value)}, expected {_bytes_text(field, expected)}"
            help = "bytes are missing, or too many, or damaged"
            return FrameFault(rank, text, help, count, count)
    place, has_message = received.checksum, form.tells_message
    # A seeded checksum depends on the message, so it needs a known id.
    if (
        place
        and form.check
        and (row is not None or not form.check.is_seeded or not has_message)
    ):
        sent, expected = _get(form, place, packet, count), _checksum(form, row, packet)
        if sent != expected:
            text = f"a {title} has a wrong checksum: it is {_bytes_text(place, sent)}, expected {_bytes_text(place, expected)}"
            return FrameFault(
                rank + 200,
                text,
                "a byte of it is damaged or missing, or the packet is of another node",
                count,
                count,
                is_certain=attempt.is_certain,
            )
    if row is None and has_message:
        return _no_message(attempt, size)
    least, most = received.bounds(row)
    if not least <= size <= most:
        lengths = f"{least}" if least == most else f"{least} to {most}"
        text = f"a {title} has {byte_count(size)} of data, the ICD says {lengths}"
        help = "bytes are missing, or too many"
        return FrameFault(rank + 300, text, help, most, size, is_certain=True)
    if row is None and form.content == "none":
        return _unrelated_response(attempt)
    if row and not received.awaits(row, packet):
        text = (
            f"a {title} asks for another number of bytes than the {row.most} of the ICD"
        )
        help = "the ICD describes what is requested at once"
        return FrameFault(rank + 300, text, help, size, size)
    text = (
        f"a {title} has data that do not match the length and constants of the message"
    )
    help = "a byte was damaged, or there are too many"
    return FrameFault(rank + 300, text, help, size, size)


def _no_message(attempt: _Attempt, size: int | None) -> FrameFault:
    """Return the fault of a packet whose id no message of the direction has in it.

    ``size``: bytes of its data; None if they are unknown.
    """
    endpoint, node = attempt.endpoint, attempt.endpoint.node.name
    other: Direction = "telemetry"
    if attempt.direction == "telemetry":
        other = "telecommand"
    names = [
        f"`{variant.message.name}`"
        for variant in getattr(endpoint.ids, other).get(attempt.id, ())
    ]
    absence = "no message with this id"
    if names:
        absence = (
            f"no {attempt.direction} with this id, but {other} {' or '.join(names)}"
        )
    data = "" if size is None else f"and {byte_count(size)} of data "
    text = f"a {attempt.title} {data}is no message: {node} has {absence}"
    help = f"`icdgen show {node}` lists its messages"
    count = len(attempt.packet)
    return FrameFault(attempt.rank + 300, text, help, 0, count, is_unknown=True)


def _unrelated_response(attempt: _Attempt) -> FrameFault:
    """Return the fault of a packet without a message that responds to no message of the
    ICD: its meaning.
    """
    stream, packet = attempt.endpoint.link.stream, attempt.packet
    assert stream
    responses: list[Response] = []
    for exchange in stream.exchanges:
        for response in exchange.responses:
            if response.packet == attempt.received.number:
                responses.append(response)
    meaning = "response"
    if responses:
        meaning = "refusal" if is_refusal(responses[0], packet) else "acknowledge"
        reason = reason_text(responses[0], packet)
        meaning += f", reason {reason}" if reason else ""
    text = f"a {attempt.title} is a {meaning}: no message has this id"
    if not attempt.received.form.of("id"):
        text = f"a {attempt.title} is a {meaning}: without an id, it names no message"
    help = f"`icdgen show {attempt.endpoint.node.name}` lists its messages"
    return FrameFault(attempt.rank + 300, text, help, 0, len(packet), is_unknown=True)


def packet_begun(
    endpoint: Endpoint, direction: Direction, data: bytes
) -> tuple[bytes, bool]:
    """Return the first packet without stuffing, and whether its end was received."""
    form = endpoint.link.stream
    assert form
    if form.delimited_by == DATAGRAM:
        return data, True
    if form.delimited_by == LENGTH:
        needed = None
        for packet in _received_packets(form, direction):
            if _bits_of_constants(packet.form, direction, data) >= 0:
                needed = packet_size(form, packet, data)
                break
        # If the length is unknown, the slice up to None has all bytes.
        return data[:needed], needed is not None and len(data) >= needed
    line = unstuffer(form, endpoint.link.longest)
    assert line
    frames = [frame for frame in line.feed(data) if frame.fault != "noise"]
    if frames:
        return frames[0].bytes, frames[0].fault is None
    return line.begun, False


def packet_size(stream: Stream, received: ReceivedPacket, packet: bytes) -> int | None:
    """Return the length of the packet by its header, or None if it does not say it."""
    form = received.form
    if len(packet) < form.header_bytes:
        return None
    if not received.lengths and stream.delimited_by != LENGTH:
        return None
    count = received.data_bytes(packet, len(packet))
    return None if count is None else form.overhead + count


def _id(form: PacketForm, packet: bytes, is_whole: bool) -> int | None:
    """Return the id, or None if the packet is too short."""
    size = len(packet)
    for field in form.fields:
        if field.role != "id":
            continue
        is_cut = field.at + field.size > size
        if field.in_trailer:
            is_cut = is_cut or not is_whole or size < form.trailer_bytes
        if is_cut:
            return None
    return _id_of(form, packet, size)


def _bytes_text(field: PacketField, value: int) -> str:
    """Return a value as transmitted bytes, or as a number if other fields share its
    bytes.
    """
    if field.shift or field.bits != 8 * field.size:
        return f"0x{value:X}"
    return (
        value.to_bytes(field.size, "little" if field.little else "big").hex(" ").upper()
    )
