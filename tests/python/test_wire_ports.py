"""Sessions continue after errors of a port, cancelled requests and late responses.

The simulated node responds through a test double, a serial port or a socket.
"""

from __future__ import annotations

import os
import pickle
import pty
import socket
import threading
import tty

import pytest
import serial

from tests.python import packages
from tests.sim.port import DevicePort


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


class FailingPort(DevicePort):
    """Port whose method named by ``fails`` raises an error."""

    fails: str = ""

    def write(self, data: bytes) -> None:
        if self.fails == "write":
            raise OSError("unplugged")
        super().write(data)

    def read(self, seconds: float) -> bytes:
        if self.fails == "read":
            raise OSError("unplugged")
        return super().read(seconds)


@pytest.mark.parametrize("fails", ["read", "write"])
@pytest.mark.parametrize("what", ["get", "send", "start", "run"])
def test_a_session_continues_after_an_error_of_its_port(shipped, wire, fails, what):
    acp = shipped.module("cubeacp")
    port = FailingPort(packages.shipped(), "cubeacp")
    talking = wire.Session(acp.LINK, port.write, port.read, clock=port.clock)
    calls = {
        "get": lambda: talking.get(acp.Identification),
        "send": lambda: talking.send(acp.ClearErrors()),
        "start": lambda: talking.start(wire.Request("telemetry", 128)),
        "run": lambda: talking.run(acp.procedures.List()),
    }
    port.fails = fails
    for _ in range(2):
        with pytest.raises(OSError, match="unplugged"):
            calls[what]()
        assert not talking.client.busy and talking.client.output() == b""
    port.fails = ""
    calls[what]()
    assert talking.get(acp.Identification).node_type == acp.NODE_TYPE


def test_a_session_continues_after_an_error_of_the_event_handler(shipped, wire):
    acp = shipped.module("cubeacp")
    port = DevicePort(packages.shipped(), "cubeacp")

    def on_event(event):
        raise KeyError("no such handler")

    talking = wire.Session(
        acp.LINK, port.write, port.read, clock=port.clock, on_event=on_event
    )
    port.line._send(0, "log", wire.LogMessage.encode(acp.LINK, bytes(10), []))
    with pytest.raises(KeyError):
        talking.get(acp.Identification)
    assert talking.get(acp.Identification).node_type == acp.NODE_TYPE


def test_a_late_reply_to_a_cancelled_request_does_not_end_the_next_request(
    shipped, wire
):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "uart")
    client.request(0, acp.EstimatedAttitudeAngles)
    client.cancel()
    # The output was not taken before the request was cancelled, so it is not sent.
    assert (client.busy, client.deadline, client.output()) == (False, None, b"")
    client.request(1, acp.EstimatedAttitudeAngles)
    assert client.output()  # at once: no reply to the unsent request can come
    client.cancel()
    client.request(1, acp.EstimatedAttitudeAngles)
    assert client.output() == b""  # the same id waits: this one was sent
    client.cancel()
    client.request(2, acp.EstimatedAngularRates)
    assert client.output()
    line = wire.uart_encode(acp.LINK, b"\x92" + bytes(6))
    late = wire.Late(146, bytes(6), acp.EstimatedAttitudeAngles)
    assert client.received(3, line) == [late]
    (done,) = client.received(4, wire.uart_encode(acp.LINK, b"\x93" + bytes(6)))
    assert done.id == 147


def test_a_transfer_that_was_not_started_cannot_end(shipped, wire):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "i2c")
    client.request(0, acp.EstimatedAttitudeAngles)
    client.transfers()
    client.cancel()
    client.send(1, acp.Reset())
    assert client.transferred(2, bytes(6)) == [
        wire.Late(146, bytes(6), acp.EstimatedAttitudeAngles)
    ]  # the bytes of the telemetry: the reset is not written yet
    assert client.busy
    client.transfers()
    assert client.transferred(3, b"") == [wire.Sent(acp.Reset.ID)]


def test_the_client_starts_no_transaction_while_eight_results_are_missing(
    shipped, wire
):
    acp = shipped.module("cubeacp")
    client = wire.Client(acp.LINK, "i2c")
    for now in range(8):
        client.request(now, acp.EstimatedAttitudeAngles)
        assert client.transfers()
        client.cancel()
    client.request(8, acp.EstimatedAngularRates)
    assert client.transfers() == [] and client.busy
    (late,) = client.transferred(9, bytes(6))
    assert (type(late), late.id) == (wire.Late, 146)
    assert client.transfers()
    for now in range(10, 17):
        assert type(client.transferred(now, bytes(6))[0]) is wire.Late
    (done,) = client.transferred(17, bytes(6))
    assert (type(done), done.id) == (wire.Done, 147)
    assert client.transferred(18, b"\1") == [wire.Stray(b"\1")]


def test_the_outcome_of_a_telecommand_without_acknowledge_is_sent(shipped, wire):
    acp = shipped.module("cubeacp")
    for bus in ("uart", "can"):
        client = wire.Client(acp.LINK, bus)
        client.send(0, acp.Reset())
        assert client.output() or client.packets()
        assert client.tick(0) == [wire.Sent(acp.Reset.ID)]
    outcomes = []
    port = DevicePort(packages.shipped(), "cubeacp")
    talking = wire.Session(acp.LINK, port.write, port.read, clock=port.clock)
    outcomes.append(talking.start(wire.Request("telecommand", acp.Reset.ID, b"\x5a")))
    assert outcomes == [wire.Sent(acp.Reset.ID)]


def test_a_damaged_frame_is_reported_whether_or_not_it_was_requested(shipped, wire):
    acp = shipped.module("cubeacp")
    for is_requested in (True, False):
        client = wire.Client(acp.LINK, "uart")
        if is_requested:
            client.request(0, acp.EstimatedAttitudeAngles)
        events = client.received(1, wire.uart_encode(acp.LINK, b"\x92" + bytes(5)))
        assert events == [wire.LineError("length", 146)]
        assert client.busy == is_requested


@pytest.fixture
def line():
    """Serial port, and the file descriptor of its other end."""
    far, near = pty.openpty()
    tty.setraw(near)
    port = serial.Serial(os.ttyname(near), 921600)
    yield port, far
    port.close()
    os.close(far)
    os.close(near)


class SerialNode(threading.Thread):
    """Simulated node at the other end of a serial line; ends when the line closes."""

    def __init__(self, far: int) -> None:
        super().__init__(daemon=True)
        self.far, self.port = far, DevicePort(packages.shipped(), "cubeacp")
        self.start()

    def run(self) -> None:
        try:
            while True:
                self.port.write(os.read(self.far, 4096))
                os.write(self.far, self.port.read(1))
        except OSError:
            return


@pytest.mark.pty
def test_serial_port_adapts_a_port_of_pyserial(shipped, wire, line):
    acp = shipped.module("cubeacp")
    port, far = line
    SerialNode(far)
    talking = wire.Session(acp.LINK, *wire.serial_port(port))
    assert talking.get(acp.Identification).node_type == acp.NODE_TYPE
    talking.send(acp.ClearErrors())
    assert len(talking.get(acp.AdcsConfiguration).to_bytes()) == 504


@pytest.mark.pty
def test_a_silent_serial_port_is_a_time_out(shipped, wire, line):
    acp = shipped.module("cubeacp")
    settings = wire.Settings(
        reply_timeout=40, retries=1, poll_interval=1, poll_timeout=1
    )
    talking = wire.Session(acp.LINK, *wire.serial_port(line[0]), settings=settings)
    with pytest.raises(wire.ReplyTimeoutError, match="2 attempts"):
        talking.get(acp.Identification)


class SocketNode(threading.Thread):
    """Simulated node at the other end of a socket; ends when the socket is closed."""

    def __init__(self, far: socket.socket) -> None:
        super().__init__(daemon=True)
        self.far, self.port = far, DevicePort(packages.shipped(), "cubeacp")
        self.start()

    def run(self) -> None:
        try:
            while data := self.far.recv(4096):
                self.port.write(data)
                self.far.sendall(self.port.read(1))
        except OSError:
            return


def test_socket_port_adapts_a_socket(shipped, wire):
    acp = shipped.module("cubeacp")
    near, far = socket.socketpair()
    with near, far:
        SocketNode(far)
        talking = wire.Session(acp.LINK, *wire.socket_port(near))
        assert talking.get(acp.Identification).node_type == acp.NODE_TYPE
        talking.send(acp.ClearErrors())
        near.shutdown(socket.SHUT_RDWR)


def test_a_silent_socket_is_a_time_out_and_its_own_time_out_stays_unchanged(
    shipped, wire
):
    acp = shipped.module("cubeacp")
    settings = wire.Settings(
        reply_timeout=40, retries=1, poll_interval=1, poll_timeout=1
    )
    near, far = socket.socketpair()
    with near, far:
        near.settimeout(7)
        talking = wire.Session(acp.LINK, *wire.socket_port(near), settings=settings)
        with pytest.raises(
            wire.ReplyTimeoutError,
            match=r"^Identification \(id 128\) had no reply after 2 attempts$",
        ):
            talking.get(acp.Identification)
        assert near.gettimeout() == 7


def test_a_socket_closed_by_the_other_side_is_an_error_at_once(shipped, wire):
    acp = shipped.module("cubeacp")
    near, far = socket.socketpair()
    with near:
        talking = wire.Session(acp.LINK, *wire.socket_port(near))
        far.shutdown(socket.SHUT_WR)  # what is sent still arrives
        with far, pytest.raises(ConnectionResetError, match="closed"):
            talking.get(acp.Identification)


@pytest.mark.parametrize(
    ("fault", "error", "message_text"),
    [
        (
            "nack=100%",
            "RefusedError",
            "Clear Errors (id 12) was refused: Incorrect Parameter",
        ),
        (
            "drop=100%",
            "ReplyTimeoutError",
            "Clear Errors (id 12) had no reply after 1 attempt",
        ),
    ],
)
def test_an_error_names_the_message(shipped, wire, fault, error, message_text):
    acp = shipped.module("cubeacp")
    port = DevicePort(packages.shipped(), "cubeacp", faults=[fault])
    talking = wire.Session(acp.LINK, port.write, port.read, clock=port.clock)
    with pytest.raises(getattr(wire, error)) as caught:
        talking.send(acp.ClearErrors())
    assert (
        str(caught.value)
        == str(pickle.loads(pickle.dumps(caught.value)))
        == message_text
    )
