"""Line of I2C: each request is a transaction whose result is reported.

`I2cLine.take` returns the transactions for the application, which carries them out on
its bus. With the read bytes, `arrival` returns the response or the error for `client`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Optional, Union

from .._errors import LengthError
from .awaited import MOST_AWAITED, Arrival, Awaited, Request
from .bus_lines import BusLine
from .errors import ChecksumError, need
from .events import Event, Late, LineError, Stray
from .i2c import I2cTransfer, i2c_read_length, i2c_reply
from .link import Link


class I2cLine(BusLine):
    """The line of an I2C bus.

    The results of transactions come in their order. A transaction is recognized by
    identity, because two may be equal.
    """

    bus = "i2c"
    has_results = True

    def __init__(self, link: Link, checks: bool) -> None:
        super().__init__(link, checks)
        need(link.i2c_address, "i2c")
        self._pending: list[I2cTransfer] = []
        # Transactions taken whose results were not yet reported
        self._taken: list[I2cTransfer] = []

    def encode(self, request: Request) -> I2cTransfer:
        """Return the transaction of a request."""
        length = 0
        if request.kind == "telemetry":
            length = i2c_read_length(self._link, request.id, self._checks_frames)
        return I2cTransfer(self._message(request), length)

    def put(self, transfer: I2cTransfer) -> None:
        """Add a transaction that the application can take."""
        self._pending.append(transfer)

    def take(self) -> list[I2cTransfer]:
        """Return the transactions to perform, each once.

        At most `MOST_AWAITED` transactions can be without a result at a time.
        """
        free = MOST_AWAITED - len(self._taken)
        taken, self._pending = self._pending[:free], self._pending[free:]
        self._taken += taken
        return taken

    def withdraw(self, unit: object) -> bool:
        """Remove a transaction that was not taken. Return whether it was removed."""
        before = len(self._pending)
        self._pending = [each for each in self._pending if each is not unit]
        return len(self._pending) < before

    def finish(self) -> Optional[I2cTransfer]:
        """Return the transaction to which the next result belongs; None without one."""
        return self._taken.pop(0) if self._taken else None

    def arrival(self, transfer: I2cTransfer, read: bytes) -> Union[Arrival, LineError]:
        """Return the telemetry that a transaction has read, or its fault."""
        id = transfer.write[0]
        try:
            frame = i2c_reply(self._link, id, read, self._checks_frames)
        except ChecksumError:
            return LineError("checksum", id)
        except LengthError:
            return LineError("length", id)
        type = self._link.TELEMETRY.which(id, frame)
        return Arrival(id, None, frame, id, frame, type, Late(id, frame, type))

    def unawaited(
        self, transfer: Optional[I2cTransfer], read: Optional[bytes]
    ) -> Event:
        """Return the event of a result that no request awaits any more."""
        if transfer is None:
            return Stray(read or b"")
        if read is None or not transfer.read:
            return Late(transfer.write[0], b"")
        arrival = self.arrival(transfer, read)
        return arrival.unawaited if isinstance(arrival, Arrival) else arrival

    def arrivals(
        self, now: float, received: Any, awaited: Callable[[], Iterator[Awaited]]
    ) -> Iterator[Union[Arrival, Event]]:
        """Yield nothing: results belong to transactions."""
        yield from ()
