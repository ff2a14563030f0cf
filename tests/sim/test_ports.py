"""Every kind of port transmits its bytes, and a port that cannot be opened is reported."""

from __future__ import annotations

import socket
import sys
from types import SimpleNamespace

import pytest
from icdgen_runtime.wire import (
    CanJoiner,
    CanMessage,
    CanPacket,
    Done,
    Link,
    Request,
    Timeout,
    can_split,
    identify,
)

from icdgen.errors import UserError
from icdgen.icd.model import buses_of
from icdgen.link.ports import CanBus, PortError, Serial, open_port
from icdgen.link.session import session
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.sim.device import ICD, simulator


@pytest.mark.pty
def test_a_serial_port_works_by_pyserial():
    link = cubeacp()
    with simulator("--node", "cubeacp", "--pty") as (place, _):
        port = Serial(
            place, buses_of(ICD.protocol_of(ICD.node("cubeacp")))["uart"]["line"]
        )
        with session(link, port) as client:
            outcome = client.start(Request("telemetry", link.identification.telemetry))
            assert isinstance(outcome, Done) and identify(link, outcome.data).matches


def test_a_can_bus_works_by_python_can():
    first, other = (
        CanBus("virtual", "icdgen", 500_000),
        CanBus("virtual", "icdgen", 500_000),
    )
    try:
        packet = CanPacket(0x1234567, b"\x01\x02")
        first.send(packet)
        assert other.receive(1.0) == packet
        assert other.receive(0.01) is None
    finally:
        first.close()
        other.close()


def test_a_request_over_can_without_a_response_times_out():
    link = cubeacp()
    settings = link.settings._replace(reply_timeout=50, retries=2)
    with session(
        link, open_port("can://virtual/silent", {}), settings=settings
    ) as client:
        assert client.start(
            Request("telemetry", link.identification.telemetry)
        ) == Timeout(128, 3)


def test_a_request_over_can_is_answered_by_the_node_of_the_icd():
    link, other = cubeacp(), CanBus("virtual", "talking", 500_000)
    node, ours = link.can.node_address, 0x2A
    frame = bytes(range(link.frames[128]))
    with session(link, open_port("can://virtual/talking", {}), address=ours) as client:
        for packet in can_split(link, CanMessage("reply", 128, node, ours, frame)):
            other.send(packet)  # it is read once the request has been sent
        assert client.start(Request("telemetry", 128)).data == frame
        request = CanJoiner(link).feed(0, other.receive(1.0))[0].message
        assert request == CanMessage("request", 128, ours, node)
    other.close()


def test_an_impossible_request_is_an_error_with_a_remedy_and_closes_the_port():
    link, port = cubeacp(), CanBus("virtual", "closed", 500_000)
    with pytest.raises(UserError) as error, session(link, port) as client:
        client.start(Request("telecommand", 1, bytes(100)))
    assert "100" in str(error.value) and error.value.help
    assert port.bus._is_shutdown


def cubeacp() -> Link:
    return link_of(ICD, facts.of(ICD, ICD.node("cubeacp")))


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("tcp://", "`tcp://` is no address"),
        ("tcp://localhost", "`tcp://localhost` is no address"),
        ("tcp://localhost:0", "`tcp://localhost:0` is no address"),
        ("tcp://localhost:65536", "`tcp://localhost:65536` is no address"),
        ("tcp://localhost:80/path", "`tcp://localhost:80/path` is no address"),
        ("udp://localhost:80?rate=9600", "is no address"),
        ("udp://localhost:80#1", "is no address"),
        ("tcp://user@localhost:80", "is no address"),
        ("tcp://127.0.0.1:1", "cannot connect to tcp://127.0.0.1:1"),
        ("tcp://[::1]:1", r"cannot connect to tcp://\[::1\]:1:"),
        ("ftp://x:1", "there is no port `ftp://x:1`"),
        ("/dev/no-such-port", "no such file"),
        ("can://x", "`can://x` is no CAN bus"),
        ("can:///0", "`can:///0` is no CAN bus"),
        ("can://none/0", "cannot open can://none/0"),
    ],
)
def test_a_port_that_cannot_be_opened_is_reported(name, words):
    with pytest.raises(PortError, match=words):
        open_port(name, {})


@pytest.mark.parametrize("kind", ["tcp", "udp"])
@pytest.mark.parametrize("host", ["a..b", "x" * 64])
def test_an_invalid_host_name_is_reported(kind, host):
    with pytest.raises(PortError, match="the host name is invalid") as error:
        open_port(f"{kind}://{host}:80", {})
    assert error.value.help == "check the host name"


@pytest.mark.parametrize("kind", ["tcp", "udp"])
def test_a_host_name_without_an_address_is_reported(kind, monkeypatch):
    def getaddrinfo(*arguments, **options):
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", getaddrinfo)
    with pytest.raises(PortError, match="my-bench:80: Name or service") as error:
        open_port(f"{kind}://my-bench:80", {})
    assert error.value.help == "check the host name"


def test_a_server_that_does_not_run_is_reported():
    with pytest.raises(PortError) as error:
        open_port("tcp://127.0.0.1:1", {})
    assert error.value.help == "is it running?"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("4000", "did you mean tcp://localhost:4000?"),
        ("127.0.0.1:4000", "did you mean tcp://127.0.0.1:4000?"),
        ("my-bench.local:80", "did you mean tcp://my-bench.local:80?"),
        ("[::1]:4000", "did you mean tcp://[::1]:4000?"),
        ("/dev/no-such-port", "no such file"),
        ("./no-such-port", "no such file"),
        ("dev/ttyUSB0:1/none", "no such file"),
    ],
)
def test_a_misspelt_port_gets_a_suggestion_before_pyserial_is_required(
    name, words, monkeypatch
):
    monkeypatch.setitem(sys.modules, "serial", None)
    with pytest.raises(PortError) as error:
        open_port(name, {})
    assert words in f"{error.value} {error.value.help}"
    assert "pyserial" not in f"{error.value} {error.value.help}"


@pytest.mark.parametrize(
    ("name", "package"), [("COM3", "pyserial"), ("can://virtual/0", "python-can")]
)
def test_a_missing_library_is_named(name, package, monkeypatch):
    monkeypatch.setitem(sys.modules, "serial", None)
    monkeypatch.setitem(sys.modules, "can", None)
    with pytest.raises(PortError, match=package) as error:
        open_port(name, {})
    assert "icdgen[link]" in error.value.help


@pytest.fixture
def receiver():
    """Open a datagram socket on this machine; return its address as a port of `icdgen`."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as opened:
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        opened.bind(("127.0.0.1", 0))
        opened.settimeout(5)
        yield opened, f"udp://127.0.0.1:{opened.getsockname()[1]}"


@pytest.mark.parametrize(
    ("size", "sizes"),
    [
        (1399, [1399]),
        (1400, [1400]),
        (1401, [1400, 1]),
        (4300, [1400, 1400, 1400, 100]),
    ],
)
def test_a_stream_over_udp_has_datagrams_that_no_network_splits(receiver, size, sizes):
    opened, text = receiver
    data = bytes(number % 251 for number in range(size))
    port = open_port(text, {})
    try:
        port.write(data)
        pieces = [opened.recv(65536) for _ in sizes]
    finally:
        port.close()
    assert [len(piece) for piece in pieces] == sizes and b"".join(pieces) == data


def test_a_packet_that_delimits_a_message_is_never_split(receiver):
    opened, text = receiver
    port = open_port(text, {"link": {"framing": {"by": "datagram"}}})
    try:
        port.write(bytes(5000))
        assert opened.recv(65536) == bytes(5000)
    finally:
        port.close()


def test_bytes_over_tcp_arrive_completely_in_both_directions():
    data = bytes(number % 251 for number in range(100_000))
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = open_port(f"tcp://127.0.0.1:{server.getsockname()[1]}", {})
        try:
            other, _ = server.accept()
            with other:
                other.settimeout(5)
                port.write(data)
                received = b""
                while len(received) < len(data):
                    received += other.recv(65536)
                assert received == data
                assert port.read(0) == b"", "nothing has come yet"
                other.sendall(b"answer")
                assert port.read(5) == b"answer"
            with pytest.raises(PortError, match="the other end closed the connection"):
                port.read(5)
        finally:
            port.close()


@pytest.mark.parametrize(
    ("protocol", "settings"),
    [
        ({}, (115200, 8, "N", 1)),
        (
            {"link": {"line": {"baud_rate": 9600, "parity": "even", "stop_bits": 2}}},
            (9600, 8, "E", 2),
        ),
        (
            {"link": {"buses": {"uart": {"line": {"data_bits": 7, "parity": "odd"}}}}},
            (115200, 7, "O", 1),
        ),
    ],
)
def test_a_serial_line_has_the_settings_of_the_icd_and_otherwise_115200_8n1(
    protocol, settings, monkeypatch
):
    opened = []

    class Line:
        def __init__(self, name, baud_rate, **options):
            line = (options["bytesize"], options["parity"], options["stopbits"])
            opened.append((name, (baud_rate, *line), options["exclusive"]))

    library = SimpleNamespace(Serial=Line, SerialException=OSError)
    monkeypatch.setitem(sys.modules, "serial", library)
    open_port("COM3", protocol)
    assert opened == [("COM3", settings, True)]
