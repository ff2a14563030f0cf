"""What a `Session` needs, of ports that work otherwise."""

from __future__ import annotations

import socket
from collections.abc import Callable
from typing import Optional, Protocol

_PIECE = 4096  # bytes that are read at a time


class SerialPort(Protocol):
    """What is asked of a serial port: what `serial.Serial` of pyserial has."""

    timeout: Optional[float]
    """How long a read waits, in seconds."""

    @property
    def in_waiting(self) -> int:
        """Bytes that have come."""
        ...

    def read(self, size: int = ..., /) -> bytes: ...

    def write(self, data: bytes, /) -> object: ...


def serial_port(
    port: SerialPort,
) -> tuple[Callable[[bytes], object], Callable[[float], bytes]]:
    """The ``write`` and ``read`` of a `Session` over a serial port of pyserial.

    ``Session(LINK, *serial_port(serial.Serial("/dev/ttyUSB0", 921600)))``. The time-out
    of the port is set for each read. Errors are those of the port.
    """

    def read(seconds: float) -> bytes:
        port.timeout = seconds
        first = port.read(1)
        return first + port.read(port.in_waiting) if first else b""

    return port.write, read


def socket_port(
    port: socket.socket,
) -> tuple[Callable[[bytes], object], Callable[[float], bytes]]:
    """The ``write`` and ``read`` of a `Session` over a connected TCP socket.

    ``Session(LINK, *socket_port(socket.create_connection(("127.0.0.1", 4000))))``. Errors
    are those of the socket; `ConnectionResetError` tells that the other side closed.
    """

    def read(seconds: float) -> bytes:
        before = port.gettimeout()
        port.settimeout(
            max(seconds, 0.001)
        )  # 0 would be an error where nothing is there
        try:
            data = port.recv(_PIECE)
        except socket.timeout:  # which is `TimeoutError` only since 3.10
            return b""
        finally:
            port.settimeout(before)
        if not data:
            raise ConnectionResetError("the other side closed the connection")
        return data

    return port.sendall, read
