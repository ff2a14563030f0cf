"""Messages of framed links are classes of the generated package.

The tests use `stream_encode`, `StreamDecoder`, `Client` and `Session` of the package.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.conformance.icds import LINKS
from tests.conftest import ROOT
from tests.python import packages


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("packets")
    return packages.write(
        packages.read(LINKS / "packets.yaml"), folder, "packets_messages"
    )


@pytest.fixture(scope="module")
def node(package):
    return package.module("datagram")


@pytest.fixture(scope="module")
def stream(package):
    return package.module("wire.stream")


def events(stream, node, message):
    decoder = stream.StreamDecoder(node.LINK)
    return decoder.feed(stream.stream_encode(node.LINK, message, direction="telemetry"))


def test_the_data_distinguish_the_messages_of_a_shared_id(node, stream):
    for message in (
        node.ShortLevel(level=7),
        node.LevelOfTheFirst(level=1000),
        node.LevelOfAnother(which=2, level=-1000),
    ):
        (event,) = events(stream, node, message)
        assert (event.id, event.kind) == (3, type(message))
        assert (
            event.of(type(message))
            == message
            == node.decode_telemetry(event.id, event.data)
        )
        assert event.of(node.Least) is None


def test_data_that_match_no_message_of_their_id_have_no_class(package, node, stream):
    line = stream.stream_encode(node.LINK, 3, bytes(2), direction="telemetry")
    (event,) = stream.StreamDecoder(node.LINK).feed(line)
    assert (event.event, event.kind, event.of(node.ShortLevel)) == (
        "message",
        None,
        None,
    )
    with pytest.raises(package.module("_errors").UnknownIdError):
        node.decode_telemetry(event.id, event.data)


def test_optional_fields_and_variable_length_arrays_of_structs_travel_on_framed_links(
    node, stream
):
    choice = node.Choice(mode=1, level=5)
    (event,) = events(stream, node, choice)
    assert event.of(node.Choice) == choice and event.of(node.Choice).rate is None
    points = node.Points(
        points_count=2, points=(node.Point(east=1, north=-1), node.Point(east=2))
    )
    line = stream.stream_encode(node.LINK, points)
    (event,) = stream.StreamDecoder(node.LINK, "telecommand").feed(line)
    assert event.of(node.Points) == points


def test_requests_with_different_replies_are_in_flight_together(package, node, stream):
    settings = node.LINK.settings._replace(in_flight=2)
    client = package.module("wire.client").Client(node.LINK, settings=settings)
    events = package.module("wire.events")
    order = node.Order()
    client.send(0, order, reply=node.ShortLevel)
    client.send(1, order, reply=node.Least)
    # Its reply has the id of the first reply, so the client waits before it sends it.
    client.send(2, order, reply=node.LevelOfTheFirst)
    assert client.output() and client.output() and not client.output()

    def receive(now, message):
        return client.received(
            now, stream.stream_encode(node.LINK, message, direction="telemetry")
        )

    (done,) = receive(3, node.Least())
    assert (
        isinstance(done, events.Done) and done.message == node.Least() and client.busy
    )
    (other,) = receive(4, node.LevelOfTheFirst(level=1000))
    assert isinstance(other, events.Arrived)
    (done,) = receive(5, node.ShortLevel(level=7))
    assert (
        isinstance(done, events.Done)
        and done.of(node.ShortLevel).level == 7
        and done.reply == 3
    )
    assert client.output() and not client.output()
    (done,) = receive(6, node.LevelOfTheFirst(level=1000))
    assert isinstance(done, events.Done) and done.message.level == 1000
    assert not client.busy and client.deadline is None


def test_cancelling_a_request_leaves_the_other_requests_in_flight(package, node):
    client = package.module("wire.client").Client(node.LINK, requests=2)
    order = node.Order()
    client.send(0, order, reply=node.ShortLevel)
    client.send(1, node.Points(), reply=node.Least)
    with pytest.raises(package.module("wire.errors").BusyError, match="as many"):
        client.send(2, order)
    client.cancel("telecommand", node.Points.IDS[0])
    assert client.output() and not client.output() and client.busy
    assert client.tick(client.deadline) and not client.busy


SESSION_PROGRAM = """\
from collections.abc import Iterator

from icdgen_messages.receiver import LINK, NavigationClock, PollClock, SetMessageRate
from icdgen_messages.wire import Arrived, Session, StreamDecoder, stream_encode

sent: list[bytes] = []
events: list[object] = []
now = [0.0]


def read(seconds: float) -> bytes:
    now[0] += min(seconds, 0.5)
    return stream_encode(LINK, NavigationClock(clock_bias=len(sent)), direction="telemetry")


session = Session(LINK, sent.append, read, on_event=events.append, clock=lambda: now[0])
clock: NavigationClock = session.get(NavigationClock)
assert clock.clock_bias == 1 and session.answer(PollClock(), NavigationClock).clock_bias == 2
session.send(SetMessageRate(rate=5))
requests = [event for line in sent for event in StreamDecoder(LINK, "telecommand").feed(line)]
assert [event.kind for event in requests] == [PollClock, PollClock, SetMessageRate]
clocks: Iterator[NavigationClock] = session.messages(NavigationClock, seconds=2)
assert [message.clock_bias for message in clocks] == [3, 3, 3, 3]
assert all(isinstance(event, Arrived) and event.of(NavigationClock) for event in events) and len(events) == 4
"""


def test_a_session_requests_and_receives_messages_with_static_types(tmp_path):
    packages.write(
        packages.read(ROOT / "examples" / "links" / "ubx.yaml"),
        tmp_path,
        "icdgen_messages",
    )
    (tmp_path / "program.py").write_text(SESSION_PROGRAM)
    for command in (
        [sys.executable, "program.py"],
        [sys.executable, "-m", "mypy", "--strict", "program.py"],
    ):
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
