"""Messages with the frame format of the ICD, in a byte stream or in packets."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple, Optional, TypeVar, Union, cast

from .._base import Message
from .._errors import LengthError, RangeError, UnknownIdError
from .._hints import Buffer
from .checks import check
from .envelope import Direction, EnvelopeField, Stream, StreamRow
from .errors import need
from .link import Link
from .message_ids import message_id
from .stuffing import Unstuffer, stuffed

M = TypeVar("M", bound=Message)
MessageClass = type[Message]
MessageClassOf = type[M]
EventName = Literal[
    "message", "gap", "checksum", "length", "unknown_id", "overrun", "framing"
]
CHOSEN_ROLES = ("sequence", "source", "destination", "type", "flags", "time")
"""Roles of the frame fields whose values the sender chooses."""


class StreamEvent(NamedTuple):
    """A message, or the reason why bytes were dropped.

    ``gap``: ``missing`` messages were lost before this one; 0 if a message was
    repeated. ``checksum``: the checksum is wrong. ``length``: length mismatch.
    ``unknown_id``: the node has no such message. ``overrun``: longer than the buffer.
    ``framing``: a constant or a delimiter is wrong.
    """

    event: EventName
    id: Optional[int] = None
    data: bytes = b""
    values: Mapping[str, int] = {}
    """For a message: the frame fields that its sender chose, by role."""
    missing: int = 0
    kind: Optional[MessageClass] = None
    """For a message: its class; None if no message of its id matches."""

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
    ``flags`` and ``time``. Defaults are in the ICD. ``direction`` is the direction of
    the message: a device sends ``"telemetry"``. Raise `UnknownIdError`, `LengthError`
    and `RangeError`.
    """
    form = need(link.stream, "stream")
    if unknown := [name for name in values if name not in CHOSEN_ROLES]:
        raise TypeError(
            f"stream_encode() takes no {unknown[0]!r}, but {', '.join(CHOSEN_ROLES)}"
        )
    if isinstance(message, Message):
        if data:
            raise TypeError("a message has its own data; direction= tells who sends it")
        id, data = message_id(link, direction, type(message)), message.to_bytes()
    else:
        id, data = message, bytes(data)
    row = next((row for row in form.rows(direction) if row.id == id), None)
    if row is None:
        raise UnknownIdError(link.node, direction, id)
    if not row.least <= len(data) <= row.most:
        nearest = row.most if len(data) > row.most else row.least
        raise LengthError("a message", nearest, len(data))
    if row.cuts_zeros:
        data = data[:1] + data[1:].rstrip(b"\0")
    head, tail = bytearray(form.header_bytes), bytearray(form.trailer_bytes)
    own_values = {"id": id, "length": len(data) + form.length_plus}
    for field in form.fields:
        if field.role != "checksum":
            value = own_values.get(field.role, field.values[direction == "telemetry"])
            if field.role in CHOSEN_ROLES:
                value = values.get(field.role, value)
            _put(field, tail if field.in_trailer else head, value)
    place = form.of("checksum")
    if place and form.check:
        value = _checksum(form, row, bytes(head) + data + bytes(tail))
        _put(place, tail if place.in_trailer else head, value)
    return stuffed(form.delimited_by, bytes(head) + data + bytes(tail))


def _put(field: EnvelopeField, into: bytearray, value: int) -> None:
    if not 0 <= value < 1 << field.bits:
        raise RangeError(field.role, f"0 to {(1 << field.bits) - 1}", value)
    order: Literal["little", "big"] = "little" if field.little else "big"
    span = slice(field.at, field.at + field.size)
    number = int.from_bytes(into[span], order) | value << field.shift
    into[span] = number.to_bytes(field.size, order)


def _get(form: Stream, field: EnvelopeField, frame: Buffer, size: int) -> int:
    at = field.at + (size - form.trailer_bytes if field.in_trailer else 0)
    order: Literal["little", "big"] = "little" if field.little else "big"
    number = int.from_bytes(frame[at : at + field.size], order)
    return number >> field.shift & ((1 << field.bits) - 1)


def _checksum(form: Stream, row: Optional[StreamRow], frame: bytes) -> int:
    check_form = need(form.check, "checksums")
    end = len(frame) - form.trailer_bytes + check_form.covered_trailer
    seed = bytes((row.seed,)) if check_form.is_seeded and row else b""
    return check(check_form, frame[check_form.covered_from : end] + seed)


class StreamDecoder:
    """Decode the messages of one direction, from pieces of the stream of any size.

    The buffer has ``limit`` bytes, by default the length of the longest message. If
    packets delimit messages, pass each packet separately. Raise `LengthError` if header
    and trailer exceed the limit.
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
        around = form.header_bytes + form.trailer_bytes
        if self._limit < around:
            raise LengthError("the buffer of header and trailer", around, self._limit)
        self._types = link.TELEMETRY if direction == "telemetry" else link.TELECOMMANDS
        self._rows = {row.id: row for row in form.rows(direction)}
        self._only = min(self._rows, default=0)  # the message of a format without id
        self._constants = [
            (field, field.values[direction == "telemetry"])
            for field in form.fields
            if field.role == "constant"
        ]
        self._values = [field for field in form.fields if field.role in CHOSEN_ROLES]
        self._id, self._length, self._sequence, self._checksum = map(
            form.of, ("id", "length", "sequence", "checksum")
        )
        self._buffer = bytearray()
        self._line = (
            None
            if form.delimited_by in ("length", "none")
            else Unstuffer(form.delimited_by, self._limit)
        )
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
                self._frame(frame.bytes, frame.size, frame.fault, events)
        elif self._form.delimited_by == "none":
            fault = "overrun" if len(data) > self._limit else None
            self._frame(data, len(data), fault, events)
        else:
            self._buffer += data
            at = 0
            while (count := self._front(at, events)) is not None:
                at += count
            del self._buffer[:at]  # once per call: deletion copies the remaining bytes
        return events

    def _frame(
        self, frame: bytes, size: int, fault: Optional[str], events: list[StreamEvent]
    ) -> None:
        """Process a frame that is delimited on both sides."""
        if fault:
            events.append(StreamEvent(cast(EventName, fault)))
        elif self._judge(frame, events) == "message":
            return
        self.discarded += size

    def _front(self, at: int, events: list[StreamEvent]) -> Optional[int]:
        """Decode the bytes at an offset of the buffer.

        Return the number of processed bytes, or None if more bytes are needed.
        """
        form, left = self._form, len(self._buffer) - at
        if not left:
            return None
        front = self._buffer[at : at + form.header_bytes]
        for field, value in self._constants:
            is_received = not field.in_trailer and field.at + field.size <= left
            if is_received and _get(form, field, front, 0) != value:
                self.discarded += 1
                return 1
        if left < form.header_bytes:
            return None
        length = need(self._length, "length")
        data = _get(form, length, front, 0) - form.length_plus
        size = form.header_bytes + data + form.trailer_bytes
        if data < 0 or size > self._limit:
            is_overrun = 0 <= data and size <= self._longest
            events.append(StreamEvent("overrun" if is_overrun else "length"))
            self.discarded += 1
            return 1
        if left < size:
            return None
        verdict = self._judge(bytes(self._buffer[at : at + size]), events)
        if verdict != "message":
            size = size if verdict == "proven" else 1
            self.discarded += size
        return size

    def _judge(
        self, frame: bytes, events: list[StreamEvent]
    ) -> Literal["message", "proven", "doubtful"]:
        """Check and decode a frame, and add its events.

        ``proven`` is a valid frame whose message cannot be used. After ``doubtful``,
        the decoder searches the next frame from the next byte on.
        """
        form, size = self._form, len(frame)
        count = size - form.header_bytes - form.trailer_bytes
        if count < 0:
            return self._doubtful("length", None, events)
        for field, value in self._constants:
            if _get(form, field, frame, size) != value:
                return self._doubtful("framing", None, events)
        stated = (
            count if self._length is None else self._stated_length(self._length, frame)
        )
        if stated != count:
            return self._doubtful("length", None, events)
        id = _get(form, self._id, frame, size) if self._id else self._only
        row = self._rows.get(id)
        if self._checksum and form.check:
            if form.check.is_seeded and row is None:
                return self._doubtful("unknown_id", id, events)
            given = _get(form, self._checksum, frame, size)
            if given != _checksum(form, row, frame):
                return self._doubtful("checksum", id, events)
        if row is None:
            events.append(StreamEvent("unknown_id", id))
            return "proven"
        if not row.least <= count <= row.most:
            events.append(StreamEvent("length", id))
            return "proven"
        data = frame[form.header_bytes : form.header_bytes + count]
        values = {entry.role: _get(form, entry, frame, size) for entry in self._values}
        self._check_sequence(id, values, events)
        kind = self._types.which(id, bytes(data))
        events.append(StreamEvent("message", id, data, values, 0, kind))
        return "message"

    def _stated_length(self, length: EnvelopeField, frame: Buffer) -> int:
        """Return the number of data bytes, from the length field."""
        form = self._form
        return _get(form, length, frame, len(frame)) - form.length_plus

    def _doubtful(
        self, why: EventName, id: Optional[int], events: list[StreamEvent]
    ) -> Literal["doubtful"]:
        events.append(StreamEvent(why, id))
        return "doubtful"

    def _check_sequence(
        self, id: int, values: Mapping[str, int], events: list[StreamEvent]
    ) -> None:
        """Check the sequence number, and report a gap."""
        if not self._sequence:
            return
        number, mask = values["sequence"], (1 << self._sequence.bits) - 1
        key = id if self._form.per_id else None
        last = self._last.get(key)
        self._last[key] = number
        if last is not None and number != (last + 1) & mask:
            missing = 0 if number == last else (number - last - 1) & mask
            events.append(StreamEvent("gap", id, missing=missing))
