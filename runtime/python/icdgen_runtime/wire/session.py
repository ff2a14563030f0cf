"""Blocking client over any port.

`Session` adds a transport and a clock to `client`, and waits until a request has ended.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Optional, Union, overload

from .._base import Message
from .._hints import N
from .awaited import Request
from .carriers import carrier_of
from .events import Event, Outcome, OutcomeOf
from .exchanges import (
    Exchange,
    Exchanges,
    P,
    Progress,
    T,
    client_of,
    data_of,
    executed,
    outcome_of,
)
from .link import Link, Settings
from .message_ids import M2, M3, M, NodeMessage, NodeMessageClass, class_of, message_of
from .ports import Port, Read, Write


class BusSession(Exchanges[N]):
    """Blocking client over the transport of ``_flush`` and ``_receive``."""

    def get(self, message: NodeMessageClass[N, M]) -> M:
        """Request telemetry or read a configuration.

        Raise `RefusedError`, `ReplyTimeoutError` and the exceptions of
        `Client.request`.
        """
        outcome = self._run(self._exchange(self.client.request, message))
        return class_of(message).from_bytes(data_of(outcome, class_of(message).NAME))

    def ask(self, message: NodeMessageClass[N, M]) -> OutcomeOf[M]:
        """Request telemetry or read a configuration; return the outcome.

        Raise the exceptions of `Client.request`.
        """
        outcome = self._run(self._exchange(self.client.request, message))
        return outcome_of(outcome, class_of(message))

    @overload
    def get_several(
        self, first: NodeMessageClass[N, M], second: NodeMessageClass[N, M2], /
    ) -> tuple[M, M2]: ...

    @overload
    def get_several(
        self,
        first: NodeMessageClass[N, M],
        second: NodeMessageClass[N, M2],
        third: NodeMessageClass[N, M3],
        /,
    ) -> tuple[M, M2, M3]: ...

    @overload
    def get_several(self, *messages: NodeMessageClass[N, M]) -> tuple[M, ...]: ...

    def get_several(self, *messages: NodeMessageClass[N, Any]) -> tuple[Any, ...]:
        """Request several telemetry messages, at once if the link allows it.

        Raises as `get`; the other requests are then cancelled.
        """
        exchanges = [
            self._exchange(self.client.request, message) for message in messages
        ]
        outcomes = self._run(self._concurrently(exchanges))
        return tuple(
            class_of(message).from_bytes(data_of(outcome, class_of(message).NAME))
            for message, outcome in zip(messages, outcomes)
        )

    def send(self, message: NodeMessage[N], repeat: bool = False) -> None:
        """Send a telecommand or set a configuration.

        Raise as `get` and `Client.send`.
        """
        outcome = self._run(self._exchange(self.client.send, message, repeat))
        executed(outcome, message_of(message).NAME)

    def answer(
        self,
        message: NodeMessage[N],
        reply: NodeMessageClass[N, M],
        repeat: bool = False,
    ) -> M:
        """Send a telecommand (on a framed link) and return its reply.

        Raise as `get` and `Client.send`.
        """
        outcome = self._run(self._exchange(self.client.send, message, repeat, reply))
        name = message_of(message).NAME
        return class_of(reply).from_bytes(data_of(outcome, name))

    @overload
    def messages(self, *, seconds: Optional[float] = None) -> Iterator[Message]: ...

    @overload
    def messages(
        self,
        kind: NodeMessageClass[N, M],
        /,
        *more_kinds: NodeMessageClass[N, M],
        seconds: Optional[float] = None,
    ) -> Iterator[M]: ...

    def messages(
        self, *kinds: NodeMessageClass[N, Message], seconds: Optional[float] = None
    ) -> Iterator[Message]:
        """Iterate over unsolicited messages, without end or for this number of seconds.

        ``kinds`` selects message classes; without it, all are returned. Other events
        are passed to ``on_event``.
        """
        end = None if seconds is None else self._now() + 1000 * seconds
        while end is None or self._now() < end:
            yield from self._messages_in(self.wait(end), kinds)

    def start(self, request: Request) -> Outcome:
        """Send any request and return its outcome. Raise as `Client.start`."""
        return self._run(self._exchange(self.client.start, request))

    def run(self, procedure: P, progress: Optional[Progress] = None) -> P:
        """Run a procedure to its end. Call ``progress`` with bytes done and total.

        The acknowledge may be damaged if its error code is not defined in the ICD. The
        request is then sent again if possible, and otherwise treated as a timeout.
        Raise `FailedError`.
        """
        return self._run(self._procedure(procedure, progress))

    def wait(self, until: Optional[float] = None) -> list[Event]:
        """Return the next events, until ``until`` (milliseconds of the clock).

        Without ``until``, wait until the deadline of the client, but at most one
        second.
        """
        self._flush()
        events = self._receive(self._seconds(until))
        self._flush()
        return self._report_unsolicited(events)

    def _run(self, exchange: Exchange[T]) -> T:
        try:
            step = next(exchange)
            while True:
                if step == "send":
                    self._flush()
                    step = exchange.send([])
                else:
                    step = exchange.send(self.wait(step))
        except StopIteration as end:
            result: T = end.value
            return result
        finally:
            exchange.close()

    def _flush(self) -> None:
        """Send the pending output of the client."""
        raise NotImplementedError

    def _receive(self, seconds: float) -> list[Event]:
        """Pass received data to the client, or process a timeout."""
        raise NotImplementedError


class Session(BusSession[N]):
    """Blocking client over a port.

    The application opens the port: a serial port (pyserial), a connected TCP or UDP
    socket, a CAN bus (python-can) or an I2C bus (smbus2). For any other byte transport,
    pass two functions. ``write(data)`` sends bytes. ``read(seconds)`` returns received
    bytes, or no bytes after this time. Their exceptions end the request.

    ``address`` is the address of the client on CAN. ``clock`` returns seconds.
    ``on_event`` is called with unsolicited events such as logs. `run` also passes it
    rejections with an error code that is not defined in the ICD.

    ``values`` are the values of frame fields that the sender chooses, such as
    ``source``. With header and trailer, `messages` returns received messages. Each
    ``write`` is then one message. If only packets delimit messages, each ``read`` must
    return one packet.
    """

    def __init__(
        self,
        link: Link[N],
        port: Union[Port, Write],
        read: Optional[Read] = None,
        crc: bool = False,
        settings: Optional[Settings] = None,
        on_event: Optional[Callable[[Event], object]] = None,
        clock: Callable[[], float] = time.monotonic,
        values: Optional[Mapping[str, int]] = None,
        address: int = 0,
    ) -> None:
        self._carrier = carrier_of(link, port, read)
        bus = self._carrier.bus
        client = client_of(link, bus, crc, settings, values, address)
        super().__init__(client, on_event, clock)

    def _flush(self) -> None:
        self._carrier.send(self.client)

    def _receive(self, seconds: float) -> list[Event]:
        return self._carrier.receive(self.client, self._now, seconds)
