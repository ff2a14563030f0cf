"""Transport of the line over a pseudo-terminal, TCP or UDP, with asyncio.

`Server` moves bytes between a line and its clients. Each other public function opens
one kind of transport; `icdgen.sim.run` finds it by its name.
"""

from __future__ import annotations

import asyncio
import errno
import os
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any, cast

from icdgen.errors import UserError
from icdgen.sim.control import Control
from icdgen.sim.device_line import DeviceLine

Send = Callable[[bytes], None]
# Bytes of a stream in one datagram. With the headers of IP and UDP they fit into an
# Ethernet frame of 1,500 bytes, so that the datagram is not fragmented.
PIECE = 1400
RECONNECT_INTERVAL = 1.0  # s between two attempts to connect
IDLE = 0.5  # s; longest sleep, as some systems notice an interrupt only afterwards


class Server:
    """Pass received bytes to the line, and send its bytes to all connected clients."""

    def __init__(self, line: DeviceLine, control: Control) -> None:
        self.line, self.control = line, control
        self.begin = time.monotonic()
        self.clients: list[Send] = []
        self.wake = asyncio.Event()

    @property
    def now(self) -> int:
        """Milliseconds since the start."""
        return int((time.monotonic() - self.begin) * 1000)

    def received(self, data: bytes) -> None:
        """Process bytes of a client."""
        now = self.now
        self.control.tick(now)
        self.line.received(now, data)
        self._flush(now)
        self.wake.set()

    def execute(self, text: str) -> str:
        """Execute a command and return its response.

        Raise `icdgen.errors.UserError`.
        """
        answer = self.control.execute(self.now, text)
        self._flush(self.now)
        self.wake.set()
        return answer

    async def run(self) -> None:
        """Process timeouts, without end."""
        while True:
            now = self.now
            self.control.tick(now)
            self.line.tick(now)
            self._flush(now)
            times = [
                at
                for at in (self.line.deadline, self.control.deadline)
                if at is not None
            ]
            self.wake.clear()
            # Round up by half a millisecond, as `now` is rounded down: otherwise the
            # loop would wake up too early.
            wait = (
                IDLE
                if not times
                else min(IDLE, max(0.0, (min(times) - self.now) / 1000 + 0.0005))
            )
            try:
                # `wait_for` can lose an interrupt that arrives with data.
                async with asyncio.timeout(wait):
                    await self.wake.wait()
            except TimeoutError:
                continue

    def _flush(self, now: int) -> None:
        for data in filter(None, self.line.pieces(now)):
            for send in list(self.clients):
                send(data)


async def tcp(server: Server, host: str, port: int) -> tuple[str, object]:
    """Listen for TCP connections. Return the address for a message, and the server."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        # The client has disconnected, or the simulator ends. Otherwise asyncio would
        # print the cancellation.
        with suppress(OSError, asyncio.CancelledError):
            await _handle(server, reader, writer)

    try:
        listening = await asyncio.start_server(serve, host, port)
    except (OSError, UnicodeError) as error:
        raise _listen_error("tcp", host, port, error) from None
    return f"tcp://{host}:{listening.sockets[0].getsockname()[1]}", listening


async def udp(
    server: Server, host: str, port: int, connects: bool = False
) -> tuple[str, object]:
    """Exchange UDP datagrams. Each is a piece of the stream, or a packet.

    Responses go to the last sender. With ``connects``, they go to ``host`` and
    ``port``.
    """

    class Protocol(asyncio.DatagramProtocol):
        def __init__(self) -> None:
            self.transport: asyncio.DatagramTransport | None = None
            self.peer: tuple[Any, ...] | None = None

        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            self.transport = cast(asyncio.DatagramTransport, transport)
            server.clients.append(self.send)

        def datagram_received(self, data: bytes, addr: tuple[Any, ...]) -> None:
            self.peer = addr
            server.received(data)

        def error_received(self, exc: Exception) -> None:
            self.peer = None

        def send(self, data: bytes) -> None:
            size = len(data) if server.line.keeps_packets else PIECE
            for at in range(0, len(data), size):
                if (connects or self.peer is not None) and self.transport:
                    self.transport.sendto(
                        data[at : at + size], None if connects else self.peer
                    )

    loop = asyncio.get_running_loop()
    try:
        if connects:
            transport, _ = await loop.create_datagram_endpoint(
                Protocol, remote_addr=(host, port)
            )
            return f"to udp://{host}:{port}", transport
        transport, _ = await loop.create_datagram_endpoint(Protocol, (host, port))
    except (OSError, UnicodeError) as error:
        raise _listen_error("udp", host, port, error) from None
    return f"udp://{host}:{transport.get_extra_info('sockname')[1]}", transport


async def connect(
    server: Server, kind: str, host: str, port: int
) -> tuple[str, object]:
    """Connect to a server, and reconnect when the connection is lost.

    Return its address.
    """
    if kind == "udp":
        return await udp(server, host, port, connects=True)
    return f"to tcp://{host}:{port}", asyncio.create_task(
        _stay_connected(server, host, port)
    )


async def _stay_connected(server: Server, host: str, port: int) -> None:
    """Connect, and reconnect when the connection is lost."""
    while True:
        with suppress(OSError):
            reader, writer = await asyncio.open_connection(host, port)
            await _handle(server, reader, writer)
        await asyncio.sleep(RECONNECT_INTERVAL)


async def _handle(
    server: Server, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
) -> None:
    """Handle a connection until it ends."""
    send = writer.write
    server.clients.append(send)
    try:
        while data := await reader.read(65536):
            server.received(data)
            await writer.drain()
    finally:
        server.clients.remove(send)
        writer.close()


async def pty(server: Server) -> tuple[str, object]:
    """Open a pseudo-terminal. Return its path and its files."""
    # Windows does not have this module.
    import tty

    master, slave = os.openpty()
    # `slave` stays open, so that the device remains when a client closes its end.
    tty.setraw(slave)
    os.set_blocking(master, False)
    loop, waiting = asyncio.get_running_loop(), bytearray()

    def read() -> None:
        try:
            data = os.read(master, 65536)
        except OSError:
            return
        server.received(data)

    def write() -> None:
        with suppress(BlockingIOError):
            del waiting[: os.write(master, waiting)]
        if not waiting:
            loop.remove_writer(master)

    def send(data: bytes) -> None:
        # Without a reader, bytes are lost, as on a real line.
        if len(waiting) < 1 << 22:
            waiting.extend(data)
            loop.add_writer(master, write)

    server.clients.append(send)
    loop.add_reader(master, read)
    return os.ttyname(slave), (master, slave)


def _listen_error(
    kind: str, host: str, port: int, error: OSError | UnicodeError
) -> UserError:
    """Return the error for an address that cannot be opened.

    `socket` raises UnicodeError for a host name with an empty or too long part.
    """
    if isinstance(error, UnicodeError):
        text = f"cannot listen on {kind} {host}:{port}: the host name is invalid"
        return UserError(text, "check the host name")
    is_taken = error.errno in (errno.EADDRINUSE, errno.EACCES)
    if error.errno and error.errno > 0:
        why = os.strerror(error.errno)
    else:
        why = error.strerror or str(error)
    help = "--host is an address of this machine"
    if is_taken:
        help = "port 0 takes a free one"
    return UserError(f"cannot listen on {kind} {host}:{port}: {why}", help)
