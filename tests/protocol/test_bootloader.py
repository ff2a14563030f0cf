"""A program is uploaded to a bootloader over a framed link in spite of lost messages.

A device that fails ends the upload with the reason. The bootloader is that of
``examples/links/bootloader.yaml``.
"""

from __future__ import annotations

import asyncio
from binascii import crc32
from random import Random

import pytest
from icdgen_runtime.wire.async_session import AsyncSession
from icdgen_runtime.wire.device import response_to
from icdgen_runtime.wire.events import Refused
from icdgen_runtime.wire.failures import FailedError
from icdgen_runtime.wire.procedures import Procedure
from icdgen_runtime.wire.sender import Sender
from icdgen_runtime.wire.session import Session
from icdgen_runtime.wire.stream import StreamDecoder

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conftest import ROOT

OK, BUSY, LOCKED = 0, 1, 4
ERASE, WRITE, SELECT, START = 0x01, 0x02, 0x03, 0x04
STATUS, BLOCK, IMAGE = 0x81, 0x82, 0x83
REQUESTS = {0x11: STATUS, 0x12: BLOCK, 0x13: IMAGE}
AREA = 1
PROGRAM = Random("program").randbytes(3000)


@pytest.fixture(scope="module")
def link():
    icd = load([ROOT / "examples" / "links" / "bootloader.yaml"]).icd
    return link_of(icd, facts.of(icd, icd.node("loader")))


class Loader:
    """Bootloader at the other end of a line that loses messages in both directions.

    Its time is that of the session, so that no test waits.
    """

    def __init__(self, link, loss=0.0, seed=""):
        self.link, self.loss, self.random = link, loss, Random(f"{loss} {seed}")
        self.decoder = StreamDecoder(link, "telecommand")
        self.sender = Sender(link, "telemetry")
        self.now = 0.0
        self.sent: list[bytes] = []
        self.memory = bytearray()
        self.block = b""
        self.size = 0
        self.erasure = 0.3  # duration in seconds
        self.busy_until = 0.0
        self.started: int | None = None
        self.received: list[int] = []

    def clock(self):
        return self.now

    def write(self, data):
        for event in self.decoder.feed(data):
            if not self.is_lost():
                self.telecommand(event.id, event.data)

    def read(self, seconds):
        if self.sent:
            self.now += 0.001
            return self.sent.pop(0)
        self.now += max(seconds, 0.001)
        return b""

    def is_lost(self):
        return self.random.random() < self.loss

    def telecommand(self, id, data):
        self.received.append(id)
        if id in REQUESTS:
            telemetry = REQUESTS[id]
            filled = self.telemetry(telemetry)
            response = response_to(self.link, id, data, "reply", telemetry=filled)
        else:
            result = self.execute(id, data)
            verdict = {OK: "ack", BUSY: "busy"}.get(result, "nak")
            reason = result if verdict == "nak" else None
            response = response_to(self.link, id, data, verdict, reason)
        if not self.is_lost():
            self.sent.append(self.sender.encode(response.id, response.data))

    def execute(self, id, data):
        """Execute a telecommand; return its result."""
        if data[0] != AREA:
            return LOCKED
        if id == ERASE:
            self.memory = bytearray(b"\xff" * 8192)
            self.busy_until = self.now + self.erasure
        elif id == WRITE:
            offset = int.from_bytes(data[1:5], "little")
            self.memory[offset : offset + 128] = data[5:]
        elif id == SELECT:
            offset = int.from_bytes(data[1:5], "little")
            self.size = offset + int.from_bytes(data[5:7], "little")
            self.block = bytes(self.memory[offset : self.size])
        elif id == START:
            self.started = data[0]
        return OK

    def telemetry(self, id):
        if id == STATUS:
            return bytes((self.now < self.busy_until,))
        data = self.block if id == BLOCK else bytes(self.memory[: self.size])
        return crc32(data).to_bytes(4, "little")


def upload(link, area=AREA, **options):
    return Procedure(link, "upload", {"area": area}, PROGRAM, **options)


def run(loader, procedure, progress=None):
    session = Session(loader.link, loader.write, loader.read, clock=loader.clock)
    return session.run(procedure, progress)


def failure(loader, procedure):
    with pytest.raises(FailedError) as caught:
        run(loader, procedure)
    return caught.value


@pytest.mark.parametrize("loss", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("seed", range(4))
def test_the_program_arrives_and_is_started(link, loss, seed):
    loader = Loader(link, loss, seed)
    run(loader, upload(link))
    assert loader.memory[: len(PROGRAM)] == PROGRAM
    assert (loader.size, loader.started) == (len(PROGRAM), AREA)


def test_each_packet_is_sent_once_if_nothing_is_lost(link):
    loader = Loader(link)
    run(loader, upload(link))
    assert loader.received.count(WRITE) == 8 + 8 + 8
    assert loader.received.count(SELECT) == 3


def test_the_progress_is_reported_after_each_block(link):
    reported = []
    run(Loader(link), upload(link), lambda done, total: reported.append((done, total)))
    assert reported == [(0, 3000), (1024, 3000), (2048, 3000), (3000, 3000)]


def test_a_smaller_block_has_fewer_packets(link):
    loader = Loader(link)
    run(loader, upload(link, block=300))
    assert loader.received.count(SELECT) == 10
    assert loader.received.count(WRITE) == 10 * 3
    assert loader.memory[: len(PROGRAM)] == PROGRAM


def test_a_program_of_no_bytes_has_no_blocks(link):
    loader = Loader(link)
    run(loader, Procedure(link, "upload", {"area": AREA}, b""))
    assert loader.received == [
        ERASE,
        *[0x11] * loader.received.count(0x11),
        0x13,
        START,
    ]


def test_a_refusal_ends_the_upload_with_its_reason(link):
    error = failure(Loader(link), upload(link, area=0))
    assert error.result == "refused"
    assert isinstance(error.event, Refused) and error.event.reason == "Locked"


def test_a_device_that_stays_busy_ends_the_upload(link):
    loader = Loader(link)
    loader.execute = lambda id, data: BUSY
    assert failure(loader, upload(link)).result == "busy"


def test_a_device_that_is_silent_ends_the_upload(link):
    assert failure(Loader(link, 1.0), upload(link)).result == "timeout"


def test_an_error_of_the_erasure_ends_the_upload(link):
    loader = Loader(link)
    loader.telemetry = lambda id: b"\3"
    assert failure(loader, upload(link)).result == "failed"


def test_an_erasure_without_end_ends_the_upload(link):
    loader = Loader(link)
    loader.telemetry = lambda id: b"\1"
    assert failure(loader, upload(link)).result == "timeout"
    assert 8 <= loader.now < 9


def test_a_damaged_block_is_written_again_and_given_up_after_all_rounds(link):
    loader, answer = Loader(link), Loader.telemetry
    loader.telemetry = lambda id: b"1234" if id == BLOCK else answer(loader, id)
    assert failure(loader, upload(link)).result == "checksum"
    assert loader.received.count(SELECT) == 8


def test_a_block_that_was_damaged_once_is_written_again(link):
    loader, answer, damaged = Loader(link), Loader.telemetry, [b"1234"]

    def telemetry(id):
        return damaged.pop() if id == BLOCK and damaged else answer(loader, id)

    loader.telemetry = telemetry
    run(loader, upload(link))
    assert loader.received.count(SELECT) == 4
    assert loader.memory[: len(PROGRAM)] == PROGRAM


def test_a_damaged_program_is_not_started(link):
    loader, answer = Loader(link), Loader.telemetry
    loader.telemetry = lambda id: b"1234" if id == IMAGE else answer(loader, id)
    assert failure(loader, upload(link)).result == "checksum"
    assert START not in loader.received


class Writer:
    """Stream writer of an `AsyncSession` to a loader, which responds at once."""

    def __init__(self, loader, reader):
        self.loader, self.reader = loader, reader

    def write(self, data):
        self.loader.write(data)
        while self.loader.sent:
            self.reader.feed_data(self.loader.sent.pop(0))

    async def drain(self):
        pass


def test_other_tasks_can_send_requests_during_an_upload(link):
    loader, statuses = Loader(link), []
    loader.erasure = 0.0

    async def talk():
        reader = asyncio.StreamReader()
        settings = link.settings._replace(in_flight=2)
        session = AsyncSession(link, reader, Writer(loader, reader), settings=settings)

        async def ask():
            for _ in range(20):
                statuses.append(await session.get(link.TELEMETRY[STATUS]))

        await asyncio.gather(session.run(upload(link)), ask())

    asyncio.run(talk())
    assert loader.started == AREA
    assert loader.memory[: len(PROGRAM)] == PROGRAM
    assert len(statuses) == 20
