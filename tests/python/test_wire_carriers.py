"""`Session(LINK, port)` works with ports of pyserial, sockets, python-can and smbus2.

The other end of each port is a simulated node in a thread, or a test double.
"""

from __future__ import annotations

import asyncio
import errno
import os
import pty
import socket
import threading
import tty

import can
import pytest
import serial

from tests.python import packages, smbus_fake
from tests.sim.port import DevicePort

QUICK = {"reply_timeout": 60, "retries": 1, "poll_interval": 1, "poll_timeout": 60}


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


@pytest.fixture(scope="module")
def acp(shipped):
    return shipped.module("cubeacp")


class Node(threading.Thread):
    """Simulated node that uses functions to read and write, and ends when they fail."""

    def __init__(self, read, write) -> None:
        super().__init__(daemon=True)
        self.read, self.write, self.port = (
            read,
            write,
            DevicePort(packages.shipped(), "cubeacp"),
        )
        self.start()

    def run(self) -> None:
        try:
            while data := self.read():
                self.port.write(data)
                self.write(self.port.read(1))
        except OSError:
            return


def exchange_messages(acp, session) -> None:
    """Request a short frame, send a telecommand and request a long frame."""
    assert session.get(acp.Identification).node_type == acp.NODE_TYPE
    session.send(acp.ClearErrors())
    assert len(session.get(acp.AdcsConfiguration).to_bytes()) == 504


@pytest.mark.pty
def test_a_session_works_over_a_serial_port_of_pyserial(acp, wire):
    far, near = pty.openpty()
    tty.setraw(near)
    with serial.Serial(os.ttyname(near), 921600) as port:
        node = Node(lambda: os.read(far, 4096), lambda data: os.write(far, data))
        exchange_messages(acp, wire.Session(acp.LINK, port))
    os.close(near)
    node.join()  # before another file gets the number of this one
    os.close(far)


def test_a_session_works_over_a_tcp_socket(acp, wire):
    with (
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.create_connection(server.getsockname()) as port,
    ):
        far, _ = server.accept()
        with far:
            Node(lambda: far.recv(4096), far.sendall)
            exchange_messages(acp, wire.Session(acp.LINK, port))
            port.shutdown(socket.SHUT_RDWR)


def test_a_session_works_over_a_udp_socket(acp, wire):
    with (
        socket.socket(type=socket.SOCK_DGRAM) as port,
        socket.socket(type=socket.SOCK_DGRAM) as far,
    ):
        for end in (port, far):
            end.bind(("127.0.0.1", 0))
        port.connect(far.getsockname())
        far.connect(port.getsockname())
        far.settimeout(5)
        Node(lambda: far.recv(4096), lambda data: data and far.send(data))
        far.send(b"")  # a datagram without bytes closes nothing
        exchange_messages(acp, wire.Session(acp.LINK, port))
        port.send(b"")  # to the node it does


def test_an_async_session_works_over_streams_of_asyncio(acp, wire):
    async def main() -> None:
        with socket.create_server(("127.0.0.1", 0)) as server:
            reader, writer = await asyncio.open_connection(*server.getsockname())
            far, _ = server.accept()
            with far:
                Node(lambda: far.recv(4096), far.sendall)
                session = wire.AsyncSession(acp.LINK, reader, writer)
                assert (
                    await session.get(acp.Identification)
                ).node_type == acp.NODE_TYPE
                await session.send(acp.ClearErrors())
                writer.close()
                await writer.wait_closed()

    asyncio.run(main())


class CanNode(threading.Thread):
    """Node on a CAN bus that acknowledges telecommands and responds to requests.

    It sends ``noise`` before each response.
    """

    def __init__(self, acp, wire, bus: can.BusABC, noise: list[can.Message]) -> None:
        super().__init__(daemon=True)
        self.acp, self.wire, self.bus, self.noise, self.telecommands = (
            acp,
            wire,
            bus,
            noise,
            [],
        )
        self.joiner = wire.CanJoiner(acp.LINK, acp.LINK.can.node_address, 1)
        self.over = threading.Event()
        self.start()

    def run(self) -> None:
        while not self.over.is_set():
            frame = self.bus.recv(0.05)
            if frame is None:
                continue
            packet = self.wire.CanPacket(frame.arbitration_id, bytes(frame.data))
            for event in self.joiner.feed(0, packet):
                if event.message:
                    self.answer(event.message)

    def answer(self, request) -> None:
        kind, data = "acknowledge", b""
        if request.kind == "request":
            frame = self.acp.LINK.TELEMETRY[request.id]
            telemetry = (
                frame(node_type=self.acp.NODE_TYPE)
                if frame is self.acp.Identification
                else frame()
            )
            kind, data = "reply", telemetry.to_bytes()
        else:
            self.telecommands.append((request.id, request.data))
        for message in self.noise:
            self.bus.send(message)
        reply = self.wire.CanMessage(
            kind, request.id, self.acp.LINK.can.node_address, request.source, data
        )
        for packet in self.wire.can_split(self.acp.LINK, reply):
            self.bus.send(
                can.Message(
                    arbitration_id=packet.id, data=packet.data, is_extended_id=True
                )
            )


@pytest.mark.parametrize(
    "noise",
    [
        [],
        [
            can.Message(arbitration_id=5, data=b"12", is_extended_id=False),
            can.Message(is_remote_frame=True),
        ],
    ],
    ids=["alone", "with other traffic"],
)
def test_a_session_works_over_a_can_bus_of_python_can(acp, wire, noise, request):
    channel = request.node.name
    with (
        can.Bus(channel, interface="virtual") as port,
        can.Bus(channel, interface="virtual") as far,
    ):
        node = CanNode(acp, wire, far, noise)
        exchange_messages(acp, wire.Session(acp.LINK, port, address=7))
        node.over.set()
        node.join()
    assert node.telecommands == [(acp.ClearErrors.ID, acp.ClearErrors().to_bytes())]


def test_a_session_works_over_an_i2c_bus_of_smbus2(acp, wire):
    bus = smbus_fake.SMBus(acp, [])
    exchange_messages(acp, wire.Session(acp.LINK, bus))
    assert bus.telecommands == [
        bytes([acp.ClearErrors.ID]) + acp.ClearErrors().to_bytes()
    ]


def test_a_transaction_that_the_node_does_not_acknowledge_is_repeated(acp, wire):
    bus = smbus_fake.SMBus(acp, [errno.EREMOTEIO])
    session = wire.Session(acp.LINK, bus, settings=wire.Settings(**QUICK))
    assert session.get(acp.Identification).node_type == acp.NODE_TYPE
    bus.errors = [errno.EREMOTEIO] * 2
    with pytest.raises(wire.ReplyTimeoutError, match="2 attempts"):
        session.get(acp.Identification)


def test_a_read_is_a_separate_transaction_without_repeated_start(acp, wire):
    for link, parts in (
        (acp.LINK, [2]),
        (
            acp.LINK._replace(i2c_repeated_start=False),
            [1, 1],
        ),
    ):
        bus = smbus_fake.SMBus(acp, [])
        assert (
            wire.Session(link, bus).get(acp.Identification).node_type == acp.NODE_TYPE
        )
        assert bus.parts == parts


def test_other_errors_of_an_i2c_bus_are_raised(acp, wire):
    session = wire.Session(acp.LINK, smbus_fake.SMBus(acp, [errno.EBADF]))
    with pytest.raises(OSError, match="remote"):
        session.get(acp.Identification)
    assert session.get(acp.Identification).node_type == acp.NODE_TYPE


def test_an_object_that_is_not_a_port_is_refused(acp, wire):
    with pytest.raises(
        TypeError, match="str is no port: a session takes a serial port, a socket"
    ):
        wire.Session(acp.LINK, "/dev/ttyUSB0")


def test_a_bus_that_the_icd_does_not_have_is_refused(acp, wire):
    link = acp.LINK._replace(i2c_address=None)
    with pytest.raises(wire.UnsupportedError, match="i2c"):
        wire.Session(link, smbus_fake.SMBus(acp, []))
