"""Protocol of a line: what a client needs to know of UART, I2C, CAN or framed links.

`bus_lines`, `i2c_line` and `stream_line` implement it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Optional, Protocol, Union

from .awaited import Arrival, Awaited, Plan, Request
from .events import Event


class Line(Protocol):
    """Encodes requests, and turns what is received into arrivals and events."""

    has_results: bool
    """Whether each transmission has a result: a failed one is sent again after a pause,
    and a request without responses is sent when its transmission has succeeded.
    """
    checks_telecommands: bool
    """Whether telecommands have a checksum that a device can find wrong."""

    @property
    def discarded(self) -> int:
        """Number of received bytes that are not part of a message."""
        ...

    @property
    def header(self) -> bytes:
        """Header of the last packet, if responses can repeat numbers of it."""
        ...

    def plan(self, request: Request, reply: Optional[int]) -> Plan:
        """Return how to send a request; ``reply`` is the id of the reply.

        Raise `UnknownIdError` and `UnsupportedError`.
        """
        ...

    def check(self, request: Request) -> None:
        """Raise the error of a request of the right length that cannot be encoded."""
        ...

    def encode(self, request: Request) -> Any:
        """Return what the client gives to the application: bytes, CAN packets or an I2C
        transaction.
        """
        ...

    def withdraw(self, unit: object) -> bool:
        """Do not send ``unit`` if the application has not taken it yet.

        Return whether this succeeded.
        """
        ...

    def expire(self, now: float) -> list[Event]:
        """Return the events of incomplete messages whose time has passed."""
        ...

    def arrivals(
        self, now: float, received: Any, awaited: Callable[[], Iterator[Awaited]]
    ) -> Iterator[Union[Arrival, Event]]:
        """Yield what has arrived, and events that belong to no request.

        ``awaited`` returns the responses that may arrive at this moment.
        """
        ...
