"""Messages with the packet formats of the ICD, in a byte stream or in packets.

`stream_encode` adds header and trailer to a message; `StreamDecoder` finds the packets
of one direction in received bytes, checks them, and continues after noise and damage.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple, Optional, TypeVar, Union, cast

from .._base import Message
from .._errors import LengthError, RangeError, UnknownIdError
from .._hints import Buffer
from .checks import check
from .errors import UnsupportedError, need
from .link import Link
from .message_ids import message_id
from .packet_formats import (
    CHOSEN_ROLES,
    Direction,
    PacketField,
    PacketForm,
    Stream,
    StreamRow,
)
from .stuffing import stuffed, unstuffer

M = TypeVar("M", bound=Message)
MessageClass = type[Message]
MessageClassOf = type[M]
EventName = Literal[
    "message",
    "request",
    "packet",
    "gap",
    "checksum",
    "length",
    "unknown_id",
    "overrun",
    "framing",
]


class StreamEvent(NamedTuple):
    """A message, or the reason why bytes were dropped.

    ``request``: telemetry of this id is requested. ``packet``: a packet without a
    message, or with requested telemetry that only the request names; ``data`` is all of
    it. ``gap``: ``missing`` messages were lost before this
    one; 0 if a message was repeated. ``checksum``: the checksum is wrong. ``length``:
    length mismatch. ``unknown_id``: the node has no such message. ``overrun``: longer
    than the buffer. ``framing``: a constant or a delimiter is wrong.
    """

    event: EventName
    id: Optional[int] = None
    data: bytes = b""
    values: Mapping[str, int] = {}
    """For a message, a request or a packet: the frame fields that its sender chose, by
    role.
    """
    missing: int = 0
    kind: Optional[MessageClass] = None
    """For a message: its class; None if no message of its id matches."""
    packet: Optional[int] = None
    """For a packet: its index in `Stream.packets`."""
    header: bytes = b""
    """For all but packets, gaps and faults of delimiters: the header of the packet."""
    is_request: bool = False
    """For ``unknown_id``, ``length`` and ``checksum``: whether the packet has the format
    of requests of telemetry.
    """

    def of(self, message: MessageClassOf[M]) -> Optional[M]:
        """Return the message if it has this class, otherwise None."""
        if self.kind is not message:
            return None
        return message.from_bytes(self.data)


def stream_encode(
    link: Link,
    message: Union[Message, int],
    data: Buffer = b"",
    direction: Direction = "telecommand",
    **values: int,
) -> bytes:
    """Encode a message, or the data of an id, with header and trailer.

    ``values`` are the values of ``sequence``, ``source``, ``destination``, ``type``,
    ``flags``, ``time``, ``status`` and ``reason``. Defaults are in the ICD.
    ``direction`` is the direction of the message: a device sends ``"telemetry"``. Raise
    `UnknownIdError`, `LengthError` and `RangeError`.
    """
    form = need(link.stream, "stream")
    _check_roles("stream_encode", values)
    if isinstance(message, Message):
        if data:
            raise TypeError("a message has its own data; direction= tells who sends it")
        id, data = message_id(link, direction, type(message)), message.to_bytes()
    else:
        id, data = message, bytes(data)
    row = form.row(direction, id)
    if row is None:
        raise UnknownIdError(link.node, direction, id)
    if not row.least <= len(data) <= row.most:
        nearest = row.most if len(data) > row.most else row.least
        raise LengthError("a message", nearest, len(data))
    # MAVLink 2 truncates zeros in this way; it never truncates the first byte.
    if row.cuts_zeros:
        data = data[:1] + data[1:].rstrip(b"\0")
    packet = form.packets[row.packet]
    return _encoded(form, packet, direction, id, data, values, row)


def stream_encode_request(link: Link, telemetry: int, **values: int) -> bytes:
    """Encode the packet that requests telemetry of an id, with header and trailer.

    ``values``: see `stream_encode`. Raise `UnsupportedError` if no packet of the link
    requests telemetry, `UnknownIdError` for telemetry that cannot be requested by it,
    and `RangeError`.
    """
    form = need(link.stream, "stream")
    _check_roles("stream_encode_request", values)
    request = need(form.request, "requests")
    row = form.row("telemetry", telemetry)
    if row is None or not row.is_requested:
        raise UnknownIdError(link.node, "telemetry", telemetry)
    packet = form.packets[request.packet]
    data = bytes(packet.reserved)
    return _encoded(form, packet, "telecommand", telemetry, data, values, row)


def stream_encode_packet(
    link: Link,
    packet: int,
    id: int = 0,
    direction: Direction = "telemetry",
    **values: int,
) -> bytes:
    """Encode a packet without a message, given by its index in `Stream.packets`.

    ``id`` is the value of its field ``id``. ``values``: see `stream_encode`. Raise
    `RangeError`, also for a packet with a message or of the other direction.
    """
    form = need(link.stream, "stream")
    _check_roles("stream_encode_packet", values)
    packet_form = packet_without_message(form, packet, direction)
    data = bytes(packet_form.reserved)
    return _encoded(form, packet_form, direction, id, data, values, None)


def packet_without_message(
    form: Stream, packet: int, direction: Direction
) -> PacketForm:
    """Return a packet format by its index. Raise `RangeError` if such packets have a
    message or the other direction.
    """
    sent = [
        index
        for index, each in enumerate(form.packets)
        if each.content == "none" and direction in each.directions
    ]
    if packet not in sent:
        raise RangeError("packet", f"one of {', '.join(map(str, sent))}", packet)
    return form.packets[packet]


def _check_roles(function: str, values: Mapping[str, int]) -> None:
    if unknown := [name for name in values if name not in CHOSEN_ROLES]:
        raise TypeError(
            f"{function}() takes no {unknown[0]!r}, but {', '.join(CHOSEN_ROLES)}"
        )


def _encoded(
    form: Stream,
    packet: PacketForm,
    direction: Direction,
    id: int,
    data: bytes,
    values: Mapping[str, int],
    row: Optional[StreamRow],
) -> bytes:
    """Return the transmitted bytes of a packet with these data."""
    head, tail = bytearray(packet.header_bytes), bytearray(packet.trailer_bytes)
    for field in packet.fields:
        if field.role == "checksum":
            continue  # it can cover all other fields
        value = field.values[direction == "telemetry"]
        if field.role == "id":
            value = id >> field.id_shift
            # The field with the highest bits gets all of them, so that `_put` reports
            # an id that is too large.
            if field.id_shift + field.bits < _id_bits(packet):
                value &= (1 << field.bits) - 1
        elif field.role == "length":
            value = field.counted(len(data))
        elif field.role == "response_length" and row:
            value = field.counted(row.most)
        elif field.role in CHOSEN_ROLES:
            value = values.get(field.role, value)
        _put(field, tail if field.in_trailer else head, value)
    place = packet.of("checksum")
    if place and packet.check:
        value = _checksum(packet, row, bytes(head) + data + bytes(tail))
        _put(place, tail if place.in_trailer else head, value)
    return stuffed(form, bytes(head) + data + bytes(tail))


def _id_bits(packet: PacketForm) -> int:
    """Return the bits of the id in all its fields."""
    return sum(field.bits for field in packet.fields if field.role == "id")


def _put(field: PacketField, into: bytearray, value: int) -> None:
    if not 0 <= value < 1 << field.bits:
        raise RangeError(field.role, f"0 to {(1 << field.bits) - 1}", value)
    order: Literal["little", "big"] = "little" if field.little else "big"
    span = slice(field.at, field.at + field.size)
    number = int.from_bytes(into[span], order) | value << field.shift
    into[span] = number.to_bytes(field.size, order)


def _get(packet: PacketForm, field: PacketField, frame: Buffer, size: int) -> int:
    at = field.at + (size - packet.trailer_bytes if field.in_trailer else 0)
    order: Literal["little", "big"] = "little" if field.little else "big"
    number = int.from_bytes(frame[at : at + field.size], order)
    return number >> field.shift & ((1 << field.bits) - 1)


def _id_of(packet: PacketForm, frame: Buffer, size: int) -> Optional[int]:
    """Return the id of a frame from all its parts; None in a packet without id."""
    id = None
    for field in packet.fields:
        if field.role == "id":
            id = (id or 0) | _get(packet, field, frame, size) << field.id_shift
    return id


def values_of(packet: PacketForm, frame: Buffer) -> tuple[int, dict[str, int]]:
    """Return the id of a frame, and the values that its sender chose, by role."""
    size = len(frame)
    fields = (field for field in packet.fields if field.role in CHOSEN_ROLES)
    values = {field.role: _get(packet, field, frame, size) for field in fields}
    return _id_of(packet, frame, size) or 0, values


def _checksum(packet: PacketForm, row: Optional[StreamRow], frame: bytes) -> int:
    check_form = need(packet.check, "checksums")
    end = len(frame) - packet.trailer_bytes + check_form.covered_trailer
    seed = bytes((row.seed,)) if check_form.is_seeded and row else b""
    return check(check_form, frame[check_form.covered_from : end] + seed)


class ReceivedPacket(NamedTuple):
    """A packet format of the received direction, and what a decoder needs of it."""

    number: int  # index in `Stream.packets`
    form: PacketForm
    constants: list[tuple[PacketField, int]]
    values: list[PacketField]
    lengths: list[PacketField]
    sequence: Optional[PacketField]
    checksum: Optional[PacketField]
    rows: dict[int, StreamRow]  # by id
    requested: dict[int, StreamRow]  # telemetry that it requests, by id
    only: int  # id of the message of a packet without id
    # Smallest and largest number of bytes of data of a packet that tells no message
    sizes: tuple[int, int]

    def differs(self, front: Buffer, left: int) -> bool:
        """Return whether a constant of the header, as far as it was received, differs.

        ``left``: number of received bytes.
        """
        return any(
            not field.in_trailer
            and field.at + field.size <= left
            and _get(self.form, field, front, 0) != value
            for field, value in self.constants
        )

    def fits(self, frame: Buffer) -> bool:
        """Return whether a frame has the size of header and trailer, and all
        constants.
        """
        size = len(frame)
        return size >= self.form.overhead and all(
            _get(self.form, field, frame, size) == value
            for field, value in self.constants
        )

    def data_bytes(self, frame: Buffer, size: int) -> Optional[int]:
        """Return the number of data bytes from the first length field. Without such a
        field, return the largest size of the message; None for an unknown id.

        ``size``: bytes of the frame, to find fields of the trailer.
        """
        if self.lengths:
            field = self.lengths[0]
            return field.bytes_of(_get(self.form, field, frame, size))
        row = self.row(_id_of(self.form, frame, size))
        if row is None and self.form.content == "message":
            return None
        return self.bounds(row)[1]

    def agrees(self, frame: Buffer, count: int) -> bool:
        """Return whether all length fields of a frame say ``count`` bytes of data."""
        return all(
            field.bytes_of(_get(self.form, field, frame, len(frame))) == count
            for field in self.lengths
        )

    def bounds(self, row: Optional[StreamRow]) -> tuple[int, int]:
        """Return the smallest and largest number of bytes of the data: of a message, a
        request or, without ``row``, a packet that tells no message.
        """
        if row is None:
            return self.sizes
        if self.is_request_of(row):
            return (self.form.reserved, self.form.reserved)
        return (row.least, row.most)

    def is_request_of(self, row: StreamRow) -> bool:
        """Return whether a row is of telemetry that the packet requests."""
        return self.requested.get(row.id) is row

    def awaits(self, row: StreamRow, frame: Buffer) -> bool:
        """Return whether the response length in a request, if it has this field, is the
        length of the telemetry.
        """
        field = self.form.of("response_length")
        if field is None or not self.is_request_of(row):
            return True
        return field.bytes_of(_get(self.form, field, frame, len(frame))) == row.most

    def row(self, id: Optional[int]) -> Optional[StreamRow]:
        """Return the message, or the requested telemetry, of an id."""
        number = self.only if id is None else id
        return self.rows.get(number) or self.requested.get(number)


def _received_packets(form: Stream, direction: Direction) -> list[ReceivedPacket]:
    packets = []
    is_telemetry = direction == "telemetry"
    for index, packet in enumerate(form.packets):
        if direction not in packet.directions:
            continue
        own = [row for row in form.rows(direction) if row.packet == index]
        # Otherwise, only the request tells which of them it is.
        rows = {row.id: row for row in own if packet.tells_message}
        is_requesting = form.request is not None and form.request.packet == index
        is_requesting = is_requesting and not is_telemetry
        requested = {
            row.id: row for row in form.telemetry if is_requesting and row.is_requested
        }
        constants = [
            (field, field.values[is_telemetry])
            for field in packet.fields
            if field.role == "constant"
        ]
        values = [field for field in packet.fields if field.role in CHOSEN_ROLES]
        lengths = [field for field in packet.fields if field.role == "length"]
        sequence, checksum = map(packet.of, ("sequence", "checksum"))
        sizes = packet.reserved, packet.reserved
        if packet.content == "requested" and own:
            sizes = min(row.least for row in own), max(row.most for row in own)
        packets.append(
            ReceivedPacket(
                index,
                packet,
                constants,
                values,
                lengths,
                sequence,
                checksum,
                rows,
                requested,
                min(rows, default=0),
                sizes,
            )
        )
    return packets


class StreamDecoder:
    """Decode the messages of one direction, from pieces of the stream of any size.

    The buffer has ``limit`` bytes, by default the length of the longest message. If
    packets delimit messages, pass each packet separately. Raise `LengthError` if header
    and trailer exceed the limit, and `UnsupportedError` if the link has no packets of
    this direction.
    """

    def __init__(
        self,
        link: Link,
        direction: Direction = "telemetry",
        limit: Optional[int] = None,
    ) -> None:
        self._form = form = need(link.stream, "stream")
        self._limit = link.longest if limit is None else min(limit, link.longest)
        self._longest = link.longest
        self._packets = _received_packets(form, direction)
        if not self._packets:
            raise UnsupportedError(f"the link has no packets of {direction}")
        around = max(packet.form.overhead for packet in self._packets)
        if self._limit < around:
            raise LengthError("the buffer of header and trailer", around, self._limit)
        self._types = link.TELEMETRY if direction == "telemetry" else link.TELECOMMANDS
        self._buffer = bytearray()
        self._line = unstuffer(form, self._limit)
        self._last: dict[Optional[int], int] = {}  # last sequence numbers
        self.discarded = 0
        """Number of received bytes that are not part of a message."""

    @property
    def pending(self) -> int:
        """Number of received bytes that may still become part of a message."""
        return self._line.pending if self._line else len(self._buffer)

    def feed(self, data: Buffer) -> list[StreamEvent]:
        """Process the next bytes of the stream, or a packet."""
        data, events = bytes(data), list[StreamEvent]()
        if self._line:
            for frame in self._line.feed(data):
                if frame.fault == "noise":
                    self._skip(frame.size)
                else:
                    self._frame(frame.bytes, frame.size, frame.fault, events)
        elif self._form.delimited_by == "datagram":
            fault = "overrun" if len(data) > self._limit else None
            self._frame(data, len(data), fault, events)
        else:
            self._buffer += data
            at = 0
            while (count := self._front(at, events)) is not None:
                at += count
            del self._buffer[:at]  # once per call: deletion copies the remaining bytes
        return events

    def _skip(self, size: int) -> None:
        """Drop bytes that are not in a frame."""
        self.discarded += size

    def _frame(
        self, frame: bytes, size: int, fault: Optional[str], events: list[StreamEvent]
    ) -> None:
        """Process a frame that is delimited on both sides."""
        if fault:
            events.append(StreamEvent(cast(EventName, fault)))
        else:
            fitting = (packet for packet in self._packets if packet.fits(frame))
            packet = next(fitting, self._packets[0])
            if self._judge(packet, frame, events) == "message":
                return
        self.discarded += size

    def _front(self, at: int, events: list[StreamEvent]) -> Optional[int]:
        """Decode the bytes at an offset of the buffer.

        Return the number of processed bytes, or None if more bytes are needed.
        """
        left = len(self._buffer) - at
        if not left:
            return None
        for packet in self._packets:
            form = packet.form
            front = self._buffer[at : at + form.header_bytes]
            if not packet.differs(front, left):
                break
        else:
            self.discarded += 1
            return 1
        if left < form.header_bytes:
            return None
        data = packet.data_bytes(front, 0)
        if data is None:
            events.append(StreamEvent("unknown_id", _id_of(form, front, 0)))
            self.discarded += 1
            return 1
        size = form.overhead + data
        if data < 0 or size > self._limit:
            is_overrun = 0 <= data and size <= self._longest
            events.append(StreamEvent("overrun" if is_overrun else "length"))
            self.discarded += 1
            return 1
        if left < size:
            return None
        verdict = self._judge(packet, bytes(self._buffer[at : at + size]), events)
        if verdict != "message":
            size = size if verdict == "proven" else 1
            self.discarded += size
        return size

    def _judge(
        self, packet: ReceivedPacket, frame: bytes, events: list[StreamEvent]
    ) -> Literal["message", "proven", "doubtful"]:
        """Check and decode a frame, and add its events.

        ``proven`` is a valid frame whose message cannot be used. After ``doubtful``,
        the decoder searches the next frame from the next byte on.
        """
        form, size = packet.form, len(frame)
        count, header = size - form.overhead, frame[: form.header_bytes]

        def fault(why: EventName, id: Optional[int] = None) -> None:
            is_request = form.content == "request"
            events.append(StreamEvent(why, id, header=header, is_request=is_request))

        if count < 0:
            fault("length")
            return "doubtful"
        if not packet.fits(frame):
            fault("framing")
            return "doubtful"
        if not packet.agrees(frame, count):
            fault("length")
            return "doubtful"
        given_id = _id_of(form, frame, size)
        row = packet.row(given_id)
        id = packet.only if given_id is None else given_id
        has_row = form.tells_message
        if packet.checksum and form.check:
            if form.check.is_seeded and row is None and has_row:
                fault("unknown_id", id)
                return "doubtful"
            given = _get(form, packet.checksum, frame, size)
            if given != _checksum(form, row, frame):
                fault("checksum", id)
                return "doubtful"
        if row is None and has_row:
            fault("unknown_id", id)
            return "proven"
        least, most = packet.bounds(row)
        if not least <= count <= most or (row and not packet.awaits(row, frame)):
            fault("length", id)
            return "proven"
        values = {entry.role: _get(form, entry, frame, size) for entry in packet.values}
        if row is None:
            event = StreamEvent("packet", id, frame, values, packet=packet.number)
        elif packet.is_request_of(row):
            event = StreamEvent("request", id, b"", values, header=header)
        else:
            data = frame[form.header_bytes : form.header_bytes + count]
            kind = self._types.which(id, bytes(data))
            event = StreamEvent("message", id, data, values, 0, kind, header=header)
        # If each id has its own sequence, only those of messages are counted.
        if event.event == "message" or not self._form.per_id:
            self._check_sequence(packet, id, values, events)
        events.append(event)
        return "message"

    def _check_sequence(
        self,
        packet: ReceivedPacket,
        id: int,
        values: Mapping[str, int],
        events: list[StreamEvent],
    ) -> None:
        """Check the sequence number, and report a gap."""
        if not packet.sequence:
            return
        number, mask = values["sequence"], (1 << packet.sequence.bits) - 1
        key = id if self._form.per_id else None
        last = self._last.get(key)
        self._last[key] = number
        if last is not None and number != (last + 1) & mask:
            missing = 0 if number == last else (number - last - 1) & mask
            events.append(StreamEvent("gap", id, missing=missing))
