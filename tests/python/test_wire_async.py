"""The asyncio session works over connections to a simulator, and reports failures."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from urllib.parse import urlsplit

import pytest

from tests.sim.device import simulator


@pytest.fixture(scope="module")
def wire(shipped):
    return shipped.module("wire")


@pytest.fixture(scope="module")
def acp(shipped):
    return shipped.module("cubeacp")


@pytest.fixture(scope="module")
def simulator_address(tmp_path_factory):
    """Address of a simulator that stores a file."""
    file = tmp_path_factory.mktemp("files") / "file.bin"
    file.write_bytes(bytes(range(256)) * 3)
    options = (
        "--set",
        "Estimated Attitude Angles",
        "roll=-12.34",
        "--file",
        f"2:5={file}",
    )
    with simulator("--node", "cubeacp", "--tcp", "0", *options) as (address, _):
        yield urlsplit(address)


@asynccontextmanager
async def session(wire, acp, simulator_address, **options):
    reader, writer = await asyncio.open_connection(
        simulator_address.hostname, simulator_address.port
    )
    try:
        yield wire.AsyncSession(acp.LINK, reader, writer, **options)
    finally:
        writer.close()
        await writer.wait_closed()


@asynccontextmanager
async def served(wire, acp, answer):
    """Open a session to a server that runs ``answer(reader, writer)``."""

    async def handle(reader, writer):
        await answer(reader, writer)
        writer.close()

    server = await asyncio.start_server(handle, "127.0.0.1", 0)
    async with server:
        reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
        try:
            settings = acp.LINK.settings._replace(reply_timeout=50, retries=1)
            yield wire.AsyncSession(acp.LINK, reader, writer, settings=settings)
        finally:
            writer.close()


def test_a_command_is_acknowledged_and_telemetry_is_received(
    wire, acp, simulator_address
):
    async def talk():
        async with session(wire, acp, simulator_address) as device:
            await device.send(acp.SetAdcsRunMode(enabled=acp.AdcsRunMode.ENABLED))
            outcome = await device.ask(acp.EstimatedAttitudeAngles)
            return await device.get(acp.EstimatedAttitudeAngles), outcome

    angles, outcome = asyncio.run(talk())
    assert angles.estimated_roll_angle_deg == -12.34
    assert isinstance(outcome, wire.Done) and outcome.message == angles
    assert (
        outcome.of(acp.EstimatedAttitudeAngles) == angles
        and outcome.of(acp.Identification) is None
    )


def test_requests_of_several_tasks_wait_for_each_other(wire, acp, simulator_address):
    async def talk():
        async with session(wire, acp, simulator_address) as device:
            return await asyncio.gather(
                *(device.get(acp.Identification) for _ in range(5))
            )

    assert [message.node_type for message in asyncio.run(talk())] == [acp.NODE_TYPE] * 5


def test_a_download_does_not_block_the_event_loop(wire, acp, simulator_address):
    progress, turns = [], 0

    async def count():
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    async def talk():
        async with session(wire, acp, simulator_address) as device:
            counting = asyncio.create_task(count())
            download = acp.procedures.Download(type=2, counter=5, size=768)
            done = await device.run(download, lambda *sizes: progress.append(sizes))
            counting.cancel()
            return done.data

    assert asyncio.run(talk()) == bytes(range(256)) * 3
    assert progress[-1] == (768, 768) and turns > 10


class Quiet:
    """Test double of a writer that fails if a session writes to it."""

    def write(self, data):
        raise AssertionError(data)


@pytest.mark.parametrize("turns", range(6))
def test_a_cancellation_while_bytes_arrive_loses_no_bytes(wire, acp, turns):
    """Cancel the task ``turns`` turns of the loop after bytes arrive.

    The task may have ended by then.
    """

    async def talk():
        reader = asyncio.StreamReader()
        device = wire.AsyncSession(acp.LINK, reader, Quiet())
        waiting = asyncio.create_task(device.wait())
        for _ in range(3):
            await asyncio.sleep(0)
        reader.feed_data(b"\x1f\x7f\x92\0\1\2\3\4\5\x1f\xff")
        for _ in range(turns):
            await asyncio.sleep(0)
        if waiting.cancel():
            with pytest.raises(asyncio.CancelledError):
                await waiting
            return await device.wait()
        return await waiting

    (event,) = asyncio.run(talk())
    assert (event.id, event.data) == (146, bytes(range(6)))


def test_a_cancelled_session_releases_the_streams(wire, acp):
    async def talk():
        reader = asyncio.StreamReader()
        device = wire.AsyncSession(acp.LINK, reader, Quiet())
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(device.wait(), 0.01)
        assert not [
            task for task in asyncio.all_tasks() if task is not asyncio.current_task()
        ]
        reader.feed_data(b"free")
        return await reader.read(4)

    assert asyncio.run(talk()) == b"free"


def test_a_cancelled_request_leaves_the_session_idle(wire, acp, simulator_address):
    async def silent(reader, writer):
        await reader.read()

    async def talk():
        async with served(wire, acp, silent) as device:
            task = asyncio.create_task(device.get(acp.Identification))
            await asyncio.sleep(0.01)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            return device.client.busy

    assert asyncio.run(talk()) is False


def test_a_silent_node_is_a_time_out_and_a_closed_connection_is_an_error(wire, acp):
    async def silent(reader, writer):
        await reader.read()

    async def deaf(reader, writer):
        await reader.read(1)

    async def talk():
        async with served(wire, acp, silent) as device:
            with pytest.raises(wire.ReplyTimeoutError, match="after 2 attempts"):
                await device.get(acp.Identification)
            assert isinstance(
                await device.start(wire.Request("telemetry", 128)), wire.Timeout
            )
        async with served(wire, acp, deaf) as device:
            with pytest.raises(ConnectionResetError, match="closed"):
                await device.get(acp.Identification)
            assert not device.client.busy

    asyncio.run(talk())


def test_a_message_of_another_node_is_refused_at_once(
    shipped, wire, acp, simulator_address
):
    boot = shipped.module("bootloader")
    assert (
        boot.State.ID in acp.TELEMETRY
        and acp.TELEMETRY[boot.State.ID] is not boot.State
    )

    async def talk():
        async with session(wire, acp, simulator_address) as device:
            for request in (
                device.get(boot.State),
                device.ask(boot.State),
                device.send(boot.SetBootIndex()),
            ):
                with pytest.raises(
                    shipped.module().UnknownIdError, match="cubeacp has no"
                ):
                    await request

    asyncio.run(talk())
    for bus in ("uart", "i2c", "can"):
        client = wire.Client(acp.LINK, bus)
        with pytest.raises(shipped.module().UnknownIdError):
            client.request(0, boot.State)
        with pytest.raises(shipped.module().UnknownIdError):
            client.send(0, boot.SetBootIndex())
        assert not client.busy
