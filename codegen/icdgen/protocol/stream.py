"""Messages in the envelope that the ICD describes, in a stream of bytes or in packets: the reference."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping
from typing import NamedTuple

from icdgen.protocol import checks, stuffing
from icdgen.protocol.envelope import GIVEN, PACKET, EnvelopeField, Stream, StreamRow
from icdgen.protocol.errors import LengthError, RangeError, UnknownIdError

MESSAGE = "message"
GAP = "gap"  # sequence numbers that did not come; none: the same came again
CHECKSUM = "checksum"  # the checksum is not that of the message
BAD_LENGTH = "length"  # a length that no message, or not this one, has
UNKNOWN_ID = "unknown_id"
OVERRUN = "overrun"  # a message longer than the buffer
FRAMING = "framing"  # a constant or a delimiter is not what it must be


class Event(NamedTuple):
    """What the decoder found: a message, or what it dropped and why."""

    event: str
    id: int | None = None
    data: bytes = b""
    values: tuple[tuple[str, int], ...] = ()  # of the fields that the sender chooses
    missing: int = 0


class Verdict(NamedTuple):
    """What a frame is. If ``proven``, it is one beyond doubt, though not always one of use."""

    event: Event
    proven: bool
    row: int = 0


def encode(form: Stream, direction: str, id: int, data: bytes, values: Mapping[str, int] | None = None) -> bytes:
    """A message as it is sent. ``values``: of the fields that the sender chooses, those of the ICD unless given."""
    row = next((row for row in form.rows(direction) if row.id == id), None)
    if row is None:
        raise UnknownIdError(f"there is no {direction} of id {id}")
    if not row.least <= len(data) <= row.most:
        raise LengthError(row.most if len(data) > row.most else row.least, len(data))
    if row.cuts_zeros:
        data = data[:1] + data[1:].rstrip(b"\0")
    head, tail = bytearray(form.header_bytes), bytearray(form.trailer_bytes)
    known = {"id": id, "length": len(data) + form.length_plus}
    for field in form.fields:
        if field.role != "checksum":
            value = known.get(field.role, field.values[direction == "telemetry"])
            if field.role in GIVEN and values:
                value = values.get(field.role, value)
            _put(field, tail if field.in_trailer else head, value)
    place = form.of("checksum")
    if place and form.check:
        _put(place, tail if place.in_trailer else head, _checksum(form, row, bytes(head) + data + bytes(tail)))
    return stuffing.stuffed(form.delimited_by, bytes(head) + data + bytes(tail))


def _put(field: EnvelopeField, into: bytearray, value: int) -> None:
    if not 0 <= value <= field.mask:
        raise RangeError(field.role)
    order, end = "little" if field.little else "big", field.at + field.size
    number = int.from_bytes(into[field.at : end], order) & ~(field.mask << field.shift)  # type: ignore[arg-type]
    into[field.at : end] = (number | value << field.shift).to_bytes(field.size, order)  # type: ignore[arg-type]


def _get(form: Stream, field: EnvelopeField, frame: bytes) -> int:
    at = field.at + (len(frame) - form.trailer_bytes if field.in_trailer else 0)
    number = int.from_bytes(frame[at : at + field.size], "little" if field.little else "big")
    return number >> field.shift & field.mask


def _checksum(form: Stream, row: StreamRow | None, frame: bytes) -> int:
    assert form.check
    end = len(frame) - form.trailer_bytes + form.check.covered_trailer
    seed = bytes([row.seed]) if form.check.is_seeded and row else b""
    return checks.compute(form.check, frame[form.check.covered_from : end] + seed)


class Decoder:
    """Finds the messages of a direction. ``limit``: bytes of the longest message, and of the buffer."""

    def __init__(self, form: Stream, direction: str, limit: int | None = None) -> None:
        self.form, self.direction = form, direction
        self.limit = form.longest if limit is None else min(limit, form.longest)
        self.rows = form.rows(direction)
        self.buffer = bytearray()
        self.line = stuffing.unstuffer(form.delimited_by, self.limit)
        self.last: dict[int, int] = {}  # sequence numbers
        self.discarded = 0  # bytes of the stream that became part of no message

    @property
    def pending(self) -> int:
        """Bytes of the stream about which nothing is decided yet."""
        return self.line.run if self.line else len(self.buffer)

    def feed(self, data: bytes) -> list[Event]:
        """Takes the next bytes of the stream, or a packet."""
        if self.form.delimited_by == PACKET:
            return list(self._frame(data, len(data), [OVERRUN] if len(data) > self.limit else []))
        return [event for byte in data for event in self._byte(byte)]

    def _byte(self, byte: int) -> Iterator[Event]:
        if self.line:
            for found in self.line.feed(byte):
                yield from self._frame(found.frame, found.size, found.faults)
            return
        self.buffer.append(byte)
        while (count := (yield from self._front())) is not None:
            del self.buffer[:count]

    def _frame(self, frame: bytes, size: int, faults: list[str]) -> Iterator[Event]:
        """Something that is delimited from both sides; ``size``: its bytes on the line."""
        if faults:
            yield from (Event(fault) for fault in faults)
            self.discarded += size
        elif not (yield from self._told(self._judged(frame))):
            self.discarded += size

    def _front(self) -> Generator[Event, None, int | None]:
        """What the buffer begins with: bytes to take away, None while that is not decided."""
        form, buffer = self.form, bytes(self.buffer)
        if not buffer:
            return None
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
        if data < 0 or size > form.longest or size > self.limit:
            yield Event(BAD_LENGTH if data < 0 or size > form.longest else OVERRUN)
            self.discarded += 1
            return 1
        if len(buffer) < size:
            return None
        verdict = self._judged(buffer[:size])
        if not (yield from self._told(verdict)):
            size = size if verdict.proven else 1
            self.discarded += size
        return size

    def _told(self, verdict: Verdict) -> Generator[Event, None, bool]:
        """Tells of a frame; whether it is a message."""
        event = verdict.event
        place = self.form.of("sequence")
        if event.event == MESSAGE and place:
            number, key = dict(event.values)["sequence"], verdict.row if self.form.per_id else 0
            last = self.last.get(key)
            self.last[key] = number
            if last is not None and number != (last + 1 & place.mask):
                yield Event(GAP, event.id, missing=0 if number == last else number - last - 1 & place.mask)
        yield event
        return event.event == MESSAGE

    def _is_wrong(self, field: EnvelopeField, frame: bytes) -> bool:
        """Whether it is a constant that has another value."""
        expected = field.values[self.direction == "telemetry"]
        return field.role == "constant" and _get(self.form, field, frame) != expected

    def _judged(self, frame: bytes) -> Verdict:
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
        id = _get(form, place, frame) if place else self.rows[0].id if self.rows else 0
        number, row = next(((number, row) for number, row in enumerate(self.rows) if row.id == id), (0, None))
        place = form.of("checksum")
        if place and form.check:
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
        values = tuple((role, _get(form, fields[role], frame)) for role in GIVEN if role in fields)
        return Verdict(Event(MESSAGE, id, data, values), True, number)
