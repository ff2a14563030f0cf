"""Ports for bytes or CAN packets.

`open_port` opens a port from its text: ``tcp://host:port``, ``udp://host:port``, the
path of a pseudo-terminal, the name of a serial port, or ``can://interface/channel`` (of
python-can). `icdgen.link.session` runs the client of an ICD on it.
"""

from __future__ import annotations

import errno
import os
import re
import select
import socket
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import Any, Protocol
from urllib.parse import urlsplit

from icdgen_runtime.wire.can import CanPacket

from icdgen.icd.model import buses_of
from icdgen.link.exclusive import PortError as PortError
from icdgen.link.exclusive import busy_error, lock_port

CONNECT_TIMEOUT = 5.0  # s
WRITE_TIMEOUT = 5.0
# With the headers of IP and UDP, these bytes fit into an Ethernet frame of 1,500 bytes,
# so that the datagram is not fragmented.
STREAM_BYTES_PER_DATAGRAM = 1400
# An IPv4 packet has up to 65,535 bytes: 20 are the header of IP, 8 that of UDP.
LARGEST_DATAGRAM = 65507
# Host and port without tcp:// or udp://.
_BARE_ADDRESS = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[\w.-]+):\d{1,5}")
FORMS = "tcp://HOST:PORT, udp://HOST:PORT, /dev/ttyUSB0, COM3, can://socketcan/can0"


class Port(Protocol):
    """A byte stream. Times are in seconds."""

    def read(self, timeout: float) -> bytes:
        """Return received bytes, or no bytes after ``timeout``. Raise `PortError`."""

    def write(self, data: bytes) -> None:
        """Send all bytes. Raise `PortError`."""

    def close(self) -> None: ...


@contextmanager
def _failures(name: str, *kinds: type[Exception], help: str = "") -> Iterator[None]:
    """Convert exceptions of these kinds to a `PortError` that begins with the name."""
    try:
        yield
    except kinds as error:
        raise PortError(
            f"{name}: {getattr(error, 'strerror', None) or error}", help
        ) from None


class Socket:
    """A TCP or UDP socket.

    TCP transfers a byte stream. UDP preserves datagrams: `read` returns the bytes of
    one. ``largest_datagram`` is the maximum number of bytes that `write` sends in a
    datagram; longer data is split.
    """

    def __init__(
        self,
        kind: str,
        host: str,
        port: int,
        largest_datagram: int = STREAM_BYTES_PER_DATAGRAM,
    ) -> None:
        self.largest_datagram = largest_datagram
        # Brackets separate the colons of an IPv6 address from that of the port.
        shown_host = f"[{host}]" if ":" in host else host
        self.name = f"{kind}://{shown_host}:{port}"
        failure = f"cannot connect to {self.name}"
        with (
            _failures(failure, OSError, help="is it running?"),
            _failures(failure, socket.gaierror, help="check the host name"),
        ):
            if kind == "tcp":
                self.socket = socket.create_connection((host, port), CONNECT_TIMEOUT)
                # Send short requests at once, without waiting for further data.
                self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            else:
                family, *_, address = socket.getaddrinfo(
                    host, port, type=socket.SOCK_DGRAM
                )[0]
                self.socket = socket.socket(family, socket.SOCK_DGRAM)
                # A burst of packets arrives faster than it is read. The default buffer
                # would lose some.
                self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
                self.socket.connect(address)
        self.stream = kind == "tcp"

    def read(self, timeout: float) -> bytes:
        try:
            # 0 would make the socket non-blocking.
            self.socket.settimeout(max(timeout, 1e-6))
            data = self.socket.recv(65536)
        except (TimeoutError, BlockingIOError):
            return b""
        except OSError as error:
            help = "is it running?" if isinstance(error, ConnectionRefusedError) else ""
            raise PortError(f"{self.name}: {error.strerror or error}", help) from None
        if not data and self.stream:
            raise PortError(f"{self.name}: the other end closed the connection")
        return data

    def write(self, data: bytes) -> None:
        with _failures(self.name, OSError):
            self.socket.settimeout(WRITE_TIMEOUT)
            if self.stream:
                self.socket.sendall(data)
            else:
                for at in range(0, len(data), self.largest_datagram):
                    self.socket.send(data[at : at + self.largest_datagram])

    def close(self) -> None:
        self.socket.close()


class PseudoTerminal:
    """A pseudo-terminal of Linux, by its path: ``/dev/pts/3`` or a link to it.

    It needs no pyserial, and has no line settings. Other systems open a pseudo-terminal
    as a serial port.
    """

    def __init__(self, path: str) -> None:
        import tty

        self.path = path
        with _failures(
            f"cannot open {path}", OSError, help="check the path and your rights to it"
        ):
            # `O_NOCTTY`: otherwise the terminal could become that of this process,
            # whose interrupt characters then end it.
            self.file = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        try:
            lock_port(self.file, path)
        except PortError:
            os.close(self.file)
            raise
        with suppress(OSError):
            tty.setraw(self.file)

    def read(self, timeout: float) -> bytes:
        try:
            if select.select([self.file], [], [], max(timeout, 0))[0]:
                data = os.read(self.file, 65536)
                if data:
                    return data
                raise PortError(f"{self.path}: the other end is gone")
        except BlockingIOError:
            pass
        except OSError as error:
            raise PortError(
                f"{self.path}: {error.strerror}", "the other end is gone"
            ) from None
        return b""

    def write(self, data: bytes) -> None:
        while data:
            try:
                if not select.select([], [self.file], [], WRITE_TIMEOUT)[1]:
                    raise PortError(f"{self.path}: nothing can be written any more")
                data = data[os.write(self.file, data) :]
            except BlockingIOError:
                continue
            except OSError as error:
                raise PortError(f"{self.path}: {error.strerror}") from None

    def close(self) -> None:
        os.close(self.file)


class Serial:
    """A serial port, with pyserial.

    ``settings`` is the section ``line`` of the ICD. Missing keys have the defaults
    115,200 Bd, 8 data bits, no parity and 1 stop bit.
    """

    def __init__(self, name: str, settings: dict[str, Any]) -> None:
        serial = _library("serial", "pyserial")
        self.name, self.errors = name, (serial.SerialException, OSError)
        with _failures(
            f"cannot open {name}",
            *self.errors,
            ValueError,
            help=f"a port is named so: {FORMS}",
        ):
            try:
                self.serial = serial.Serial(
                    name,
                    settings.get("baud_rate", 115200),
                    bytesize=settings.get("data_bits", 8),
                    parity=str(settings.get("parity", "none"))[0].upper(),
                    stopbits=settings.get("stop_bits", 1),
                    write_timeout=WRITE_TIMEOUT,
                    exclusive=True,  # always the case on Windows
                )
            except self.errors as error:
                if _is_in_use(error):
                    raise busy_error(name) from None
                raise

    def read(self, timeout: float) -> bytes:
        with _failures(self.name, *self.errors):
            self.serial.timeout = max(timeout, 0)
            # The first byte waits for the time-out. The others are taken as far as they
            # are there, so that a response is returned at once.
            first = self.serial.read(1)
            return first + self.serial.read(self.serial.in_waiting) if first else b""

    def write(self, data: bytes) -> None:
        with _failures(self.name, *self.errors):
            self.serial.write(data)

    def close(self) -> None:
        self.serial.close()


class CanBus:
    """A CAN bus, with python-can. It transfers packets with 29-bit identifiers.

    ``bit_rate`` is in bit/s. SocketCAN ignores it; `ip link` sets the rate there.
    """

    def __init__(self, interface: str, channel: str, bit_rate: int) -> None:
        self.can = _library("can", "python-can")
        self.name = f"can://{interface}/{channel}"
        self.errors = self.can.CanError, OSError
        help = f"a port is named so: {FORMS}"
        with _failures(
            f"cannot open {self.name}", *self.errors, ValueError, ImportError, help=help
        ):
            self.bus = self.can.Bus(
                interface=interface, channel=channel, bitrate=bit_rate
            )

    def receive(self, timeout: float) -> CanPacket | None:
        """Return the next frame if it is a data frame with a 29-bit identifier.

        Return None for any other frame, or after ``timeout`` (s). Raise `PortError`.
        """
        with _failures(self.name, *self.errors):
            message = self.bus.recv(max(timeout, 0))
        if message is None or message.is_error_frame or message.is_remote_frame:
            return None
        if not message.is_extended_id:
            return None
        return CanPacket(message.arbitration_id, bytes(message.data))

    def send(self, packet: CanPacket) -> None:
        message = self.can.Message(
            arbitration_id=packet.id, data=packet.data, is_extended_id=True
        )
        with _failures(self.name, *self.errors):
            self.bus.send(message, timeout=WRITE_TIMEOUT)

    def close(self) -> None:
        self.bus.shutdown()


def open_port(text: str, protocol: dict[str, Any]) -> Port | CanBus:
    """Open a port.

    ``protocol`` is the section of the ICD. It has the settings of a serial port and the
    bit rate of a CAN bus (default 500 kbit/s). If datagrams delimit its messages, only
    a UDP port is possible.

    Raise `PortError`.
    """
    scheme, separator, remainder = text.partition("://")
    has_datagrams = protocol.get("link", {}).get("framing", {}).get("by") == "datagram"
    if has_datagrams and scheme != "udp":
        raise PortError(
            f"{text} keeps no packets apart, and only they delimit messages here",
            "udp://HOST:PORT does",
        )
    if separator:
        openers: dict[str, Callable[[], Port | CanBus]] = {
            "tcp": lambda: Socket("tcp", *address(text)),
            "udp": lambda: Socket(
                "udp",
                *address(text),
                LARGEST_DATAGRAM if has_datagrams else STREAM_BYTES_PER_DATAGRAM,
            ),
            "can": lambda: _can(remainder, buses_of(protocol).get("can", {})),
        }
        if scheme not in openers:
            raise PortError(
                f"there is no port `{text}`", f"a port is named so: {FORMS}"
            )
        return openers[scheme]()
    if _is_pty(text):
        return PseudoTerminal(text)
    if text.isdecimal() and not os.path.exists(text):
        raise PortError(
            f"there is no port `{text}`", f"did you mean tcp://localhost:{text}?"
        )
    if _BARE_ADDRESS.fullmatch(text) and not os.path.exists(text):
        raise PortError(f"there is no port `{text}`", f"did you mean tcp://{text}?")
    if "/" in text and not os.path.exists(text):
        raise PortError(
            f"there is no port `{text}`: no such file", f"a port is named so: {FORMS}"
        )
    uart = buses_of(protocol).get("uart", {})
    line = protocol.get("link", {}).get("line") or uart.get("line", {})
    return Serial(text, line)


def address(text: str) -> tuple[str, int]:
    """Return host and port of ``tcp://HOST:PORT`` or ``udp://HOST:PORT``.

    An IPv6 address is in brackets in the text, but not in the result. Raise `PortError`
    for an invalid host name, a port that is not from 1 to 65535, and any other part of
    a URL, such as a path or a user.
    """
    try:
        parts = urlsplit(text)
        host, port = parts.hostname, parts.port
    except ValueError:
        raise _no_address(text) from None
    has_other_parts = (
        parts.path not in ("", "/") or parts.query or parts.fragment or "@" in text
    )
    if not host or not port or has_other_parts:
        raise _no_address(text)
    try:
        # `socket` encodes the name in this way, and otherwise raises UnicodeError.
        host.encode("idna")
    except UnicodeError:
        raise PortError(
            f"`{text}` is no address: the host name is invalid", "check the host name"
        ) from None
    return host, port


def _no_address(text: str) -> PortError:
    return PortError(f"`{text}` is no address", f"a port is named so: {FORMS}")


def _can(path: str, section: dict[str, Any]) -> CanBus:
    """Open the CAN bus of ``INTERFACE/CHANNEL``. Raise `PortError`."""
    interface, separator, channel = path.partition("/")
    if not separator or not interface or not channel:
        raise PortError(
            f"`can://{path}` is no CAN bus",
            "can://INTERFACE/CHANNEL, as python-can names them",
        )
    return CanBus(interface, channel, section.get("bit_rate", 500_000))


def _is_pty(path: str) -> bool:
    """Return whether a path names a pseudo-terminal."""
    try:
        status = os.stat(path)
    except OSError:
        return False
    is_device = stat.S_ISCHR(status.st_mode)
    # Linux only: other systems open a terminal as a serial port.
    return is_device and os.path.realpath(path).startswith("/dev/pts/")


def _is_in_use(error: Exception) -> bool:
    """Return whether pyserial failed because another program uses the port."""
    if getattr(error, "errno", None) in (errno.EAGAIN, errno.EBUSY):
        return True
    # pyserial reports a lock of another program only by its text. Windows reports an
    # open port as access denied.
    return "exclusively lock" in str(error) or (
        os.name == "nt" and "PermissionError" in str(error)
    )


def _library(name: str, package: str) -> Any:
    """Return a module of an optional package. Raise `PortError` without it."""
    try:
        return import_module(name)
    except ImportError:
        raise PortError(
            f"{package} is not installed", "pip install 'icdgen[link]'"
        ) from None
