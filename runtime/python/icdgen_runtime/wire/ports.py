"""Ports of a `Session`, and adapters for serial ports and sockets."""

from __future__ import annotations

import socket
from collections.abc import Callable
from typing import Any, Optional, Protocol, Union

_PIECE = 65536  # maximum bytes of a read, and of a datagram

Write = Callable[[bytes], object]
Read = Callable[[float], bytes]


class SerialPort(Protocol):
    """Required attributes of a serial port. `serial.Serial` of pyserial has them."""

    timeout: Optional[float]
    """Timeout of a read, in seconds."""

    @property
    def in_waiting(self) -> int:
        """Number of received bytes that can be read."""
        ...

    def read(self, size: int = ..., /) -> bytes: ...

    def write(self, data: bytes, /) -> object: ...


class CanBus(Protocol):
    """Required methods of a CAN bus. `can.Bus` of python-can has them."""

    def send(self, msg: Any, /) -> None: ...

    def recv(self, timeout: Optional[float] = ..., /) -> Any: ...


class I2cBus(Protocol):
    """Required methods of an I2C bus. `smbus2.SMBus` has them."""

    def i2c_rdwr(self, *i2c_msgs: Any) -> None: ...


Port = Union[SerialPort, socket.socket, CanBus, I2cBus]
"""Types of ports that a `Session` accepts."""


def serial_port(port: SerialPort) -> tuple[Write, Read]:
    """Return the functions ``write`` and ``read`` for a serial port of pyserial.

    Each read sets the timeout of the port. Exceptions of the port pass through.
    """

    def read(seconds: float) -> bytes:
        port.timeout = seconds
        first = port.read(1)
        return first + port.read(port.in_waiting) if first else b""

    return port.write, read


def socket_port(port: socket.socket) -> tuple[Write, Read]:
    """Return the functions ``write`` and ``read`` for a connected TCP or UDP socket.

    Exceptions of the socket pass through. `ConnectionResetError` reports that the other
    side of a TCP connection closed it.
    """
    is_stream = port.type == socket.SOCK_STREAM

    def read(seconds: float) -> bytes:
        before = port.gettimeout()
        # With 0, `recv` would raise an error if there are no bytes.
        port.settimeout(max(seconds, 0.001))
        try:
            data = port.recv(_PIECE)
        except socket.timeout:  # an alias of `TimeoutError` only since Python 3.10
            return b""
        finally:
            port.settimeout(before)
        if not data and is_stream:
            raise ConnectionResetError("the other side closed the connection")
        return data

    return (port.sendall if is_stream else port.send), read
