"""Sessions over framed links handle several requests that are in flight together.

A test double of the device sends the telemetry that each test lists.
"""

from __future__ import annotations

import asyncio
import re
import subprocess
import sys
import textwrap

import pytest
import yaml

from tests import documents
from tests.conftest import ROOT
from tests.python import packages

STATUS = {"name": "Navigation Status", "id": 0x0103, "kind": "telemetry", "length": 1}
FIELD = {"at": 0, "bits": 8, "name": "Fix", "type": "uint"}
POLL = {"name": "Poll Status", "id": 0x0103, "kind": "telecommand", "length": 0}
POLL["response"] = {"reply": "Navigation Status"}


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    icd = yaml.safe_load((ROOT / "examples" / "links" / "ubx.yaml").read_text("utf-8"))
    icd["messages"] += [{**STATUS, "fields": [FIELD]}, POLL]
    icd["protocol"]["link"]["client"] = {"in_flight": 3}
    folder = tmp_path_factory.mktemp("several")
    (folder / "receiver.yaml").write_text(yaml.safe_dump(icd))
    return packages.write(
        packages.read(folder / "receiver.yaml"), folder, "several_messages"
    )


@pytest.fixture(scope="module")
def node(package):
    return package.module("receiver")


@pytest.fixture(scope="module")
def wire(package):
    return package.module("wire")


class Device:
    """Test double of a device: records telecommands and sends prepared telemetry.

    ``answers`` are pairs of a count and a message: the device sends the message once it
    has received so many telecommands.
    """

    def __init__(self, wire, node, *answers):
        self.wire, self.node, self.answers, self.now = wire, node, list(answers), 0.0
        self.requests, self.decoder = [], wire.StreamDecoder(node.LINK, "telecommand")

    def line(self, message):
        return self.wire.stream_encode(self.node.LINK, message, direction="telemetry")

    def write(self, data):
        self.requests += [event.kind for event in self.decoder.feed(data)]

    def due(self):
        """Return the bytes to send now, and remove their messages from ``answers``."""
        due, later = b"", []
        for count, message in self.answers:
            if count <= len(self.requests):
                due += self.line(message)
            else:
                later.append((count, message))
        self.answers = later
        return due

    def read(self, seconds):
        self.now += min(seconds, 0.1)
        return self.due()

    def session(self, **options):
        return self.wire.Session(
            self.node.LINK, self.write, self.read, clock=lambda: self.now, **options
        )


def test_several_requests_are_sent_before_the_first_reply(wire, node):
    answers = (
        (2, node.NavigationStatus(fix=3)),
        (2, node.EndOfEpoch()),
        (2, node.NavigationClock(clock_bias=7)),
    )
    device, received = Device(wire, node, *answers), []
    session = device.session(on_event=received.append)
    clock, status = session.get_several(node.NavigationClock, node.NavigationStatus)
    assert (clock.clock_bias, status.fix) == (7, 3)
    assert (
        device.requests == [node.PollClock, node.PollStatus] and not session.client.busy
    )
    assert [event.of(node.EndOfEpoch) for event in received] == [node.EndOfEpoch()]
    assert session.get_several() == ()


def test_a_repeated_request_is_sent_after_the_first_reply(wire, node):
    device = Device(
        wire,
        node,
        (1, node.NavigationClock(clock_bias=1)),
        (2, node.NavigationClock(clock_bias=2)),
    )
    clocks = device.session().get_several(node.NavigationClock, node.NavigationClock)
    assert [clock.clock_bias for clock in clocks] == [1, 2] and device.requests == [
        node.PollClock,
        node.PollClock,
    ]


def test_a_missing_reply_is_an_error_and_ends_all_requests(wire, node):
    device = Device(wire, node, (2, node.NavigationClock()))
    session = device.session(settings=node.LINK.settings._replace(retries=0))
    with pytest.raises(wire.ReplyTimeoutError, match="Navigation Status"):
        session.get_several(node.NavigationClock, node.NavigationStatus)
    assert not session.client.busy and session.client.deadline is None


def test_an_error_of_the_port_ends_all_requests(wire, node):
    def read(seconds):
        raise OSError("unplugged")

    session = wire.Session(node.LINK, Device(wire, node).write, read)
    with pytest.raises(OSError, match="unplugged"):
        session.get_several(node.NavigationClock, node.NavigationStatus)
    assert not session.client.busy


class Writer:
    """Test double of a stream's writer; the device responds at once."""

    def __init__(self, device, reader):
        self.device, self.reader = device, reader

    def write(self, data):
        self.device.write(data)
        if due := self.device.due():
            self.reader.feed_data(due)

    async def drain(self):
        await asyncio.sleep(0)


def talk(wire, node, talking, *answers, **settings):
    """Run ``talking(session, device, reader)``, which may take five seconds."""

    async def run():
        reader = asyncio.StreamReader()
        device = Device(wire, node, *answers)
        chosen = node.LINK.settings._replace(**settings)
        session = wire.AsyncSession(
            node.LINK, reader, Writer(device, reader), settings=chosen
        )
        await asyncio.wait_for(talking(session, device, reader), 5)
        assert not session.client.busy and not session._boxes

    asyncio.run(run())


def test_several_tasks_request_messages_while_another_receives_telemetry(wire, node):
    async def talking(session, device, reader):
        received = []

        async def listen():
            async for message in session.messages(node.EndOfEpoch):
                received.append(message.time_of_week)
                if len(received) == 2:
                    break

        listening = asyncio.create_task(listen())
        await asyncio.sleep(0)
        reader.feed_data(device.line(node.EndOfEpoch(time_of_week=1)))
        get = session.get
        clock, status, next_clock = await asyncio.gather(
            get(node.NavigationClock),
            get(node.NavigationStatus),
            get(node.NavigationClock),
        )
        assert (clock.clock_bias, status.fix, next_clock.clock_bias) == (1, 3, 2)
        assert device.requests == [node.PollClock, node.PollStatus, node.PollClock]
        reader.feed_data(device.line(node.EndOfEpoch(time_of_week=2)))
        await listening
        assert received == [1, 2]
        await asyncio.sleep(0)

    answers = (2, node.NavigationStatus(fix=3)), (2, node.NavigationClock(clock_bias=1))
    talk(wire, node, talking, *answers, (3, node.NavigationClock(clock_bias=2)))


def test_a_slow_program_gets_the_last_messages_and_the_number_of_lost_ones(wire, node):
    async def talking(session, device, reader):
        reported, taken = [], []
        session._on_event = reported.append
        messages = session.messages(node.EndOfEpoch, limit=2)
        async for message in messages:
            taken.append(message.time_of_week)
            if len(taken) == 1:  # now another task reads
                clock = node.NavigationClock()
                for number in range(2, 7):
                    end_of_epoch = node.EndOfEpoch(time_of_week=number)
                    reader.feed_data(device.line(end_of_epoch) + device.line(clock))
                    await session.wait()
            if len(taken) == 3:
                break
        await messages.aclose()
        assert taken == [1, 5, 6]
        lost = [event for event in reported if isinstance(event, wire.Lost)]
        assert lost == [wire.Lost(3)]

    async def fed(session, device, reader):
        reader.feed_data(device.line(node.EndOfEpoch(time_of_week=1)))
        await talking(session, device, reader)

    talk(wire, node, fed)


@pytest.mark.parametrize("given_up", [0, 1])
def test_cancelling_a_task_does_not_end_the_requests_of_other_tasks(
    wire, node, given_up
):
    """Either task may be the one that reads for both tasks."""

    async def talking(session, device, reader):
        kinds = node.NavigationClock, node.NavigationStatus
        tasks = [asyncio.create_task(session.get(kind)) for kind in kinds]
        while len(device.requests) < 2:
            await asyncio.sleep(0)
        tasks[given_up].cancel()
        await asyncio.wait(tasks, timeout=0.01)
        reader.feed_data(
            device.line(node.NavigationStatus(fix=1))
            + device.line(node.NavigationClock())
        )
        other = await tasks[1 - given_up]
        assert isinstance(other, kinds[1 - given_up]) and tasks[given_up].cancelled()

    talk(wire, node, talking)


def test_each_task_gets_its_own_time_out_error(wire, node):
    async def talking(session, device, reader):
        results = await asyncio.gather(
            session.get(node.NavigationClock),
            session.get(node.NavigationStatus),
            return_exceptions=True,
        )
        assert results[0] == node.NavigationClock() and isinstance(
            results[1], wire.ReplyTimeoutError
        )

    talk(wire, node, talking, (2, node.NavigationClock()), reply_timeout=30, retries=1)


def test_every_task_gets_an_error_when_the_connection_is_closed(wire, node):
    async def talking(session, device, reader):
        asyncio.get_running_loop().call_later(0.01, reader.feed_eof)
        kinds = node.NavigationClock, node.NavigationStatus
        errors = await asyncio.gather(*map(session.get, kinds), return_exceptions=True)
        assert [type(error) for error in errors] == [ConnectionResetError] * 2

    talk(wire, node, talking)


def test_the_documented_example_runs_and_passes_the_type_checker(package, tmp_path):
    text = documents.text("reference/wire-framing")
    (example,) = re.findall(
        r"```python\n(clock, status = session.get_several.*?)```", text, re.S
    )
    first, following = example.split("\n", 1)
    program = f"""\
    import asyncio
    from several_messages.receiver import LINK, NavigationClock, NavigationStatus
    from several_messages.wire import AsyncSession, Session, stream_encode


    def line(message: NavigationClock | NavigationStatus) -> bytes:
        return stream_encode(LINK, message, direction="telemetry")


    def read(seconds: float) -> bytes:
        return line(NavigationStatus(fix=3)) + line(NavigationClock(clock_bias=5))


    sent: list[bytes] = []
    session = Session(LINK, sent.append, read)
    {first}
    assert (clock.clock_bias, status.fix, len(sent)) == (5, 3, 2)
    """
    (tmp_path / "several.py").write_text(
        "from __future__ import annotations\n\n" + textwrap.dedent(program) + following
    )
    environment = {"PYTHONPATH": str(package.folder), "MYPYPATH": str(package.folder)}
    for command in ("several.py",), ("-m", "mypy", "--strict", "several.py"):
        done = subprocess.run(
            [sys.executable, *command],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_requests_over_other_links_are_sent_in_turn(shipped):
    acp, wire = shipped.module("cubeacp"), shipped.module("wire")
    kinds = acp.EstimatedAttitudeAngles, acp.CurrentAdcsState
    decoder, requested, replies = wire.UartDecoder(acp.LINK), [], []

    def write(data):
        for event in decoder.feed(data):
            assert not replies  # to the request before
            requested.append(event.message[0])
            (kind,) = (kind for kind in kinds if event.message[0] == kind.ID)
            replies.append(
                wire.uart_encode(acp.LINK, bytes([kind.ID]) + kind().to_bytes())
            )

    session = wire.Session(
        acp.LINK, write, lambda seconds: replies.pop() if replies else b""
    )
    assert session.get_several(*kinds) == tuple(kind() for kind in kinds)
    assert requested == [kind.ID for kind in kinds]
