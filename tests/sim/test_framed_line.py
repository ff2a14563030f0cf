"""Framed links, simulated and used by a client: unsolicited telemetry, responses, gaps,
and errors.
"""

from __future__ import annotations

import json
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from icdgen_runtime._errors import RangeError
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.errors import UnsupportedError
from icdgen_runtime.wire.events import Arrived, Done, Gap, LineError, Sent, Timeout
from icdgen_runtime.wire.session import Session

from icdgen.errors import UserError
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from icdgen.sim import run
from tests.conformance.icds import LINKS, icd_of
from tests.conftest import ROOT
from tests.sim.device import simulator

FOLDER = ROOT / "examples" / "links"
ICD = icd_of([FOLDER, LINKS / "packets.yaml"])
EXAMPLES = ["receiver", "positioner", "autopilot", "payload", "logger", "probe"]
POLL, CLOCK, EPOCH, RATE = 0x0122, 0x0122, 0x0161, 0x0601  # of the receiver


class MemoryPort:
    """A simulated device in memory with simulated time. ``spoil`` changes the bytes
    that it sends.
    """

    def __init__(self, node: str, spoil=lambda data: data, **options):
        self.line, self.control = run.build_device(ICD, node, run.Options(**options))
        self.spoil, self.now, self.queue = spoil, 0.0, []

    @property
    def ms(self) -> int:
        return round(self.now * 1000)

    def write(self, data: bytes) -> None:
        self.line.received(self.ms, data)

    def read(self, seconds: float) -> bytes:
        end = self.now + seconds
        while True:
            self.line.tick(self.ms)
            self.queue += filter(None, map(self.spoil, self.line.pieces(self.ms)))
            if self.queue:
                return self.queue.pop(0)
            deadline = self.line.deadline
            if deadline is None or deadline / 1000 >= end:
                self.now = end
                return b""
            self.now = max(self.now, deadline / 1000)


def talking(node: str, values=None, spoil=lambda data: data, **options):
    """Return a session, its port, and the list of its events."""
    heard, port = [], MemoryPort(node, spoil, **options)
    link = link_of(ICD, facts.of(ICD, ICD.node(node)))
    session = Session(
        link,
        port.write,
        port.read,
        on_event=heard.append,
        clock=lambda: port.now,
        values=values,
    )
    return session, port, heard


@pytest.mark.parametrize("node", EXAMPLES)
def test_unsolicited_telemetry_is_a_stream_of_messages(node):
    session, port, heard = talking(node, every=0.1)
    received = list(session.messages(seconds=0.35))
    wanted = [message.name for message in port.line.unsolicited]
    assert [message.NAME for message in received] == wanted * 4 and len(wanted) >= 1
    assert all(isinstance(event, Arrived) for event in heard)


def test_telemetry_comes_with_the_period_of_the_icd():
    """The measurement comes every 10 ms, although a telecommand can request it."""
    session, _, _ = talking("tfmini", every=None)
    received = [message.NAME for message in session.messages(seconds=0.095)]
    assert received == ["Measurement"] * 10
    session, _, _ = talking("tfmini", every=0.05)
    assert len(list(session.messages(seconds=0.095))) == 2


def test_only_the_selected_messages_are_reported():
    session, _, heard = talking("positioner", every=0.1)
    kind = session.client.link.TELEMETRY[0xFFFF]
    assert {type(message) for message in session.messages(kind, seconds=0.35)} == {
        kind
    } and len(heard) == 8


def test_a_telecommand_gets_the_response_of_the_icd():
    session, port, _ = talking("receiver", every=0)
    port.control.set("Navigation Clock", "Clock Bias", 77)
    outcome = session.start(Request("telecommand", POLL))
    assert isinstance(outcome, Done) and outcome.message.clock_bias == 77
    # The telemetry that the telecommand requests.
    assert session.get(session.client.link.TELEMETRY[CLOCK]).clock_bias == 77
    assert session.start(Request("telecommand", RATE, bytes(3))) == Sent(RATE, 1)
    with pytest.raises(UnsupportedError, match="sent unasked"):
        session.start(Request("telemetry", EPOCH))


def test_unsolicited_telemetry_is_no_response_and_a_silent_device_is_a_time_out():
    session, _, heard = talking(
        "receiver", spoil=lambda data: data if data[3] == 0x61 else b"", every=0.1
    )
    outcome = session.start(Request("telecommand", POLL, b"", True))
    assert (
        isinstance(outcome, Timeout)
        and outcome.attempts == 1 + session.client.settings.retries
    )
    assert {event.id for event in heard} == {EPOCH}


def test_messages_that_get_lost_are_gaps():
    lost = iter([False, False, True, True, True, False, False, False])
    session, _, heard = talking(
        "autopilot", spoil=lambda data: b"" if next(lost, False) else data, every=0.1
    )
    assert len(list(session.messages(seconds=0.35))) == 12 - 3
    assert [event for event in heard if isinstance(event, Gap)] == [Gap(30, 3)]


def test_sent_messages_have_sequence_numbers_and_the_chosen_addresses():
    session, port, _ = talking(
        "autopilot", values={"source": 9, "sequence": 254}, every=0
    )
    sent = []
    port.line.received = lambda now, data: sent.append(data)
    for _ in range(3):
        session.start(Request("telecommand", 11, bytes(6)))
    assert [(line[4], line[5]) for line in sent] == [(254, 9), (255, 9), (0, 9)]


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ({"source": 256}, RangeError),
        ({"time": 1}, UnsupportedError),
        ({"id": 1}, UnsupportedError),
    ],
)
def test_values_that_the_header_cannot_have_are_refused(values, error):
    with pytest.raises(error):
        talking("autopilot", values=values)


def test_a_framed_link_leaves_no_choice_of_a_checksum():
    port = MemoryPort("receiver")
    with pytest.raises(UnsupportedError, match="no choice"):
        Session(
            link_of(ICD, facts.of(ICD, ICD.node("receiver"))),
            port.write,
            port.read,
            crc=True,
        )


def damaged(data: bytes) -> bytes:
    return data[:-1] + bytes([data[-1] ^ 1]) if data else data


def test_a_wrong_checksum_is_reported_and_the_message_discarded():
    session, _, heard = talking("receiver", spoil=damaged, every=0)
    assert isinstance(session.start(Request("telecommand", POLL)), Timeout)
    assert heard == [LineError("checksum", CLOCK)]


def test_a_device_that_gets_a_wrong_checksum_does_nothing():
    session, port, _ = talking("receiver", every=0)
    receive = port.line.received
    port.line.received = lambda now, data: receive(now, damaged(data))
    assert isinstance(session.start(Request("telecommand", POLL)), Timeout)
    assert port.line.computer.program.counts == {"checksum": 1}


def icdgen(*words: str, folder: Path = FOLDER) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "icdgen", *words, "--icd", str(folder)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize(
    "way",
    [pytest.param(("--pty",), marks=pytest.mark.pty), ("--tcp", "0"), ("--udp", "0")],
)
def test_monitor_and_send_work_on_a_framed_link(way):
    options = (
        "--node",
        "receiver",
        "--every",
        "0.1",
        "--set",
        "Navigation Clock",
        "Clock Bias=-3",
        *way,
    )
    with simulator(*options, "--icd", str(FOLDER)) as (place, _):
        result = icdgen("send", "receiver", "Poll Clock", "--port", place)
        assert (
            result.returncode == 0
            and "answered with Navigation Clock" in result.stdout
            and "-3" in result.stdout
        )
        sent = icdgen(
            "send",
            "receiver",
            "Set Message Rate",
            "class=1",
            "number=2",
            "rate=3",
            "--port",
            place,
        )
        assert (sent.returncode, sent.stdout) == (
            0,
            "Set Message Rate: sent; the ICD describes no response to it\n",
        )
        shown = icdgen(
            "monitor",
            "receiver",
            "Navigation Clock",
            "--port",
            place,
            "--once",
            "--every",
            "0.4",
        )
        assert (
            shown.returncode == 0
            and "Clock Bias" in shown.stdout
            and "-3" in shown.stdout
        )
        if "--udp" not in way:  # UDP learns a peer from its first datagram
            all_ = icdgen(
                "monitor",
                "receiver",
                "--port",
                place,
                "--once",
                "--every",
                "0.4",
                "--format",
                "json",
            )
            assert [
                json.loads(line)["message"] for line in all_.stdout.splitlines()
            ] == ["End of Epoch"]


def test_the_monitor_reports_a_wrong_checksum():
    spoiled = ("--fault", "corrupt=100%@reply", "--every", "0", "--seed", "3")
    with simulator(
        "--node", "receiver", "--tcp", "0", *spoiled, "--icd", str(FOLDER)
    ) as (place, _):
        shown = icdgen(
            "monitor",
            "receiver",
            "Navigation Clock",
            "--port",
            place,
            "--once",
            "--every",
            "0.1",
        )
    assert (
        shown.returncode == 1
        and "wrong checksum" in shown.stdout
        and "no answer" not in shown.stdout
    )


def test_the_simulated_device_connects_to_a_listening_client():
    with socket.create_server(("127.0.0.1", 0)) as listening:
        place = f"tcp://127.0.0.1:{listening.getsockname()[1]}"
        options = ("--node", "positioner", "--every", "0.05", "--connect", place)
        with simulator(*options, "--icd", str(FOLDER)) as (startup, _):
            assert startup == f"to {place}"
            listening.settimeout(20)
            connection, _ = listening.accept()
            with connection:
                connection.settimeout(20)
                assert connection.recv(1) == b"\x55"


def test_messages_delimited_by_packets_need_a_packet_port():
    node = next(
        node.name
        for node in ICD.nodes
        if ICD.protocol_of(node)["link"]["framing"]["by"] == "datagram"
    )
    with pytest.raises(UserError, match="only packets"):
        run.run(ICD, node, [("tcp", "127.0.0.1", 0)], run.Options(), print)
    session, port, heard = talking(node, every=0.1)
    assert list(session.messages(seconds=0.15))
    assert sum(isinstance(event, Arrived) for event in heard) == 2 * len(
        port.line.unsolicited
    )


def test_a_value_of_no_field_of_the_header_is_refused():
    wrong = icdgen(
        "send",
        "receiver",
        "Poll Clock",
        "--port",
        "tcp://127.0.0.1:1",
        "--header",
        "source=1",
    )
    assert (
        wrong.returncode == 2
        and "no packet of receiver has a field `source`" in wrong.stderr
    )
    wrong = icdgen(
        "send",
        "autopilot",
        "Set Mode",
        "custom=1",
        "target=1",
        "base=1",
        "--port",
        "tcp://127.0.0.1:1",
        "--header",
        "source=256",
    )
    assert wrong.returncode == 2 and "from 0 to 255" in wrong.stderr


def test_a_receiver_of_the_examples_is_simulated_watched_and_configured():
    folder = ROOT / "examples" / "devices" / "ublox"
    chosen = ("--every", "0.1", "--set", "NAV-EOE", "iTOW=7", "--icd", str(folder))
    with simulator("--node", "ublox", "--tcp", "0", *chosen) as (place, _):
        shown = icdgen(
            "monitor",
            "ublox",
            "NAV-EOE",
            "--port",
            place,
            "--once",
            "--every",
            "1",
            folder=folder,
        )
        sent = icdgen(
            "send",
            "ublox",
            "CFG-RATE",
            "measRate=100",
            "navRate=1",
            "timeRef=0",
            "--port",
            place,
            folder=folder,
        )
    assert shown.returncode == 0 and "iTOW" in shown.stdout and "7" in shown.stdout, (
        shown.stderr
    )
    assert sent.returncode == 0 and "acknowledged with ACK-ACK" in sent.stdout, (
        sent.stderr
    )
