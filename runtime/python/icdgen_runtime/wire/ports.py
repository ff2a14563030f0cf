"""What a `Session` needs, of ports that work otherwise."""

from __future__ import annotations

from collections.abc import Callable
from typing import Optional, Protocol


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
