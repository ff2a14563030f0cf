"""Ports: every kind carries what is given to it, and what cannot be opened is said."""

from __future__ import annotations

import sys

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
from icdgen.link.ports import Can, PortError, Serial, open_port
from icdgen.link.session import session
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.sim.device import ICD, simulator


@pytest.mark.pty
def test_a_serial_port_by_pyserial():
    link = cubeacp()
    with simulator("--node", "cubeacp", "--pty") as (place, _):
        port = Serial(
            place, buses_of(ICD.protocol_of(ICD.node("cubeacp")))["uart"]["line"]
        )
        with session(link, port) as client:
            outcome = client.start(Request("telemetry", link.identification.telemetry))
            assert isinstance(outcome, Done) and identify(link, outcome.data).matches


def test_a_can_bus_by_python_can():
    one, other = Can("virtual", "icdgen", 500_000), Can("virtual", "icdgen", 500_000)
    try:
        packet = CanPacket(0x1234567, b"\x01\x02")
        one.send(packet)
        assert other.receive(1.0) == packet
        assert other.receive(0.01) is None
    finally:
        one.close()
        other.close()


def test_a_request_over_can_that_nobody_answers_ends():
    link = cubeacp()
    settings = link.settings._replace(reply_timeout=50, retries=2)
    with session(
        link, open_port("can://virtual/silent", {}), settings=settings
    ) as client:
        assert client.start(
            Request("telemetry", link.identification.telemetry)
        ) == Timeout(128, 3)


def test_a_request_over_can_is_answered_by_the_node_of_the_icd():
    link, other = cubeacp(), Can("virtual", "talking", 500_000)
    node, ours = link.can.node_address, 0x2A
    frame = bytes(range(link.frames[128]))
    with session(link, open_port("can://virtual/talking", {}), address=ours) as client:
        for packet in can_split(link, CanMessage("reply", 128, node, ours, frame)):
            other.send(packet)  # it is read once the request has been sent
        assert client.start(Request("telemetry", 128)).data == frame
        asked = CanJoiner(link).feed(0, other.receive(1.0))[0].message
        assert asked == CanMessage("request", 128, ours, node)
    other.close()


def test_what_cannot_be_asked_is_an_error_with_a_remedy_and_closes_the_port():
    link, port = cubeacp(), Can("virtual", "closed", 500_000)
    with pytest.raises(UserError) as error, session(link, port) as client:
        client.start(Request("telecommand", 1, bytes(100)))
    assert "100" in str(error.value) and error.value.help
    assert port.bus._is_shutdown


def cubeacp() -> Link:
    return link_of(ICD, facts.of(ICD, ICD.node("cubeacp")))


@pytest.mark.parametrize(
    "name",
    [
        "tcp://",
        "tcp://localhost",
        "tcp://127.0.0.1:1",
        "ftp://x:1",
        "/dev/no-such-port",
        "can://x",
        "can://none/0",
    ],
)
def test_what_cannot_be_opened_is_said(name):
    with pytest.raises(PortError):
        open_port(name, {})


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
def test_what_was_meant_is_said_before_pyserial_is_asked_for(name, words, monkeypatch):
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
