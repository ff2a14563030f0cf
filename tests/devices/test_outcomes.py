"""Commands end with the outcome that a public protocol defines for the response.

The device is the protocol's own library, or a recording of frames of a device.
"""

from __future__ import annotations

from importlib import import_module

import pytest

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of
from tests.conftest import ROOT

_client = import_module("icdgen_runtime.wire.client")
events = import_module("icdgen_runtime.wire.events")
Request = _client.Request


def client_of(path, **settings):
    icd = load([path]).icd
    (node,) = icd.nodes
    link = link_of(icd, facts.of(icd, node))
    client = _client.Client(link, settings=link.settings._replace(**settings))
    return client, {message.name: message for message in node.messages}


@pytest.fixture
def ubx():
    return pytest.importorskip("pyubx2")


def test_ubx_acknowledges_count_for_the_message_that_they_name(ubx):
    client, messages = client_of(ROOT / "examples" / "devices" / "ublox" / "ublox.yaml")
    id = messages["CFG-MSG"].telecommand_id
    data = bytes([0x01, 0x22, 1, 0, 0, 0, 0, 0])[: messages["CFG-MSG"].length]
    client.start(0, Request("telecommand", id, data))
    sent = ubx.UBXReader.parse(client.output(), msgmode=ubx.SET)
    assert (sent.identity, sent.msgClass, sent.msgID) == ("CFG-MSG", 0x01, 0x22)

    def answered(name, number):
        kind = "ACK-ACK" if name == "ACK" else "ACK-NAK"
        line = ubx.UBXMessage("ACK", kind, ubx.GET, clsID=6, msgID=number).serialize()
        (event,) = client.received(10, line)
        return event

    assert isinstance(answered("ACK", 0x08), events.Stray)  # of CFG-RATE
    assert isinstance(answered("NAK", 0x08), events.Stray)
    done = answered("ACK", 0x01)
    assert isinstance(done, events.Done) and done.id == id
    client.start(20, Request("telecommand", id, data))
    assert client.output()
    refused = answered("NAK", 0x01)
    assert isinstance(refused, events.Refused) and refused.code is None
    assert not client.busy


COMMANDS = """
icdgen: 1
node: {name: autopilot, title: Autopilot, byte_order: little, bit_order: lsb0, id_bits: 24}
protocol:
  link:
    framing: {by: length}
    header:
      - {at: 0, bits: 8, role: sync, value: 0xFD}
      - {at: 8, bits: 8, role: length}
      - {at: 16, bits: 8, role: constant, value: 0}
      - {at: 24, bits: 8, role: flags}
      - {at: 32, bits: 8, role: sequence}
      - {at: 40, bits: 8, role: source, value: {telecommand: 255, telemetry: 1}}
      - {at: 48, bits: 8, role: type, value: {telecommand: 190, telemetry: 1}}
      - {at: 56, bits: 24, role: id}
    trailer: [{at: 0, bits: 16, role: checksum, checksum: x25, covers: {from: length, to: data}}]
    commands:
      ack:
        message: Command Ack
        echo: {Command: Command}
        status: Result
        success: [Accepted]
        busy: [Temporarily Rejected]
        progress: [In Progress]
    checksums:
      x25:
        kind: crc
        width: 16
        polynomial: 0x1021
        init: 0xFFFF
        reflect_in: true
        reflect_out: true
        xor_out: 0
        seeds: {Command Long: 152, Command Ack: 143}
    client: {reply_timeout_ms: 1500, retries: 2, in_flight: 2, progress_for_ms: 60000}
enums:
  - name: Result
    identifier: mav_result
    members:
      - {value: 0, name: Accepted}
      - {value: 1, name: Temporarily Rejected}
      - {value: 2, name: Denied}
      - {value: 3, name: Unsupported}
      - {value: 4, name: Failed}
      - {value: 5, name: In Progress}
messages:
  - name: Command Long
    id: 76
    kind: telecommand
    length: 33
    may_end_early: zeros
    fields:
      - {at: 0, bits: 32, name: Parameter 1, type: float}
      - {at: 32, bits: 192, name: Parameters, type: bytes}
      - {at: 224, bits: 16, name: Command, type: uint}
      - {at: 240, bits: 8, name: Target System, type: uint}
      - {at: 248, bits: 8, name: Target Component, type: uint}
      - {at: 256, bits: 8, name: Confirmation, type: uint}
  - name: Command Ack
    id: 77
    kind: telemetry
    length: 10
    may_end_early: zeros
    fields:
      - {at: 0, bits: 16, name: Command, type: uint}
      - {at: 16, bits: 8, name: Result, type: enum, enum: Result}
      - {at: 24, bits: 8, name: Progress, type: uint}
      - {at: 32, bits: 32, name: Detail, type: int}
      - {at: 64, bits: 8, name: Target System, type: uint}
      - {at: 72, bits: 8, name: Target Component, type: uint}
"""
ARM, CALIBRATE = 400, 241


def test_mavlink_results_are_outcomes_of_the_command_that_they_name(tmp_path):
    mavlink = pytest.importorskip("pymavlink.dialects.v20.common")
    (tmp_path / "autopilot.yaml").write_text(COMMANDS, encoding="utf-8")
    client, _ = client_of(tmp_path / "autopilot.yaml")
    vehicle = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)

    def send(now, command):
        data = bytes(28) + command.to_bytes(2, "little") + bytes([1, 1, 0])
        client.start(now, Request("telecommand", 76, data))

    def received():
        (message,) = vehicle.parse_buffer(client.output())
        assert message.get_type() == "COMMAND_LONG"
        return message.command

    def answer(now, command, result):
        ack = mavlink.MAVLink_command_ack_message(command, result)
        (event,) = client.received(now, ack.pack(vehicle))
        vehicle.seq = vehicle.seq + 1 & 0xFF
        return event

    send(0, ARM)
    send(1, CALIBRATE)
    assert [received(), received()] == [ARM, CALIBRATE]
    assert isinstance(answer(10, 22, mavlink.MAV_RESULT_ACCEPTED), events.Stray)
    for now in range(1000, 30000, 1000):
        waiting = answer(now, CALIBRATE, mavlink.MAV_RESULT_IN_PROGRESS)
        assert isinstance(waiting, events.Progress)
        if now == 1000:  # Arm has the time-out of a command without progress.
            refused = answer(now, ARM, mavlink.MAV_RESULT_DENIED)
            assert (type(refused), refused.reason) == (events.Refused, "Denied")
    done = answer(30000, CALIBRATE, mavlink.MAV_RESULT_ACCEPTED)
    assert isinstance(done, events.Done) and not client.busy
    send(31000, ARM)
    assert received() == ARM
    rejected = mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert isinstance(answer(31010, ARM, rejected), events.Progress)
    assert client.tick(client.deadline) == [] and received() == ARM
    assert isinstance(answer(31200, ARM, mavlink.MAV_RESULT_ACCEPTED), events.Done)


# Frames that batteries sent, from public logs: of 0x90 and 0x94.
CHARGE = bytes.fromhex("a5 01 90 08 02 03 00 00 77 24 03 38 19")
STATUS = bytes.fromhex("a5 01 94 08 10 01 00 00 02 00 05 c0 1a")


def test_daly_batteries_are_requested_with_reserved_bytes_and_respond():
    client, _ = client_of(ROOT / "examples" / "links" / "daly.yaml")
    client.start(0, Request("telemetry", 0x90))
    assert client.output() == bytes.fromhex("a5 40 90 08 00 00 00 00 00 00 00 00 7d")
    (unasked,) = client.received(10, STATUS)
    assert isinstance(unasked, events.Arrived)
    (done,) = client.received(20, CHARGE)
    assert isinstance(done, events.Done) and done.data == CHARGE[4:12]
    client.start(30, Request("telecommand", 0xD9, bytes([1, *bytes(7)])))
    assert client.output()
    switched = bytes([0xA5, 0x01, 0xD9, 8, 0, *bytes(7)])
    (stray,) = client.received(40, switched + bytes([sum(switched) % 256]))
    assert isinstance(stray, events.Stray)  # of the other state
