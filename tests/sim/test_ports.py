"""Ports: every kind carries what is given to it, and what cannot be opened is said."""

from __future__ import annotations

import sys

import pytest

from icdgen.link.ports import Can, PortError, Serial, open_port
from icdgen.link.session import Session
from icdgen.protocol.can import Packet
from tests.sim.device import FAST, ICD, simulator


@pytest.mark.pty
def test_a_serial_port_by_pyserial():
    node = ICD.node("cubeacp")
    with simulator("--node", "cubeacp", "--pty") as (place, _):
        port = Serial(place, ICD.protocol_of(node)["uart"])
        with Session(ICD, node, port, settings=FAST) as client:
            assert client.identify()[1]


def test_a_can_bus_by_python_can():
    one, other = Can("virtual", "icdgen", 500_000), Can("virtual", "icdgen", 500_000)
    try:
        packet = Packet(0x1234567, b"\x01\x02")
        one.send(packet)
        assert other.receive(1.0) == packet
        assert other.receive(0.01) is None
    finally:
        one.close()
        other.close()


def test_a_request_over_can_that_nobody_answers_ends():
    node = ICD.node("cubeacp")
    with Session(ICD, node, open_port("can://virtual/silent", {}), settings=FAST) as client:
        assert client.identify() is None


@pytest.mark.parametrize(
    "name",
    ["tcp://", "tcp://localhost", "tcp://127.0.0.1:1", "ftp://x:1", "/dev/no-such-port", "can://x", "can://none/0"],
)
def test_what_cannot_be_opened_is_said(name):
    with pytest.raises(PortError):
        open_port(name, {})


@pytest.mark.parametrize(
    ("name", "words"),
    [
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


@pytest.mark.parametrize(("name", "package"), [("COM3", "pyserial"), ("can://virtual/0", "python-can")])
def test_a_missing_library_is_named(name, package, monkeypatch):
    monkeypatch.setitem(sys.modules, "serial", None)
    monkeypatch.setitem(sys.modules, "can", None)
    with pytest.raises(PortError, match=package) as error:
        open_port(name, {})
    assert "icdgen[link]" in error.value.help
