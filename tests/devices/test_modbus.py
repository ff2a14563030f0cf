"""Modbus RTU interoperates with pymodbus, and published frames are decoded.

A server of pymodbus is the device of the generated client; a client of pymodbus talks
to `icdgen sim`.
"""

from __future__ import annotations

import asyncio
import socket
import threading
from contextlib import contextmanager

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.events import (
    Busy,
    Done,
    Late,
    LineError,
    Refused,
    Stray,
    Timeout,
)
from icdgen_runtime.wire.stream import StreamDecoder, stream_encode

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.recognize import recognize
from icdgen.runtime_objects.links import link_of
from icdgen.values.errors import Ambiguous
from tests.conftest import ROOT
from tests.python import packages
from tests.sim.device import simulator
from tests.sim.test_framed_line import icdgen

METER = ROOT / "examples" / "links" / "modbus.yaml"
MEASURED = [2301, 0, 1250, 0, 2876, 0, 2901, 991, 5002, 0xFFF6]  # registers from 0 on
ENERGY, LIMITS = [1, 0, 0, 7], [2500, 160, 1]
FIRST_OF_ENERGY, FIRST_OF_LIMITS = 0x10, 0x100

pymodbus = pytest.importorskip("pymodbus")
RTU = pymodbus.FramerType.RTU


@pytest.fixture(scope="module")
def meter(tmp_path_factory):
    """The generated package."""
    folder = tmp_path_factory.mktemp("meter")
    return packages.write(load([METER]).icd, folder, "modbus_meter")


class Server:
    """A server of pymodbus with the registers of the meter.

    ``codes``: exceptions of the next requests; None: the request is executed.
    """

    def __init__(self) -> None:
        self.codes: list[object] = []
        self.requests: list[
            tuple[int, int, int]
        ] = []  # function, first register, count

    async def act(self, function, start, address, count, registers, values):
        self.requests.append((function, address, count))
        return self.codes.pop(0) if self.codes else None

    async def listen(self, started) -> None:
        simulated, server = import_server()
        blocks = {0: MEASURED, FIRST_OF_ENERGY: ENERGY, FIRST_OF_LIMITS: LIMITS}
        data = [
            simulated.SimData(at, values=values, datatype=simulated.DataType.REGISTERS)
            for at, values in blocks.items()
        ]
        device = simulated.SimDevice(1, data, action=self.act)
        listening = server.ModbusTcpServer(device, framer=RTU, address=("127.0.0.1", 0))
        await listening.listen()
        self.port = listening.transport.sockets[0].getsockname()[1]
        self.stop = asyncio.Event()
        self.loop = asyncio.get_running_loop()
        started.set()
        await self.stop.wait()
        await listening.shutdown()


def import_server():
    from pymodbus import server, simulator

    return simulator, server


@contextmanager
def served():
    server, started = Server(), threading.Event()
    thread = threading.Thread(target=lambda: asyncio.run(server.listen(started)))
    thread.start()
    assert started.wait(10)
    try:
        yield server
    finally:
        server.loop.call_soon_threadsafe(server.stop.set)
        thread.join(10)


@pytest.fixture
def device(meter):
    """A server of pymodbus, the generated module, and a session with the server."""
    module, wire = meter.module("meter"), meter.module("wire")
    with served() as server, socket.create_connection(("127.0.0.1", server.port)) as to:
        yield server, module, wire.Session(module.LINK, to)


def code_of(name: str):
    return getattr(pymodbus.constants.ExcCodes, name)


def test_a_block_of_registers_of_a_server_is_read(device):
    server, module, session = device
    measured = session.get(module.Measurements)
    assert measured.voltage_v == 230.1 and measured.current_a == 1.25
    assert measured.frequency_hz == 50.02 and measured.temperature_c == -1
    energy = session.get(module.Energy)
    assert (energy.imported, energy.exported) == (1 << 16, 7)
    assert server.requests == [(3, 0, 10), (3, FIRST_OF_ENERGY, 4)]


def test_registers_of_a_server_are_written_and_read_again(device):
    server, module, session = device
    three = module.Mode.THREE_PHASES
    limits = module.SetLimits(
        largest_voltage_v=251.5, largest_current_a=12.5, mode=three
    )
    session.send(limits)
    written = session.get(module.Limits)
    assert (written.largest_voltage_v, written.largest_current_a) == (251.5, 12.5)
    assert server.requests[0] == (16, FIRST_OF_LIMITS, 3)


@pytest.mark.parametrize("what", ["read", "written"])
def test_an_exception_of_a_server_refuses_with_its_reason(device, meter, what):
    server, module, session = device
    server.codes = [code_of("ILLEGAL_ADDRESS")]
    with pytest.raises(meter.module("wire").RefusedError) as caught:
        if what == "read":
            session.get(module.Measurements)
        else:
            session.send(module.SetLimits())
    assert caught.value.event.code == 2
    assert caught.value.event.reason == "Illegal data address"
    assert len(server.requests) == 1


def test_a_request_that_a_busy_server_defers_is_repeated(device):
    server, module, session = device
    server.codes = [code_of("DEVICE_BUSY")]
    assert session.get(module.Energy).exported == 7
    server.codes = [code_of("DEVICE_BUSY"), code_of("DEVICE_BUSY")]
    session.send(module.SetLimits())
    assert len(server.requests) == 2 + 3


def test_a_server_that_stays_busy_ends_the_request(device, meter):
    server, module, session = device
    server.codes = 9 * [code_of("DEVICE_BUSY")]
    with pytest.raises(meter.module("wire").DeviceBusyError) as caught:
        session.get(module.Energy)
    assert caught.value.event.reason == "Device busy"
    assert len(server.requests) == 3


def test_send_and_monitor_talk_to_a_server():
    with served() as server:
        place = f"tcp://127.0.0.1:{server.port}"
        words = ["largest_voltage=240", "largest_current=10", "mode=1"]
        sent = icdgen(
            "send", "meter", "Set Limits", *words, "--port", place, folder=METER
        )
        assert sent.returncode == 0, sent.stderr
        assert "acknowledged" in sent.stdout
        server.codes = [code_of("ILLEGAL_VALUE")]
        refused = icdgen(
            "send", "meter", "Set Limits", *words, "--port", place, folder=METER
        )
        assert refused.returncode == 1
        assert "refused: Illegal data value (code 3)" in refused.stdout + refused.stderr
        shown = icdgen(
            *("monitor", "meter", "Limits", "--port", place, "--count", "1"),
            folder=METER,
        )
        assert shown.returncode == 0 and "240" in shown.stdout


@contextmanager
def reader(*options: str):
    """A client of pymodbus that is connected to `icdgen sim`."""
    from pymodbus.client import ModbusTcpClient

    words = ("--icd", str(METER), "--node", "meter", "--tcp", "0", *options)
    with simulator(*words) as (place, _):
        port = int(place.rpartition(":")[2])
        client = ModbusTcpClient("127.0.0.1", framer=RTU, port=port, retries=0)
        assert client.connect()
        try:
            yield client
        finally:
            client.close()


def test_the_simulator_answers_a_client():
    with reader() as client:
        read = client.read_holding_registers(FIRST_OF_LIMITS, count=3, device_id=1)
        assert not read.isError() and len(read.registers) == 3
        written = client.write_registers(FIRST_OF_LIMITS, [2400, 100, 1], device_id=1)
        assert not written.isError() and written.address == FIRST_OF_LIMITS


@pytest.mark.parametrize(
    ("ask", "code"),
    [
        (lambda client: client.read_holding_registers(0x50, count=3), 2),
        (lambda client: client.read_holding_registers(0, count=3), 3),
        (lambda client: client.write_registers(0x50, [1, 2, 3]), 2),
        (lambda client: client.write_registers(FIRST_OF_LIMITS, [3001, 1, 1]), 3),
        (lambda client: client.write_registers(FIRST_OF_LIMITS, [1]), 3),
    ],
)
def test_the_simulator_refuses_with_the_exception_of_the_icd(ask, code):
    with reader("--strict") as client:
        answered = ask(client)
        assert answered.isError() and answered.exception_code == code


def test_the_simulator_is_busy_as_a_device_is():
    with reader("--fault", "busy=100%") as client:
        answered = client.write_registers(FIRST_OF_LIMITS, [1, 2, 1], device_id=1)
        assert answered.isError() and answered.exception_code == 6


LINK = link_of(icd := load([METER]).icd, facts.of(icd, icd.node("meter")))
MEASUREMENTS, ENERGY_ID, LIMITS_ID, SIZE_OF_ENERGY = 0, 0x10, 0x100, 8


def test_a_response_belongs_to_the_request_that_waits_for_it():
    client = Client(LINK, settings=LINK.settings._replace(in_flight=2))
    client.start(0, Request("telemetry", ENERGY_ID))
    client.start(0, Request("telemetry", LIMITS_ID))
    assert client.output() and not client.output()  # one at a time
    energy = stream_encode(LINK, ENERGY_ID, b"E" * SIZE_OF_ENERGY, "telemetry")
    (done,) = client.received(10, energy)
    assert isinstance(done, Done)
    assert (done.id, done.data) == (ENERGY_ID, b"E" * SIZE_OF_ENERGY)
    assert client.output()
    (stray,) = client.received(20, energy)  # not as long as the limits
    assert stray == LineError("length", LIMITS_ID)
    (done,) = client.received(30, stream_encode(LINK, LIMITS_ID, bytes(6), "telemetry"))
    assert isinstance(done, Done) and done.id == LIMITS_ID


def test_a_response_without_a_request_is_a_stray_and_a_late_one_is_late():
    client = Client(LINK, settings=LINK.settings._replace(retries=0))
    energy = stream_encode(LINK, ENERGY_ID, bytes(SIZE_OF_ENERGY), "telemetry")
    (stray,) = client.received(0, energy)
    assert isinstance(stray, Stray) and stray.data == energy
    client.start(0, Request("telemetry", ENERGY_ID))
    assert client.output()
    (ended,) = client.tick(500)
    assert isinstance(ended, Timeout)
    client.start(500, Request("telemetry", LIMITS_ID))
    assert not client.output()  # the late response could be taken for its own
    (late,) = client.received(600, energy)
    assert isinstance(late, Late) and late.id == ENERGY_ID
    assert client.output()


def test_an_exception_refuses_and_a_busy_meter_gets_the_request_again():
    client = Client(LINK, settings=LINK.settings._replace(retries=1))
    client.start(0, Request("telemetry", ENERGY_ID))
    assert client.output()
    busy, refused = (bytes.fromhex(line) for line in ("018306C132", "018302C0F1"))
    client.received(10, busy)
    assert not client.output()
    client.tick(110)
    assert client.output()
    (event,) = client.received(120, busy)
    assert isinstance(event, Busy) and (event.code, event.attempts) == (6, 2)
    client.start(200, Request("telemetry", ENERGY_ID))
    assert client.output()
    (event,) = client.received(210, refused)
    assert isinstance(event, Refused) and event.reason == "Illegal data address"


def test_a_request_for_another_number_of_registers_is_reported():
    decoder = StreamDecoder(LINK, "telecommand")
    (event,) = decoder.feed(bytes.fromhex("01 03 00 10 00 05 84 0C"))
    assert (event.event, event.id, event.is_request) == ("length", ENERGY_ID, True)


def test_registers_and_bytes_of_a_write_must_agree():
    good = stream_encode(LINK, LIMITS_ID, bytes(6))
    assert good[4:7] == bytes([0, 3, 6])
    decoder = StreamDecoder(LINK, "telecommand")
    wrong = bytearray(good)
    wrong[6] = 4
    events = decoder.feed(bytes(wrong) + good + good)
    assert "message" in [event.event for event in events]
    assert all(event.data == bytes(6) for event in events if event.event == "message")


# Of public descriptions of Modbus RTU: requests and their responses.
READ = "11 03 00 6B 00 03 76 87", "11 03 06 AE 41 56 52 43 40 49 AD"
WRITTEN = "11 10 00 01 00 02 04 00 0A 01 02 C6 F0", "11 10 00 01 00 02 12 98"
REGISTERS = """
  - name: Readings
    id: 0x6B
    kind: telemetry
    length: 6
    fields: [{at: 0, bits: 16, name: Reading, type: uint, count: 3}]
  - name: Presets
    id: 0x01
    kind: telecommand
    length: 4
    fields: [{at: 0, bits: 16, name: Preset, type: uint, count: 2}]
"""


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    """The meter, with the registers of the published frames."""
    file = tmp_path_factory.mktemp("published") / "modbus.yaml"
    file.write_text(METER.read_text(encoding="utf-8") + REGISTERS, encoding="utf-8")
    return load([file]).icd


def test_published_requests_and_responses_are_read(published):
    (first,) = recognize(published, "01 03 00 00 00 0A C5 CD")
    assert (first.what, first.message.name) == ("request", "Measurements")
    requested, read, sent, accepted = recognize(published, " ".join((*READ, *WRITTEN)))
    assert (requested.what, requested.message.name) == ("request", "Readings")
    # `Limits` has the same length: the request tells which one it is.
    assert (read.what, read.message.name) == ("telemetry", "Readings")
    assert read.data == bytes.fromhex("AE 41 56 52 43 40")
    assert (sent.what, sent.message.name) == ("telecommand", "Presets")
    assert sent.data == bytes.fromhex("00 0A 01 02")
    assert (accepted.what, accepted.message.name) == ("acknowledge", "Presets")


def test_a_response_alone_is_read_as_the_message_that_the_user_names(published):
    with pytest.raises(Ambiguous, match=r"`Readings` .*, or `Limits`"):
        recognize(published, READ[1])
    (read,) = recognize(published, READ[1], "meter", "Readings")
    assert read.message.name == "Readings"
    (energy,) = recognize(published, "01 03 08 00 00 04 D2 00 00 11 5C 20 28")
    assert energy.message.name == "Energy"  # nothing else has this length
