"""Transports of a `Session`: bytes, CAN packets or I2C transactions.

The message classes of a CAN or I2C library are taken from the modules of the given
port, so that no library is imported here.
"""

from __future__ import annotations

import errno
import socket
import sys
import time
from collections.abc import Callable
from typing import Any, Optional, Protocol, Union, cast

from .can import CanPacket
from .events import Event
from .link import Bus, Link
from .ports import (
    CanBus,
    I2cBus,
    Port,
    Read,
    SerialPort,
    Write,
    serial_port,
    socket_port,
)

_NOT_ANSWERED = tuple(
    getattr(errno, name, 0)
    for name in ("ENXIO", "EIO", "EREMOTEIO", "ETIMEDOUT", "EAGAIN")
)
"""Error numbers of an I2C driver for a transaction that the node did not acknowledge."""


class Carrier(Protocol):
    """Transport of a blocking client. Exceptions of the library pass through."""

    @property
    def bus(self) -> Bus: ...

    def send(self, client: Any) -> None:
        """Send the pending output of the client."""

    def receive(
        self, client: Any, now: Callable[[], float], seconds: float
    ) -> list[Event]:
        """Pass received data to the client, or process a timeout."""
        ...


class ByteCarrier:
    """Transport over a stream of bytes, or over datagrams."""

    bus: Bus = "uart"

    def __init__(self, write: Write, read: Read) -> None:
        self._write, self._read = write, read

    def send(self, client: Any) -> None:
        while data := client.output():
            self._write(data)

    def receive(
        self, client: Any, now: Callable[[], float], seconds: float
    ) -> list[Event]:
        data = self._read(seconds)
        events: list[Event] = (
            client.received(now(), data) if data else client.tick(now())
        )
        return events


class CanCarrier:
    """Transport over a CAN bus of python-can."""

    bus: Bus = "can"

    def __init__(self, port: CanBus) -> None:
        self._port, self._message = port, _library_class(port, "Message")

    def send(self, client: Any) -> None:
        for packet in client.packets():
            message = self._message(
                arbitration_id=packet.id, data=packet.data, is_extended_id=True
            )
            self._port.send(message)

    def receive(
        self, client: Any, now: Callable[[], float], seconds: float
    ) -> list[Event]:
        message = self._port.recv(seconds)
        events: list[Event]
        if message is None or _is_foreign(message):
            events = client.tick(now())
        else:
            packet = CanPacket(message.arbitration_id, bytes(message.data))
            events = client.packet(now(), packet)
        return events


def _is_foreign(message: Any) -> bool:
    """Return whether a packet cannot belong to a link.

    All links have 29-bit identifiers.
    """
    return bool(
        not message.is_extended_id or message.is_error_frame or message.is_remote_frame
    )


class I2cCarrier:
    """Transport over an I2C bus of smbus2.

    ``joins``: use a repeated start for each read.
    """

    bus: Bus = "i2c"

    def __init__(self, port: I2cBus, address: int, joins: bool) -> None:
        self._port, self._address, self._joins = port, address, joins
        self._message = _library_class(port, "i2c_msg")

    def send(self, client: Any) -> None:
        """Do nothing.

        A transaction has an immediate result, so `receive` performs it.
        """

    def receive(
        self, client: Any, now: Callable[[], float], seconds: float
    ) -> list[Event]:
        transfers = client.transfers()
        events: list[Event] = []
        if not transfers:
            time.sleep(seconds)
            events = client.tick(now())
        for done, transfer in enumerate(transfers):
            try:
                data = self._transfer(*transfer)
            except BaseException:
                # Report the others as failed. Otherwise the client waits for them.
                for _ in transfers[done:]:
                    client.transferred(now(), None)
                raise
            events += client.transferred(now(), data)
        return events

    def _transfer(self, write: bytes, count: int) -> Optional[bytes]:
        """Perform a transaction. Return the bytes read, or None without acknowledge."""
        parts = [self._message.write(self._address, write)]
        if count:
            parts.append(self._message.read(self._address, count))
        try:
            for transaction in [parts] if self._joins else [[part] for part in parts]:
                self._port.i2c_rdwr(*transaction)
        except OSError as error:
            if error.errno not in _NOT_ANSWERED:
                raise
            return None
        return bytes(parts[1]) if count else b""


def _library_class(port: object, name: str) -> Any:
    """Return a class of the library that defines the class of ``port`` or a base class.

    Raise `TypeError` if it does not exist.
    """
    for kind in type(port).__mro__:
        for module in (kind.__module__, kind.__module__.partition(".")[0]):
            value = getattr(sys.modules.get(module), name, None)
            if value is not None:
                return value
    raise TypeError(f"nothing beside {type(port).__name__} is called {name}")


def carrier_of(
    link: Link[Any], port: Union[Port, Write], read: Optional[Read]
) -> Carrier:
    """Return the transport over a port, or over the functions ``port`` and ``read``.

    Raise `TypeError` for an object that is not a port.
    """
    if read is not None:
        return ByteCarrier(cast(Write, port), read)
    if isinstance(port, socket.socket):
        return ByteCarrier(*socket_port(port))
    if hasattr(port, "i2c_rdwr"):
        return I2cCarrier(
            cast(I2cBus, port), link.i2c_address or 0, link.i2c_repeated_start
        )
    if hasattr(port, "recv") and hasattr(port, "send"):
        return CanCarrier(cast(CanBus, port))
    if hasattr(port, "read") and hasattr(port, "write"):
        return ByteCarrier(*serial_port(cast(SerialPort, port)))
    raise TypeError(
        f"{type(port).__name__} is no port: a session takes a serial port, a socket, a CAN bus,"
        " an I2C bus, or a function that writes and one that reads"
    )
