"""Sessions with a device over a port.

A session of the Python runtime is a client with its clock and its port. `session`
chooses the class that matches the port.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from icdgen_runtime._errors import IcdError
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.events import Event
from icdgen_runtime.wire.link import Link, Settings
from icdgen_runtime.wire.session import BusSession, Session

from icdgen.errors import UserError
from icdgen.link.ports import CanBus, Port

OnEvent = Callable[[Event], object]


class CanSession(BusSession):
    """A session over a CAN bus."""

    def __init__(
        self,
        link: Link,
        port: CanBus,
        crc: bool,
        address: int,
        settings: Settings,
        on_event: OnEvent | None,
    ) -> None:
        self._can = Client(link, "can", crc=crc, address=address, settings=settings)
        super().__init__(self._can, on_event)
        self._port = port

    def _flush(self) -> None:
        for packet in self._can.packets():
            self._port.send(packet)

    def _receive(self, seconds: float) -> list[Event]:
        packet = self._port.receive(seconds)
        if packet is None:
            return self._can.tick(self._now())
        return self._can.packet(self._now(), packet)


@contextmanager
def session(
    link: Link,
    port: Port | CanBus,
    crc: bool = False,
    address: int = 0,
    settings: Settings | None = None,
    on_event: OnEvent | None = None,
    values: Mapping[str, int] | None = None,
) -> Iterator[BusSession]:
    """Open a session, which closes the port at its end.

    ``on_event`` is called with unsolicited events such as logs. ``values`` are the
    values of frame fields that the sender chooses. Raise `icdgen.errors.UserError` for
    a request that the ICD does not allow on this bus.
    """
    try:
        if isinstance(port, CanBus):
            yield CanSession(
                link, port, crc, address, settings or link.settings, on_event
            )
        else:
            yield Session(
                link, port.write, port.read, crc, settings, on_event, values=values
            )
    except IcdError as error:
        raise UserError(str(error), "see docs/reference/wire.md") from None
    finally:
        port.close()
