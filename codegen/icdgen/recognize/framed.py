"""Recognition of messages with header and trailer, as the ICD describes them.

`readings` decodes the data as both directions of each node, with the stream decoder of
the runtime, and chooses the direction that explains the most bytes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Literal

from icdgen_runtime.wire.packet_formats import Direction, Exchange, Response, Stream
from icdgen_runtime.wire.stream import ReceivedPacket, StreamDecoder, StreamEvent

from icdgen.describe.ids import id_text
from icdgen.frozen import NamedTuple
from icdgen.recognize import faults, match
from icdgen.recognize.faults import FrameFault
from icdgen.recognize.reading import (
    ACKNOWLEDGE,
    REFUSAL,
    REQUEST,
    Endpoint,
    FrameReading,
)
from icdgen.recognize.selection import Selection

DIRECTIONS: tuple[Direction, ...] = ("telecommand", "telemetry")


class ByteSpan(NamedTuple):
    """Bytes of the input from ``at`` to before ``end``."""

    at: int
    end: int

    @property
    def size(self) -> int:
        """Return the number of bytes."""
        return self.end - self.at

    def mark(self, taken: bytearray) -> None:
        """Mark the bytes in a map of the input."""
        taken[self.at : self.end] = b"\1" * (self.end - self.at)

    def is_free(self, taken: bytearray) -> bool:
        """Return whether no byte is marked."""
        return taken.find(1, self.at, self.end) < 0


class _RecordingDecoder(StreamDecoder):
    """Decoder that also records the position and the bytes of each packet."""

    def __init__(self, endpoint: Endpoint, direction: Direction) -> None:
        super().__init__(endpoint.link, direction)
        # By the index of the event
        self.packets: dict[int, tuple[ByteSpan, bytes]] = {}
        self._at = self._end = 0

    def _skip(self, size: int) -> None:
        self._end += size
        super()._skip(size)

    def _frame(
        self, frame: bytes, size: int, fault: str | None, events: list[StreamEvent]
    ) -> None:
        # Before the call, because it calls `_judge`, which needs the position.
        self._at, self._end = self._end, self._end + size
        super()._frame(frame, size, fault, events)
        if fault:
            self.packets[len(events) - 1] = ByteSpan(self._at, self._end), frame

    def _front(self, at: int, events: list[StreamEvent]) -> int | None:
        self._at, before = at, len(events)
        count = super()._front(at, events)
        # The length field is invalid.
        if len(events) > before and len(events) - 1 not in self.packets:
            longest = max(packet.form.header_bytes for packet in self._packets)
            header = self._buffer[at : at + longest]
            self.packets[len(events) - 1] = ByteSpan(at, at + 1), bytes(header)
        return count

    def _judge(
        self, packet: ReceivedPacket, frame: bytes, events: list[StreamEvent]
    ) -> Literal["message", "proven", "doubtful"]:
        verdict = super()._judge(packet, frame, events)
        end = self._end if self._line else self._at + len(frame)
        self.packets[len(events) - 1] = ByteSpan(self._at, end), frame
        return verdict


@dataclass(frozen=True, slots=True)
class DirectionResult:
    """Messages and faults of one direction. ``lost`` is the number of unused bytes.

    ``readings`` has the possible messages of each packet with a message. There are
    several if only the preceding request identifies the message.
    """

    endpoint: Endpoint
    direction: Direction
    lost: int
    readings: list[list[FrameReading]] = field(default_factory=list)
    spans: list[ByteSpan] = field(default_factory=list)  # one per reading
    faults: list[tuple[ByteSpan, FrameFault]] = field(default_factory=list)


def readings(
    endpoints: Sequence[Endpoint], data: bytes, selection: Selection
) -> list[FrameReading]:
    """Return the messages in the data, including messages of the other direction.

    The direction with the fewest unused bytes is chosen, among those with a message
    that the user has named. The list may be empty.

    Raise `BadLength` or `NotFound` for a packet that is cut off, damaged or unknown,
    and `Ambiguous`.
    """
    results: list[DirectionResult] = []
    for endpoint in endpoints:
        form = endpoint.facts.stream
        for direction in DIRECTIONS if form else ():
            if form and form.packets_of(direction):
                results.append(_decode_direction(endpoint, direction, data))
    # Without a constant or a checksum, nearly any bytes look like a packet. Then all of
    # them must belong to packets.
    usable = [
        result
        for result in results
        if result.readings and (result.lost == 0 or _is_marked(result.endpoint))
    ]
    if not usable:
        if fault := _likeliest(results):
            raise fault.error
        return []
    usable = [
        result
        for result in usable
        if any(map(selection.fits, chain.from_iterable(result.readings)))
    ] or usable
    best = _best_results(usable)
    requests = _requests(usable)

    def decided(span: ByteSpan, candidates: list[FrameReading]) -> FrameReading:
        # A response belongs to the last request in front of it.
        before = [request for at, request in requests if at < span.at]
        requested = [
            candidate
            for candidate in candidates
            if before
            and candidate.endpoint.node is before[-1].endpoint.node
            and candidate.message is before[-1].message
        ]
        return match.most_likely(requested or candidates, "a packet", selection)

    chosen = {}
    lost = best[0].lost
    # All of the best results have the same number of packets.
    for at in range(len(best[0].readings)):
        readings = [each for result in best for each in result.readings[at]]
        chosen[best[0].spans[at]] = decided(best[0].spans[at], readings)
    taken = bytearray(len(data))
    for span in chosen:
        span.mark(taken)
    opposite = [
        result
        for result in usable
        if result not in best
        and any(result.endpoint is candidate.endpoint for candidate in best)
    ]
    for candidate in opposite:
        for span, readings in zip(candidate.spans, candidate.readings, strict=True):
            if span.is_free(taken):
                chosen[span] = decided(span, readings)
                span.mark(taken)
                # The decoder of the chosen direction has counted these bytes as unused.
                lost -= span.size
    reports = _left_out(
        [result for result in results if result.endpoint is best[0].endpoint], taken
    )
    first, *remaining = [chosen[span] for span in sorted(chosen)]
    return [
        first.with_left_out(*reports).with_remarks(*match.stream_remarks(lost, ())),
        *remaining,
    ]


def _best_results(usable: list[DirectionResult]) -> list[DirectionResult]:
    """Return the results with the fewest unused bytes, then the most packets.

    There are several if both directions, or several nodes, explain the same packets.
    """

    def rank(result: DirectionResult) -> tuple[int, int]:
        return result.lost, -len(result.readings)

    best_rank = min(map(rank, usable))
    best = [result for result in usable if rank(result) == best_rank]
    # Packets of the opposite direction at other places are no alternatives.
    return [
        result
        for result in best
        if result.spans == best[0].spans or result.endpoint is not best[0].endpoint
    ]


def begun(endpoints: Sequence[Endpoint], data: bytes) -> FrameFault | None:
    """Return the fault of bytes that begin like a packet, otherwise None."""
    begun_faults = []
    for endpoint in endpoints:
        form = endpoint.link.stream
        for direction in DIRECTIONS if form else ():
            if form and faults.begins_packet(form, direction, data):
                packet = faults.packet_begun(endpoint, direction, data)
                begun_faults.append(faults.fault_of(endpoint, direction, *packet))
    return max(filter(None, begun_faults), key=lambda fault: fault.rank, default=None)


def _left_out(results: Sequence[DirectionResult], taken: bytearray) -> list[str]:
    """Return the faults of all other packets.

    If both directions explain a packet, the better match of its header is used.
    """
    likeliest: dict[int, tuple[ByteSpan, FrameFault]] = {}
    for result in results:
        for span, fault in result.faults:
            if not span.is_free(taken):
                continue
            if span.at not in likeliest or fault.rank > likeliest[span.at][1].rank:
                likeliest[span.at] = span, fault
    texts, end = [], 0
    for at, (span, fault) in sorted(likeliest.items()):
        if at >= end:  # bytes within a damaged packet only look like another packet
            texts.append(fault.text)
        end = max(end, span.end)
    return texts


def sync_of(endpoint: Endpoint) -> str:
    """Return the first bytes of the packets of a node, for a report."""
    form = endpoint.link.stream
    if form is None:
        return ""
    texts: dict[str, None] = {}
    for direction in DIRECTIONS:
        for packet in form.packets_of(direction):
            texts[faults.sync_text(form, packet, direction)] = None
    return " or ".join(filter(None, texts))


def _likeliest(results: Sequence[DirectionResult]) -> FrameFault | None:
    """Return the fault of the first packet, for the direction whose header matches
    best.
    """
    firsts = [
        result.faults[0]
        for result in results
        if result.faults and _is_marked(result.endpoint)
    ]
    at = min((span.at for span, _ in firsts), default=0)
    fitting = [fault for span, fault in firsts if span.at == at]
    return max(fitting, key=lambda fault: fault.rank, default=None)


def _is_marked(endpoint: Endpoint) -> bool:
    """Return whether messages have a constant or a checksum."""
    form = endpoint.facts.stream
    return form is not None and all(
        packet.check is not None or packet.of("constant") is not None
        for packet in form.packets
    )


def _decode_direction(
    endpoint: Endpoint, direction: Direction, data: bytes
) -> DirectionResult:
    """Decode the data as messages of one direction."""
    decoder = _RecordingDecoder(endpoint, direction)
    events = decoder.feed(data)
    readings = {
        number: list(_candidates(endpoint, direction, event))
        for number, event in enumerate(events)
        if event.event in ("message", "request", "packet")
    }
    # Packets of nothing in the ICD are valid for the decoder.
    unread = sum(
        decoder.packets[number][0].size
        for number, reading in readings.items()
        if not reading
    )
    lost = decoder.discarded + decoder.pending + unread
    result = DirectionResult(endpoint, direction, lost)
    for number, event in enumerate(events):
        # A gap in the sequence numbers is about packets that are missing here.
        if event.event == "gap" or number not in decoder.packets:
            continue
        span, packet = decoder.packets[number]
        reading = readings.get(number)
        if reading:
            result.readings.append(reading)
            result.spans.append(span)
        elif fault := _fault(endpoint, direction, packet, event.event != "framing"):
            result.faults.append((span, fault))
    if decoder.pending:
        begin = len(data) - decoder.pending
        beginning = faults.packet_begun(endpoint, direction, data[begin:])
        if fault := _fault(endpoint, direction, *beginning):
            result.faults.append((ByteSpan(begin, len(data)), fault))
    return result


def _fault(
    endpoint: Endpoint, direction: Direction, packet: bytes, is_whole: bool
) -> FrameFault | None:
    """Return the fault of a packet, or None if the bytes may as well be noise."""
    fault = faults.fault_of(endpoint, direction, packet, is_whole)
    form = endpoint.link.stream
    if fault is None or form is None:
        return None
    is_packet = fault.is_of_message or faults.has_sync(form, direction)
    return fault if is_packet else None


def _requests(results: Sequence[DirectionResult]) -> list[tuple[int, FrameReading]]:
    """Return where requests of telemetry begin, and what they request, in order."""
    requests: list[tuple[int, FrameReading]] = []
    for result in results:
        for span, readings in zip(result.spans, result.readings, strict=True):
            requests += [
                (span.at, reading) for reading in readings if reading.what == REQUEST
            ]
    return sorted(requests, key=lambda request: request[0])


def _candidates(
    endpoint: Endpoint, direction: Direction, event: StreamEvent
) -> Iterator[FrameReading]:
    """Yield the possible messages of a packet.

    There are several if the packet has requested telemetry without its id. Only the
    preceding request then identifies the telemetry.
    """
    form = endpoint.link.stream
    if form is None or event.packet is None:
        reading = _reading(endpoint, direction, event)
    elif form.packets[event.packet].content == "requested":
        yield from _nameless(endpoint, form, event.packet, event)
        return
    else:
        reading = _response(endpoint, event)
    if reading:
        yield reading


def _nameless(
    endpoint: Endpoint, form: Stream, number: int, event: StreamEvent
) -> Iterator[FrameReading]:
    """Yield the telemetry that can be in a packet without its id."""
    packet = form.packets[number]
    data = event.data[packet.header_bytes : len(event.data) - packet.trailer_bytes]
    for row in form.telemetry:
        if row.packet != number or not row.least <= len(data) <= row.most:
            continue
        named = event._replace(event="message", id=row.id, data=data)
        reading = _reading(endpoint, "telemetry", named)
        if reading:
            # The packet does not transmit the id.
            yield replace(reading, id=None, remarks=(f"packet `{packet.name}`",))


def _reading(
    endpoint: Endpoint, direction: Direction, event: StreamEvent
) -> FrameReading | None:
    """Return the message of an event; None if no message matches its data."""
    if event.event == "request":
        return _request(endpoint, event)
    assert event.id is not None
    variants = getattr(endpoint.ids, direction)
    message = match.message_of(
        endpoint.icd,
        [variant.message for variant in variants.get(event.id, ())],
        event.data,
    )
    if (
        message is None
        or match.counter_error(endpoint, message, event.data) is not None
    ):
        return None
    return FrameReading(
        endpoint,
        direction,
        message,
        event.id,
        event.data,
        checked=_is_checked(endpoint, direction, event.id),
        remarks=(_note(endpoint, event),),
    )


def _note(endpoint: Endpoint, event: StreamEvent) -> str:
    """Return the text about header and trailer of a packet."""
    chosen = ", ".join(f"{role} {value}" for role, value in event.values.items())
    note = f"header with id {id_text(endpoint.facts.stream, event.id or 0)} removed"
    return note + (f"; it has {chosen}" if chosen else "")


def _is_checked(endpoint: Endpoint, direction: Direction, id: int) -> bool:
    """Return whether the packet of a message has a checksum."""
    form = endpoint.link.stream
    row = form.row(direction, id) if form else None
    if form is None or row is None:
        return False
    return form.packets[row.packet].check is not None


def _request(endpoint: Endpoint, event: StreamEvent) -> FrameReading | None:
    """Return the request of telemetry."""
    form, id = endpoint.link.stream, event.id or 0
    variants = endpoint.ids.telemetry.get(id, ())
    if form is None or form.request is None or not variants:
        return None
    return FrameReading(
        endpoint,
        REQUEST,
        variants[0].message,
        id,
        checked=form.packets[form.request.packet].check is not None,
        remarks=(_note(endpoint, event),),
    )


def _response(endpoint: Endpoint, event: StreamEvent) -> FrameReading | None:
    """Return the response in a packet without a message, to the message with its id.

    Return None if the packet does not respond to a message with this id.
    """
    form, id = endpoint.link.stream, event.id or 0
    # A packet without id says nothing about a message.
    if form is None or event.packet is None or not form.packets[event.packet].of("id"):
        return None
    packet, ids = form.packets[event.packet], endpoint.ids
    for direction, response in _responses(form, event.packet, id):
        is_refusal = faults.is_refusal(response, event.data)
        code = response.reason.of(event.data) if response.reason else None
        names = [f"reason {name}" for value, name in response.reasons if value == code]
        variants = ids.telemetry if direction == "telemetry" else ids.telecommand
        return FrameReading(
            endpoint,
            REFUSAL if is_refusal else ACKNOWLEDGE,
            variants[id][0].message,
            id,
            error=code if is_refusal else None,
            checked=packet.check is not None,
            remarks=(f"packet `{packet.name}`", *(names if is_refusal else [])),
        )
    return None


def _responses(
    form: Stream, packet: int, id: int
) -> Iterator[tuple[Direction, Response]]:
    """Yield the possible responses of a packet with an id, each with the direction of
    the message to which it responds.

    Responses that the ICD declares for this id come first.
    """
    telemetry, telecommand = form.row("telemetry", id), form.row("telecommand", id)
    declared: list[tuple[Direction, Iterable[Exchange]]] = []
    if form.request and telemetry and telemetry.is_requested:
        declared.append(("telemetry", [form.exchanges[form.request.exchange]]))
    if telecommand and telecommand.exchange is not None:
        declared.append(("telecommand", [form.exchanges[telecommand.exchange]]))
    if telemetry:
        declared.append(("telemetry", form.exchanges))
    if telecommand:
        declared.append(("telecommand", form.exchanges))
    for direction, exchanges in declared:
        for exchange in exchanges:
            for response in exchange.responses:
                if response.packet == packet:
                    yield direction, response
