"""The simulated device follows the ICD, over a real port and with the client of the
runtime.
"""

from __future__ import annotations

import asyncio
import json
import signal
import socket
import time

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.events import OUTCOMES, Done, Log, Refused, Sent
from icdgen_runtime.wire.uart import UartDecoder, uart_encode

from icdgen import codec
from icdgen.icd.model import CONFIGURATION
from icdgen.procedures.run import steps_of
from icdgen.protocol import facts
from icdgen.protocol.procedures import Send
from icdgen.runtime_objects.links import responses_on
from icdgen.sim.run import Options, build_device
from icdgen.sim.serve import Server
from icdgen.sim.values import allowed_values
from tests.conftest import DEMO
from tests.sim.device import ICD, connected, session, simulator

WAYS = [("--tcp", "0"), ("--udp", "0"), ("--pty",)]


def value_of(client, name: str, field: str) -> int:
    message = next(m for m in client.node_facts.telemetry.values() if m.name == name)
    return codec.decode(client.node, message, client.telemetry(message))[field]


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way[0])
@pytest.mark.parametrize("node", ["cubeacp", "bootloader"])
def test_the_device_identifies_itself_and_answers_every_request(node, way):
    with session(*way, node=node) as client:
        identity = client.identify()
        assert identity.matches and identity.node_type == ICD.node(node).node_type
        for message in client.node_facts.telemetry.values():
            frame = client.telemetry(message)
            assert frame is not None and len(frame) == message.length, message.name


@pytest.mark.parametrize("node", ["cubeacp", "bootloader"])
def test_every_telecommand_is_accepted_and_every_configuration_reads_back(
    node,
):
    with session(node=node) as client:
        client.identify()  # so that a boot program stays
        for message in client.node_facts.telecommands.values():
            if message.expects_reset:
                continue
            raw = allowed_values(ICD, message)
            if message.kind == CONFIGURATION:
                data = bytearray(byte % 251 + 1 for byte in range(message.length))
                raw = codec.decode(ICD.node(message.node), message, bytes(data))
                raw |= {f.name: f.const for f in message.fields if f.const is not None}
            data = codec.encode(ICD.node(message.node), message, raw)
            outcome = client.telecommand(message, data)
            is_refusable = message.name in refusable(client)
            expected = Done if message.acknowledge else Sent
            allowed = (expected, Refused) if is_refusable else expected
            assert isinstance(outcome, allowed), (message.name, outcome)
            if message.kind == CONFIGURATION:
                assert client.telemetry(message) == data, message.name


def refusable(client) -> set[str]:
    """Return the telecommands that may be refused: by the state of the device, for a
    destination, or by the node.
    """
    boot = facts.of(ICD, ICD.node("bootloader"))
    burst = client.node_facts.telecommands[next(iter(client.node_facts.unsolicited))]
    return {
        burst.name,
        *(
            step.message.name
            for procedure in boot.procedures
            if procedure.name in ("upload", "program_copy")
            for step in steps_of(procedure, Send)
        ),
    }


def test_the_checksum_of_a_telecommand_is_checked_where_there_is_one():
    with session(crc=True) as client:
        done = client.telecommand(client.node_facts.telecommands[17], bytes(6))
        assert isinstance(done, Done)
        wrong = bytes([17]) + bytes(6) + b"\x01"
        assert raw_exchange(client, wrong) == client.node_facts.reasons["checksum"]


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (b"\x63", "unknown_id"),
        (b"\x11" + bytes(3), "length"),
        (b"\x21\x59", "value"),
    ],
)
def test_invalid_messages_are_refused_with_the_reason(message, reason):
    with session() as client:
        assert raw_exchange(client, message) == client.node_facts.reasons[reason]
        polled = client.node_facts.polled
        frame = codec.decode(client.node, polled, client.telemetry(polled))
        assert frame["Last TC ID"] == message[0]
        assert frame["TC error status"] == client.node_facts.reasons[reason]
        assert frame["Processed flag"] == 1


def raw_exchange(client, message: bytes) -> int:
    """Send bytes that the client would not send, and return the code of the
    acknowledge.
    """
    client.port.write(uart_encode(client.link, message))
    decoder = UartDecoder(client.link)
    end = time.monotonic() + 5
    while time.monotonic() < end:
        for event in decoder.feed(client.port.read(0.5)):
            (response,) = responses_on(client.link, "uart")
            return response.status.of(event.message)
    raise AssertionError("no acknowledge")


def test_the_communication_status_counts_messages_and_errors():
    with session() as client:
        step = client.node_facts.statistics
        names = step.fields
        assert value_of(client, step.message.name, names["requests"]) == 1
        client.telecommand(client.node_facts.telecommands[17], bytes(6))
        assert value_of(client, step.message.name, names["telecommands"]) == 1
        form = client.node_facts.framing
        assert value_of(client, step.message.name, names["uart_protocol"]) == 0
        client.port.write(bytes([form.escape, form.start, 1, form.escape, 0x33]))
        assert value_of(client, step.message.name, names["uart_protocol"]) == 1
        client.port.write(bytes([form.escape, form.start, 1]))
        assert value_of(client, step.message.name, names["uart_incomplete"]) == 1
        assert value_of(client, step.message.name, names["overrun"]) == 0
        client.port.write(bytes([form.escape, form.start]) + bytes(1000))
        assert value_of(client, step.message.name, names["overrun"]) == 1


def test_a_telecommand_before_the_one_before_is_processed_overruns_the_buffer():
    with session("--processing", "100") as client:
        telecommand = uart_encode(client.link, bytes([17]) + bytes(6))
        client.port.write(telecommand * 3)
        time.sleep(0.3)
        step = client.node_facts.statistics
        assert value_of(client, step.message.name, step.fields["overrun"]) == 1
        assert value_of(client, step.message.name, step.fields["telecommands"]) == 1


def test_the_boot_program_starts_the_application_unless_it_is_identified():
    with session("--boot", "2000", node="bootloader") as client:
        assert client.identify().matches
        time.sleep(2.3)
        assert client.identify().matches
    with session("--boot", "300", node="bootloader") as client:
        time.sleep(1.0)
        assert client.identify().node_type == ICD.node("cubeacp").node_type


def test_a_reset_starts_the_boot_program_and_its_telecommand_the_application():
    with session("--boot", "60000") as client:
        reset = next(
            m for m in client.node_facts.telecommands.values() if m.expects_reset
        )
        client.telecommand(client.node_facts.telecommands[17], bytes(6))
        data = codec.encode(ICD.node(reset.node), reset, allowed_values(ICD, reset))
        assert isinstance(client.telecommand(reset, data), Sent)
        assert client.identify().node_type == ICD.node("bootloader").node_type
        start = ICD.protocol_of(ICD.node("bootloader"))["program_start"]["message"]
        id = next(
            m.id for m in ICD.messages_of(ICD.node("bootloader")) if m.name == start
        )
        client.port.write(uart_encode(client.link, bytes([id])))
        assert client.identify().node_type == ICD.node("cubeacp").node_type


def test_values_are_set_by_options_orders_and_scripts(tmp_path):
    script = tmp_path / "script.yaml"
    script.write_text(
        "- set: {Estimated Attitude Angles: {pitch: 2.5, yaw: {wave: steps, min: -1, max: 1, period: 1000000}}}\n"
        "- {at: 0.2, set: {Estimated Attitude Angles: {pitch: 3.5}}}\n"
    )
    options = (
        "--set",
        "Estimated Attitude Angles",
        "roll=12.34",
        "--script",
        str(script),
        "--orders",
    )
    with (
        simulator("--node", "cubeacp", "--tcp", "0", *options) as (place, process),
        connected("cubeacp", place) as client,
    ):
        name = "Estimated Attitude Angles"
        assert value_of(client, name, "Estimated Roll Angle") == 1234
        assert value_of(client, name, "Estimated Yaw Angle") == -100
        time.sleep(0.3)
        assert value_of(client, name, "Estimated Pitch Angle") == 350
        process.stdin.write(
            "set 'Estimated Attitude Angles' roll=-1.5\nset nonsense x=1\n"
        )
        process.stdin.flush()
        assert process.stdout.readline() == "ok\n"
        assert process.stdout.readline().startswith(
            "error: cubeacp has no telemetry `nonsense`"
        )
        assert value_of(client, name, "Estimated Roll Angle") == -150


def test_an_interrupt_while_a_client_is_connected_ends_the_simulator_silently():
    with simulator("--node", "cubeacp", "--tcp", "0") as (place, process):
        host, port = place.removeprefix("tcp://").rsplit(":", 1)
        with socket.create_connection((host, int(port))) as client:
            client.sendall(b"\x00")
            time.sleep(0.3)
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=20)
    assert (process.returncode, err.strip()) == (130, "icdgen: error: interrupted")


@pytest.mark.parametrize("turns", range(4))
def test_an_interrupt_during_reception_ends_the_simulator(turns):
    async def ends() -> bool:
        running = asyncio.create_task(
            (server := Server(*build_device(ICD, "cubeacp", Options()))).run()
        )
        await asyncio.sleep(0.01)
        server.wake.set()
        for _ in range(turns):
            await asyncio.sleep(0)
        running.cancel()
        done, _ = await asyncio.wait([running], timeout=2)
        return running in done

    assert asyncio.run(ends())


def test_unsolicited_logs_follow_the_configuration():
    events = []
    with session(on_event=events.append) as client:
        role = ICD.protocol_of(client.node)["unsolicited_log"]["configured_by"]
        message = next(
            m
            for m in client.node_facts.telecommands.values()
            if m.name == role["message"]
        )
        bit = min(client.node_facts.mask.bits)
        raw = allowed_values(ICD, message) | {
            role["fields"]["mask"]: bytes([1 << bit]) + bytes(9),
            role["fields"]["period"]: 1,
        }
        client.telecommand(message, codec.encode(client.node, message, raw))
        for _ in client.messages(seconds=3.5):
            raise AssertionError("there is no other message")
        assert {type(event) for event in events} == {Log} and len(events) >= 2
        assert events[0].data[0] == client.link.log_message.id


@pytest.mark.parametrize("seed", [1, 2])
def test_the_same_seed_brings_the_same_faults(seed):
    def outcomes() -> list[bytes]:
        from random import Random

        from icdgen.sim.faults import Faults, parse

        kinds = [
            "drop=20%",
            "corrupt=20%",
            "cut=20%",
            "repeat=20%",
            "noise=20%",
            "duplicate=20%",
            "late=20%",
        ]
        faults = Faults(Random(seed), [parse(kind) for kind in kinds])
        return [faults.apply("reply", bytes(range(20))) for _ in range(200)]

    first = outcomes()
    assert first == outcomes()
    assert any(not pieces for pieces in first) and any(
        len(pieces) == 2 for pieces in first
    )


FAULTS = [
    "drop=30%",
    "corrupt=30%@acknowledge",
    "late=40%@acknowledge",
    "duplicate=50%",
    "cut=20%",
    "noise=50%",
    "repeat=20%",
]


@pytest.mark.parametrize("fault", FAULTS)
def test_every_request_ends_with_any_fault_on_the_line(fault):
    with session("--fault", fault, "--late", "300", "--seed", "3") as client:
        begin = time.monotonic()
        for number in range(12):
            outcome = client.telecommand(
                client.node_facts.telecommands[17], bytes([number] * 6), repeat=True
            )
            assert isinstance(outcome, OUTCOMES)
            client.identify()
        assert time.monotonic() - begin < 24 * 5 * 0.3 + 5


def test_a_refused_telecommand_is_not_executed():
    with session("--fault", "nack=1") as client:
        message = next(
            m
            for m in client.node_facts.telecommands.values()
            if m.kind == CONFIGURATION
        )
        before = client.telemetry(message)
        outcome = client.telecommand(message, bytes([1] * message.length))
        assert isinstance(outcome, Refused) and outcome.reason == "Incorrect Parameter"
        assert client.telemetry(message) == before


def test_strict_refuses_unknown_enum_values():
    def outcome(*options):
        with session(*options) as client:
            message = client.node_facts.telecommands[10]
            return type(client.start(Request("telecommand", message.id, b"\xee")))

    assert (outcome(), outcome("--strict")) == (Done, Refused)


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ((), "it is not said which node is meant"),
        (
            ("--tcp", "0", "--node", "cubeacp", "--set", "146", "roll=1", "pitch"),
            "`pitch` is not of the form",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--set", "146", "roll=1", "salt=1"),
            "has no field `salt`",
        ),
        (("--tcp", "0", "--node", "cubeacp", "roll=1"), "unexpected extra argument"),
        (
            ("--tcp", "0", "--node", "cubemag"),
            "does not say how messages of cubemag are framed",
        ),
        (("--tcp", "0"), "it is not said which node is meant"),
        (
            ("--tcp", "0", "--icd", "demo.yaml"),
            "no node of the ICD says how its messages are framed",
        ),
        (("--tcp", "0", "--node", "cubeacp", "--fault", "rain=1"), "is no fault"),
        (
            ("--tcp", "0", "--node", "cubeacp", "--fault", "drop=2"),
            "not between 0 and 1",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--fault", "drop=1@tea"),
            "cannot be on `tea`",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--file", "2:1"),
            "is no file of the device",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--file", "foo"),
            "`foo` is no file of the device",
        ),
        (("--tcp", "0", "--node", "cubeacp", "--uploads", __file__), "is not a folder"),
        (
            ("--tcp", "0", "--node", "cubeacp", "--host", "192.0.2.1"),
            "--host is an address of this machine",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--host", "a..b"),
            "the host name is invalid",
        ),
        (
            ("--udp", "0", "--node", "cubeacp", "--host", "x" * 64),
            "the host name is invalid",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--file", "2:1=missing.bin"),
            "cannot read missing.bin",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--script", "missing.yaml"),
            "cannot read missing.yaml",
        ),
        (
            ("--tcp", "0", "--node", "cubeacp", "--set", "Nothing", "x=1"),
            "no telemetry `Nothing`",
        ),
    ],
)
def test_misuse_is_reported(options, text, tmp_path):
    import subprocess
    import sys

    (tmp_path / "demo.yaml").write_text(DEMO)
    command = [sys.executable, "-m", "icdgen", "sim", *options]
    result = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert (
        result.returncode == 2
        and text in result.stderr
        and "Traceback" not in result.stderr
    )


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("{", "script.yaml:1:2: this is no YAML"),
        ("a: 1", "this is no list"),
        ("- {at: x}", "step 1: `at` is no time in seconds"),
        ("- {at: -1}", "step 1: `at` is no time in seconds"),
        ("- {at: true}", "step 1: `at` is no time in seconds"),
        ("- {}\n- {set: {Identification: 1}}", "step 2: `set` is no mapping"),
        ("- {what: 1}", "step 1: there is no such step"),
        ("- {set: {Identification: {major: {wave: tsunami}}}}", "there is no such wave"),
        ("- {set: {Identification: {major: {min: x}}}}", "are numbers, the last above 0"),
        ("- {set: {Identification: {major: {period: 0}}}}", "are numbers, the last above 0"),
        ("- {faults: drop}", "step 1: `faults` is no list of texts"),
        ("- {faults: [drop=9]}", "the share is not between 0 and 1"),
        ("- {set: {Identification: {major: x}}}", "`x`"),
        ("- {set: {Identification: {major: 300}}}", "300 does not fit"),
    ],
)  # fmt: skip
def test_a_wrong_script_is_refused_before_anything_runs(script, words, tmp_path):
    from icdgen.errors import UserError
    from icdgen.sim import run

    path = tmp_path / "script.yaml"
    path.write_text(script)
    with pytest.raises(UserError, match=words):
        run.build_device(ICD, "cubeacp", run.Options(script=path))


def test_monitor_and_send_talk_to_the_device():
    import subprocess
    import sys

    def icdgen(*words: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            [sys.executable, "-m", "icdgen", *words],
            capture_output=True,
            text=True,
            timeout=60,
        )

    with simulator("--node", "cubeacp", "--tcp", "0", "--set", "146", "roll=1.25") as (
        place,
        _,
    ):
        shown = icdgen(
            "monitor",
            "cubeacp",
            "146",
            "--port",
            place,
            "--count",
            "2",
            "--every",
            "0.05",
            "--format",
            "json",
        )
        rounds = [json.loads(line) for line in shown.stdout.splitlines()]
        assert [frame["fields"][0]["value"] for frame in rounds] == [1.25, 1.25]
        table = icdgen("monitor", "cubeacp", "146", "--port", place, "--once").stdout
        assert "Estimated Roll Angle" in table and "1.25  deg" in table
        sent = icdgen(
            "send", "cubeacp", "Set Wheel Speed", "x=1", "y=2", "z=3", "--port", place
        )
        assert (sent.returncode, sent.stdout) == (0, "Set Wheel Speed: acknowledged\n")
        refused = icdgen(
            "send",
            "cubeacp",
            "Format SD card",
            "magic=1",
            "--raw",
            "--yes",
            "--port",
            place,
        )
        assert (
            refused.returncode == 1
            and "refused: Incorrect Parameter (code 3)" in refused.stderr
        )
        other = icdgen("monitor", "bootloader", "--port", place, "--once")
        assert "the device says node type 10" in other.stderr
    silent = icdgen(
        "send", "cubeacp", "Set Wheel Speed", "x=1", "y=2", "z=3", "--port", place
    )
    assert silent.returncode == 2 and "cannot connect" in silent.stderr


@pytest.mark.parametrize(
    ("fault", "event", "code"),
    [
        ("nak=1:Incorrect Length", "Refused", 2),
        ("nak=1:2", "Refused", 2),
        ("nack=1", "Refused", 3),
        ("silence=1", "Timeout", None),
        ("foreign=1", "Timeout", None),
    ],
)
def test_the_response_to_a_telecommand_can_be_made_wrong(fault, event, code):
    from icdgen.sim import run

    line, _ = run.build_device(ICD, "cubeacp", run.Options(faults=[fault]))
    client = Client(line.computer.program.link, "uart")
    client.start(0, Request("telecommand", 12, bytes(1)))
    line.received(0, client.output())
    data = b"".join(line.pieces(0))
    events = client.received(0, data) if data else []
    events += client.tick(10_000)
    assert type(events[-1]).__name__ == event
    assert getattr(events[-1], "code", None) == code


@pytest.mark.parametrize("fault", ["nak=1:Overheated", "nak=1:0", "busy=1"])
def test_a_response_that_the_link_does_not_have_is_no_fault(fault):
    from icdgen.errors import UserError
    from icdgen.sim import run

    with pytest.raises(UserError):
        run.build_device(ICD, "cubeacp", run.Options(faults=[fault]))
