"""Encoder and decoder of the packet format that the ICD describes, for byte streams and
packets.

Reference implementation of the generated encoders and decoders.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping
from typing import NamedTuple

from icdgen.protocol import checks, stuffing
from icdgen.protocol.envelope import GIVEN, PACKET, EnvelopeField, Stream, StreamRow
from icdgen.protocol.errors import LengthError, RangeError, UnknownIdError

# Events of `Decoder`.
MESSAGE = "message"
GAP = "gap"  # sequence numbers were skipped; `missing` 0: the same number was repeated
CHECKSUM = "checksum"  # wrong checksum
BAD_LENGTH = "length"  # length that no message has, or not the message of this id
UNKNOWN_ID = "unknown_id"
OVERRUN = "overrun"  # message longer than the buffer
FRAMING = "framing"  # wrong constant or delimiter


class Event(NamedTuple):
    """Event of the decoder: a message, or the reason why bytes were discarded."""

    event: str
    id: int | None = None
    data: bytes = b""
    values: tuple[tuple[str, int], ...] = ()  # fields whose values the sender chooses
    missing: int = 0


class Verdict(NamedTuple):
    """Result of the check of a frame.

    ``proven``: whether the bytes are certainly a frame, although its id or length may
    be unusable.
    """

    event: Event
    proven: bool
    row: int = 0


def encode(
    form: Stream,
    direction: str,
    id: int,
    data: bytes,
    values: Mapping[str, int] | None = None,
) -> bytes:
    """Return the transmitted bytes of a message.

    ``values``: values of the fields that the sender chooses; the ICD defines their
    defaults. Raises `UnknownIdError`, `LengthError` and `RangeError`.
    """
    row = next((row for row in form.rows(direction) if row.id == id), None)
    if row is None:
        raise UnknownIdError(f"there is no {direction} of id {id}")
    if not row.least <= len(data) <= row.most:
        raise LengthError(row.most if len(data) > row.most else row.least, len(data))
    # Some protocols truncate trailing zeros of the payload, except its first byte.
    if row.cuts_zeros:
        data = data[:1] + data[1:].rstrip(b"\0")
    head, tail = bytearray(form.header_bytes), bytearray(form.trailer_bytes)
    computed = {"id": id, "length": len(data) + form.length_plus}
    for field in form.fields:
        if field.role != "checksum":
            value = computed.get(field.role, field.values[direction == "telemetry"])
            if field.role in GIVEN and values:
                value = values.get(field.role, value)
            _put(field, tail if field.in_trailer else head, value)
    # The checksum is written last: it can cover all other fields.
    place = form.of("checksum")
    if place and form.check:
        _put(
            place,
            tail if place.in_trailer else head,
            _checksum(form, row, bytes(head) + data + bytes(tail)),
        )
    return stuffing.stuffed(form.delimited_by, bytes(head) + data + bytes(tail))


def _put(field: EnvelopeField, into: bytearray, value: int) -> None:
    if not 0 <= value <= field.mask:
        raise RangeError(field.role)
    order, end = "little" if field.little else "big", field.at + field.size
    number = int.from_bytes(into[field.at : end], order) & ~(field.mask << field.shift)  # type: ignore[arg-type]
    into[field.at : end] = (number | value << field.shift).to_bytes(field.size, order)  # type: ignore[arg-type]


def _get(form: Stream, field: EnvelopeField, frame: bytes) -> int:
    at = field.at + (len(frame) - form.trailer_bytes if field.in_trailer else 0)
    number = int.from_bytes(
        frame[at : at + field.size], "little" if field.little else "big"
    )
    return number >> field.shift & field.mask


def _checksum(form: Stream, row: StreamRow | None, frame: bytes) -> int:
    assert form.check
    # Without a checksum in the trailer, the covered part ends with the data.
    end = len(frame) - form.trailer_bytes + form.check.covered_trailer
    seed = bytes([row.seed]) if form.check.is_seeded and row else b""
    return checks.compute(form.check, frame[form.check.covered_from : end] + seed)


class Decoder:
    """Decoder of the messages of one direction.

    ``limit``: bytes of the longest message, and size of the buffer.
    """

    def __init__(self, form: Stream, direction: str, limit: int | None = None) -> None:
        self.form, self.direction = form, direction
        self.limit = form.longest if limit is None else min(limit, form.longest)
        self.rows = form.rows(direction)
        self.buffer = bytearray()
        self.line = stuffing.unstuffer(form.delimited_by, self.limit)
        self.last: dict[int, int] = {}  # last sequence number, by row if `per_id`
        self.discarded = 0  # number of bytes outside of messages

    @property
    def pending(self) -> int:
        """Number of received bytes that are not yet assigned to a message or discarded."""
        return self.line.run if self.line else len(self.buffer)

    def feed(self, data: bytes) -> list[Event]:
        """Process the next bytes of the stream, or a packet."""
        if self.form.delimited_by == PACKET:
            return list(
                self._frame(
                    data, len(data), [OVERRUN] if len(data) > self.limit else []
                )
            )
        return [event for byte in data for event in self._byte(byte)]

    def _byte(self, byte: int) -> Iterator[Event]:
        if self.line:
            for delimited in self.line.feed(byte):
                yield from self._frame(
                    delimited.frame, delimited.size, delimited.faults
                )
            return
        self.buffer.append(byte)
        while (count := (yield from self._front())) is not None:
            del self.buffer[:count]

    def _frame(self, frame: bytes, size: int, faults: list[str]) -> Iterator[Event]:
        """Process a frame between two delimiters, or a packet.

        ``size``: its transmitted bytes.
        """
        if faults:
            yield from (Event(fault) for fault in faults)
            self.discarded += size
        elif not (yield from self._events_of_verdict(self._verdict_of(frame))):
            self.discarded += size

    def _front(self) -> Generator[Event, None, int | None]:
        """Process the start of the buffer.

        Return the number of bytes to remove; None if more bytes are needed.
        """
        form, buffer = self.form, bytes(self.buffer)
        if not buffer:
            return None
        # Check constants as soon as they are complete, to find the next message early.
        for field in form.fields:
            is_there = not field.in_trailer and field.at + field.size <= len(buffer)
            if is_there and self._is_wrong(field, buffer):
                self.discarded += 1
                return 1
        if len(buffer) < form.header_bytes:
            return None
        place = form.of("length")
        assert place
        data = _get(form, place, buffer) - form.length_plus
        size = form.header_bytes + data + form.trailer_bytes
        # After a bad length the next message may begin within this one, so only one
        # byte is discarded.
        if data < 0 or size > form.longest or size > self.limit:
            yield Event(BAD_LENGTH if data < 0 or size > form.longest else OVERRUN)
            self.discarded += 1
            return 1
        if len(buffer) < size:
            return None
        verdict = self._verdict_of(buffer[:size])
        if not (yield from self._events_of_verdict(verdict)):
            # A proven frame is skipped as a whole; otherwise the search continues one
            # byte further.
            size = size if verdict.proven else 1
            self.discarded += size
        return size

    def _events_of_verdict(self, verdict: Verdict) -> Generator[Event, None, bool]:
        """Yield the events of a checked frame. Return whether it is a message."""
        event = verdict.event
        place = self.form.of("sequence")
        if event.event == MESSAGE and place:
            number, key = dict(event.values)["sequence"], (
                verdict.row if self.form.per_id else 0
            )
            last = self.last.get(key)
            self.last[key] = number
            if last is not None and number != (last + 1 & place.mask):
                yield Event(
                    GAP,
                    event.id,
                    missing=0 if number == last else number - last - 1 & place.mask,
                )
        yield event
        return event.event == MESSAGE

    def _is_wrong(self, field: EnvelopeField, frame: bytes) -> bool:
        """Return whether the field is a constant with a wrong value."""
        expected = field.values[self.direction == "telemetry"]
        return field.role == "constant" and _get(self.form, field, frame) != expected

    def _verdict_of(self, frame: bytes) -> Verdict:
        form = self.form
        size = len(frame) - form.header_bytes - form.trailer_bytes
        if size < 0:
            return Verdict(Event(BAD_LENGTH), False)
        if any(self._is_wrong(field, frame) for field in form.fields):
            return Verdict(Event(FRAMING), False)
        place = form.of("length")
        if place and _get(form, place, frame) - form.length_plus != size:
            return Verdict(Event(BAD_LENGTH), False)
        place = form.of("id")
        # A format without id field has a single message.
        id = _get(form, place, frame) if place else self.rows[0].id if self.rows else 0
        number, row = next(
            ((number, row) for number, row in enumerate(self.rows) if row.id == id),
            (0, None),
        )
        # The checksum decides whether the id and the length can be trusted.
        place = form.of("checksum")
        if place and form.check:
            # The seed depends on the id, so the checksum of an unknown id cannot be
            # verified.
            if form.check.is_seeded and row is None:
                return Verdict(Event(UNKNOWN_ID, id), False)
            if _get(form, place, frame) != _checksum(form, row, frame):
                return Verdict(Event(CHECKSUM, id), False)
        if row is None:
            return Verdict(Event(UNKNOWN_ID, id), True)
        if not row.least <= size <= row.most:
            return Verdict(Event(BAD_LENGTH, id), True)
        data = frame[form.header_bytes : form.header_bytes + size]
        fields = {field.role: field for field in form.fields}
        values = tuple(
            (role, _get(form, fields[role], frame)) for role in GIVEN if role in fields
        )
        return Verdict(Event(MESSAGE, id, data, values), True, number)
