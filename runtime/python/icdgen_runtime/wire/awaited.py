"""Responses that a client waits for, and requests in progress.

`Awaited` decides whether an arrival responds to a request. `LateResponses` stores what
may still arrive after a time-out, so that it is not taken for the response to a later
request.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple, Optional

from .._base import Message
from .events import Event, MessageClass
from .link import Number
from .packet_formats import Direction, Exchange, Response, StreamRow, Verdict

MOST_AWAITED = 8
"""Largest number of requests whose responses are awaited or may still arrive late, and of
I2C transactions whose results are awaited.
"""
NO_EXCHANGE = Exchange((), ())
"""Exchange of a telecommand that nothing responds to."""
ID_BYTES = 4
"""Bytes of the id in front of the data of a telecommand, in `Exchange.sources`."""
_NEEDED: tuple[Verdict, ...] = ("ack", "reply")


class Request(NamedTuple):
    """A request to a node.

    ``repeat``: whether it may be sent again although the node may have received it.
    Requests of telemetry and settings may always be sent again.
    """

    kind: Direction
    id: int
    data: bytes = b""
    repeat: bool = False


class Arrival(NamedTuple):
    """Telemetry, or a packet without a message, that a link brought."""

    telemetry: Optional[int]
    """Id of the telemetry; None for a packet."""
    packet: Optional[int]
    """Index of the packet; None for telemetry."""
    content: bytes
    """Bytes in which the places of echoes and reasons count."""
    id: int
    """Id that events report."""
    data: bytes
    """Data that events report."""
    type: Optional[MessageClass]
    """Class of the telemetry."""
    unawaited: Event
    """Event if it is no response to any request."""


class Awaited(NamedTuple):
    """Responses to a request: what can arrive, and the numbers that it must repeat."""

    responses: tuple[Response, ...]
    sources: tuple[Optional[int], ...]
    """Numbers of the request that responses can repeat. Numbers of its header are None
    until it has been sent.
    """
    exchange: Exchange
    nameless: Optional[StreamRow] = None
    """Expected telemetry that a packet without its id carries."""
    is_in_order: bool = False
    """Whether the response arrives with its request, as on I2C, so that it cannot be taken
    for another one, or arrive late.
    """

    def sent(self, header: bytes) -> Awaited:
        """Return the responses to a packet that was sent with this header."""
        if not self.exchange.in_header:
            return self
        plain = self.sources[: -self.exchange.in_header]
        return self._replace(sources=(*plain, *self.exchange.numbers_in(header)))

    def _is_in_message(self, source: int) -> bool:
        """Return whether a number is in id and data, so that it is known before it is
        sent.
        """
        return source < len(self.sources) - self.exchange.in_header

    @property
    def needed(self) -> frozenset[Verdict]:
        """Return the responses without which a request is not done."""
        return frozenset(
            verdict
            for verdict in _NEEDED
            if any(response.can_be(verdict) for response in self.responses)
        )

    def matching(self, arrival: Arrival) -> Optional[Response]:
        """Return the response that has arrived; None if no response matches."""
        key = arrival.telemetry, arrival.packet
        for response in self.responses:
            if (response.telemetry, response.packet) == key and all(
                echo.place.of(arrival.content) == self.sources[echo.source]
                for echo in response.echoes
            ):
                return response
        return None

    def is_like(self, other: Awaited) -> bool:
        """Return whether a response to one request could be taken for a response to the
        other.
        """
        if self.is_in_order or other.is_in_order:
            return False
        if self.nameless and other.nameless:
            return True
        return any(
            (mine.telemetry, mine.packet) == (theirs.telemetry, theirs.packet)
            and not any(
                echo.place == repeated.place
                and self._is_in_message(echo.source)
                and other._is_in_message(repeated.source)
                and self.sources[echo.source] != other.sources[repeated.source]
                for echo in mine.echoes
                for repeated in theirs.echoes
            )
            for mine in self.responses
            for theirs in other.responses
        )


def awaited_of(
    exchange: Exchange,
    request: Request,
    requested: Optional[int] = None,
    more: tuple[Response, ...] = (),
    nameless: Optional[StreamRow] = None,
    is_in_order: bool = False,
) -> Awaited:
    """Return the responses to what is sent.

    ``requested``: id of the telemetry, if an exchange of all requests of telemetry does
    not name it. ``more`` are responses that replace the replies of the exchange.
    """
    responses = tuple(
        (
            each._replace(telemetry=requested)
            if (each.telemetry, each.packet) == (None, None)
            else each
        )
        for each in exchange.responses
    )
    if more:
        responses = (*(each for each in responses if not each.can_be("reply")), *more)
    sent = request.id.to_bytes(ID_BYTES, "big") + request.data
    # The header, which can have a sequence number, is encoded when the request is sent.
    unknown = [None] * exchange.in_header
    sources = (*exchange.numbers(sent), *unknown)
    return Awaited(responses, sources, exchange, nameless, is_in_order)


class Owed:
    """Numbers of responses that may still arrive, for each needed verdict.

    One number for all verdicts would not do: an acknowledge that comes twice would
    count as the reply that is still missing.
    """

    def __init__(self, needed: frozenset[Verdict]) -> None:
        self._numbers = dict.fromkeys(needed, 0)

    def __bool__(self) -> bool:
        return any(self._numbers.values())

    def add_transmission(self) -> None:
        """Count the responses to one more transmission."""
        for verdict in self._numbers:
            self._numbers[verdict] += 1

    def remove(self, received: Verdict) -> None:
        """Count off what has arrived: a refusal replaces all responses."""
        if received == "progress":
            return
        for verdict, number in self._numbers.items():
            if number and (received == verdict or received not in _NEEDED):
                self._numbers[verdict] = number - 1

    def clear(self) -> None:
        """Expect no response: the device has received none of the transmissions."""
        self._numbers = dict.fromkeys(self._numbers, 0)


class Plan(NamedTuple):
    """How a request is sent, and the responses to it."""

    request: Request
    """The request of the caller, with the data that are sent."""
    sent: Request
    """The telecommand that is sent, or the request of telemetry by a packet."""
    lengths: tuple[int, int]
    """Smallest and largest number of bytes of data."""
    awaited: Awaited
    repeats: bool
    """Whether it may be sent again after a time-out."""


@dataclass(eq=False)
class Slot:
    """A request in progress."""

    handle: int
    plan: Plan
    timeout: Number
    kind: Optional[type[Message]]  # class of the reply, if the caller gave it
    # "sent": nothing responds to it; "wait": for a response, or for the result of a
    # transaction; "pause": the device is busy, or until the next poll or attempt
    state: Literal["queued", "sent", "wait", "pause"] = "queued"
    attempts: int = 0
    until: float = 0  # end of the state
    latest: float = 0  # until when a response is in time
    limit: float = 0  # until when progress extends `latest`
    missing: frozenset[Verdict] = frozenset()
    unit: object = None  # what was sent and waits for a response
    is_polled: bool = False  # the telecommand is transmitted, its response is polled
    poll_end: Optional[float] = None  # when a pause on I2C can be the last
    awaited: Awaited = field(init=False)
    owed: Owed = field(init=False)

    def __post_init__(self) -> None:
        self.awaited = awaited = self.plan.awaited
        self.owed = Owed(frozenset() if awaited.is_in_order else awaited.needed)

    @property
    def is_awaited(self) -> bool:
        """Whether a response may arrive, also to an earlier attempt."""
        return self.state == "wait" or bool(self.owed)


@dataclass(eq=False)
class LateResponses:
    """Responses that may still arrive although their request has ended."""

    awaited: Awaited
    owed: Owed
    until: float
