"""Line of a framed link: messages with header and trailer, in a stream or in packets.

It implements `lines` with the encoder and decoder of `stream`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Optional, Union

from .._errors import UnknownIdError
from .._hints import Buffer
from .awaited import NO_EXCHANGE, Arrival, Awaited, Plan, Request, awaited_of
from .errors import UnsupportedError, need
from .events import Arrived, Event, Gap, LineError, Stray
from .link import Link
from .packet_formats import Response, StreamRow
from .sender import Sender
from .stream import StreamDecoder, StreamEvent


class StreamLine:
    """The line of a framed link.

    ``values``: values of the frame fields that the sender chooses; see `Sender`.
    """

    has_results = False
    checks_telecommands = True

    def __init__(self, link: Link, values: Optional[Mapping[str, int]]) -> None:
        self._link = link
        self._form = need(link.stream, "stream")
        self._sender = Sender(link, "telecommand", values)
        self._decoder = StreamDecoder(link)

    @property
    def discarded(self) -> int:
        """Number of received bytes that are not part of a message."""
        return self._decoder.discarded

    @property
    def header(self) -> bytes:
        """Header of the last packet."""
        return self._sender.header

    def plan(self, request: Request, reply: Optional[int]) -> Plan:
        """Return how to send a request. Raise as `Line.plan`."""
        row = self._row(request)
        if request.kind == "telemetry":
            if row is None:
                return self._request(request.id)
            request = Request("telemetry", request.id, bytes(row.least), True)
        elif reply is not None and self._form.row("telemetry", reply) is None:
            raise UnknownIdError(self._link.node, "telemetry", reply)
        assert row is not None, "only telemetry is requested by a packet"
        exchange = NO_EXCHANGE
        if row.exchange is not None:
            exchange = self._form.exchanges[row.exchange]
        more: tuple[Response, ...] = ()
        if reply is not None and all(
            each.telemetry != reply
            for each in exchange.responses
            if each.can_be("reply")
        ):
            more = (Response(reply, "reply"),)
        sent = Request("telecommand", row.id, request.data)
        awaited = awaited_of(exchange, sent, None, more, self._nameless(reply))
        repeats = request.repeat or row.repeats
        return Plan(request, sent, (row.least, row.most), awaited, repeats)

    def _request(self, telemetry: int) -> Plan:
        """Return how to request telemetry by a packet with its id."""
        form = need(self._form.request, "requests")
        size = self._form.packets[form.packet].reserved
        request = Request("telemetry", telemetry, bytes(size), True)
        exchange = self._form.exchanges[form.exchange]
        nameless = self._nameless(telemetry)
        awaited = awaited_of(exchange, request, telemetry, (), nameless)
        return Plan(request, request, (size, size), awaited, True)

    def _row(self, request: Request) -> Optional[StreamRow]:
        """Return the telecommand that is sent; None for a request of telemetry by a
        packet.
        """
        rows, id = self._form.telecommands, request.id
        if request.kind == "telecommand":
            row = next((row for row in rows if row.id == id), None)
        else:
            row = next((row for row in rows if row.requests == id), None)
            telemetry = self._form.row("telemetry", id)
            if row is None and telemetry and telemetry.is_requested:
                return None
            if row is None and telemetry:
                what = "is sent unasked: nothing requests it without values"
                raise UnsupportedError(f"telemetry {id} {what}")
        if row is None:
            raise UnknownIdError(self._link.node, request.kind, id)
        return row

    def _nameless(self, telemetry: Optional[int]) -> Optional[StreamRow]:
        """Return telemetry that a packet without its id carries; None for any other."""
        for row in self._form.telemetry:
            if row.id == telemetry:
                content = self._form.packets[row.packet].content
                return row if content == "requested" else None
        return None

    def check(self, request: Request) -> None:
        """Do nothing: each request of the right length can be encoded."""

    def encode(self, request: Request) -> bytes:
        """Return the next encoded message."""
        if request.kind == "telemetry":
            return self._sender.encode_request(request.id)
        return self._sender.encode(request.id, request.data)

    def withdraw(self, unit: object) -> bool:
        """Return False: what was encoded was taken."""
        return False

    def expire(self, now: float) -> list[Event]:
        """Return no events: incomplete messages have no time."""
        return []

    def arrivals(
        self, now: float, received: Buffer, awaited: Callable[[], Iterator[Awaited]]
    ) -> Iterator[Union[Arrival, Event]]:
        """Yield what arrives in a piece of the stream, or in one packet."""
        for event in self._decoder.feed(received):
            yield self._arrival(event, awaited)

    def _arrival(
        self, event: StreamEvent, awaited: Callable[[], Iterator[Awaited]]
    ) -> Union[Arrival, Event]:
        if event.event == "gap":
            return Gap(event.id, event.missing)
        event = self._identified(event, awaited)
        if event.event not in ("message", "packet") or event.id is None:
            return LineError(event.event, event.id)
        id, data, kind = event.id, event.data, event.kind
        unawaited: Event = Arrived(id, data, event.values, kind)
        if event.packet is not None or id in self._form.confirming:
            unawaited = Stray(data, id, kind)
        telemetry = id if event.packet is None else None
        return Arrival(telemetry, event.packet, data, id, data, kind, unawaited)

    def _identified(
        self, event: StreamEvent, awaited: Callable[[], Iterator[Awaited]]
    ) -> StreamEvent:
        """Return the telemetry that a packet without its id carries: that of the request
        whose response it can be. If it has the length of none, return this error.
        Return any other event, and the packet if no response is awaited, unchanged.
        """
        if event.packet is None:
            return event
        packet = self._form.packets[event.packet]
        if packet.content != "requested":
            return event
        data = event.data[packet.header_bytes : -packet.trailer_bytes or None]
        rows = [each.nameless for each in awaited() if each.nameless]
        for row in rows:
            if row.least <= len(data) <= row.most:
                kind = self._link.TELEMETRY.which(row.id, bytes(data))
                return StreamEvent(
                    "message", row.id, data, event.values, event.missing, kind
                )
        return StreamEvent("length", rows[0].id) if rows else event
