"""What a `Session` needs, of ports that work otherwise."""

from __future__ import annotations

import socket
from collections.abc import Callable
from typing import Any, Optional, Protocol, Union

_PIECE = 65536  # bytes that are read at a time: a datagram has no more

Write = Callable[[bytes], object]
Read = Callable[[float], bytes]


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


class CanBus(Protocol):
    """What is asked of a CAN bus: what `can.Bus` of python-can has."""

    def send(self, msg: Any, /) -> None: ...

    def recv(self, timeout: Optional[float] = ..., /) -> Any: ...


class I2cBus(Protocol):
    """What is asked of an I2C bus: what `smbus2.SMBus` has."""

    def i2c_rdwr(self, *i2c_msgs: Any) -> None: ...


Port = Union[SerialPort, socket.socket, CanBus, I2cBus]
"""Types of ports that a `Session` accepts."""


def serial_port(port: SerialPort) -> tuple[Write, Read]:
    """The ``write`` and ``read`` of a serial port of pyserial.

    The time-out of the port is set for each read. Errors are those of the port.
    """

    def read(seconds: float) -> bytes:
        port.timeout = seconds
        first = port.read(1)
        return first + port.read(port.in_waiting) if first else b""

    return port.write, read


def socket_port(port: socket.socket) -> tuple[Write, Read]:
    """The ``write`` and ``read`` of a connected socket, be it of TCP or of UDP.

    Errors are those of the socket; `ConnectionResetError` tells that the other side of a
    TCP connection closed.
    """
    is_stream = port.type == socket.SOCK_STREAM

    def read(seconds: float) -> bytes:
        before = port.gettimeout()
        # 0 would be an error where nothing is there.
        port.settimeout(max(seconds, 0.001))
        try:
            data = port.recv(_PIECE)
        except socket.timeout:  # which is `TimeoutError` only since 3.10
            return b""
        finally:
            port.settimeout(before)
        if not data and is_stream:
            raise ConnectionResetError("the other side closed the connection")
        return data

    return (port.sendall if is_stream else port.send), read
