"""The runtime is generated from the facts of the protocol in the ICD; each assumption
states its reason.
"""

from __future__ import annotations

from dataclasses import asdict

import pytest
from icdgen_runtime.wire.awaited import Request
from icdgen_runtime.wire.client import Client
from icdgen_runtime.wire.events import Done
from icdgen_runtime.wire.uart import uart_kind

from icdgen.loading import load
from icdgen.protocol import facts
from icdgen.protocol.procedures import Poll, Send, Value
from icdgen.protocol.reading import assumptions_of
from tests import links


def test_a_node_has_the_facts_of_what_it_includes_and_its_own(icd, acp_facts):
    assert acp_facts.framing and acp_facts.can and acp_facts.checksum and acp_facts.mask
    bootloader = facts.of(icd, icd.node("bootloader"))
    assert bootloader.framing and asdict(bootloader.framing) == asdict(
        acp_facts.framing
    )
    assert bootloader.checksum is None and bootloader.mask is None


def test_a_node_without_a_protocol_has_none(icd):
    alone = facts.of(icd, icd.node("cubemag"))
    assert (alone.framing, alone.can, alone.procedures, alone.assumptions) == (
        None,
        None,
        (),
        (),
    )
    with pytest.raises(facts.Unsupported, match="uart"):
        facts.need(alone.framing, "uart")


WITHOUT_TELEMETRY = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
protocol:
  link:
    buses:
      uart:
        framing: {by: escape, escape: 0x10, start: 0x02, end: 0x03, data: 0x10}
    packets:
      acknowledge: {from: device, header: [{bits: 8, role: id}, {bits: 8, role: status}]}
    commands:
      ack: {packet: acknowledge, echo: id, status: status, success: [0]}
messages:
  - {name: Stop, id: 7, kind: telecommand, length: 0}
"""


def test_without_telemetry_an_acknowledge_is_no_reply(tmp_path):
    (tmp_path / "demo.yaml").write_text(WITHOUT_TELEMETRY)
    loaded = load([tmp_path])
    assert loaded.findings == []
    link = links.link(loaded.icd, "demo")
    assert uart_kind(link, bytes([7, 0])) == "acknowledge"


CHECKED = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0}}
protocol:
  link:
    packets:
      telecommand:
        from: host
        buses: [{}]
        trailer: [{{bits: 8, role: checksum, checksum: all, covers: {{from: data, to: data}}, optional: {}}}]
      telemetry:
        from: device
        buses: [{}]
        trailer: [{{bits: 8, role: checksum, checksum: all, covers: {{from: data, to: data}}, optional: {}}}]
    checksums:
      all: {{kind: xor, width: 8}}
    buses:
      uart: {{line: {{baud_rate: 115200}}, framing: {{by: escape, escape: 0x1F, start: 0x7F, end: 0xFF, data: 0x1F}}}}
      i2c: {{write: {{address_7bit: 0x20}}}}
messages:
  - {{name: Stop, id: 7, kind: telecommand, length: 0}}
  - {{name: State, id: 130, kind: telemetry, length: 1, fields: [{{at: 0, bits: 8, name: Mode, type: uint}}]}}
"""


@pytest.mark.parametrize(
    ("telecommands", "telemetry", "expected"),
    [
        (("uart, i2c", "true"), ("uart", "false"), ("uart i2c", "uart", "", "uart")),
        (("i2c", "false"), ("uart", "true"), ("i2c", "uart", "i2c", "")),
        (("uart", "false"), ("i2c", "false"), ("uart", "i2c", "uart", "i2c")),
    ],
)
def test_a_checksum_is_on_the_buses_of_its_packet_and_optional_if_stated(
    telecommands, telemetry, expected, tmp_path
):
    (tmp_path / "demo.yaml").write_text(CHECKED.format(*telecommands, *telemetry))
    icd = load([tmp_path]).icd
    checksum = facts.of(icd, icd.node("demo")).checksum
    assert (
        checksum.telecommand_buses,
        checksum.telemetry_buses,
        checksum.telecommand_always,
        checksum.telemetry_always,
    ) == tuple(tuple(buses.split()) for buses in expected)


def test_buffers_are_as_long_as_the_longest_message_with_id_and_checksum(acp_facts):
    assert max(m.length for m in acp_facts.telemetry.values()) == 504
    assert acp_facts.longest_data == 504
    assert acp_facts.longest == 506


def test_every_assumption_has_a_value_and_a_reason(acp_facts):
    assumptions = {(a.section, a.key): a for a in acp_facts.assumptions}
    assert assumptions["link.buses.can.segments", "fill"].value == 0
    assert assumptions["log_mask", "frame_order"].value == "rising bits"
    (field,) = assumptions["link.packets.telecommand", "trailer"].value
    assert field["covers"] == {"from": "data", "to": "data"}
    assert assumptions["message Reset", "acknowledge"].value == "reset"
    assert all(a.why and a.value is not None for a in acp_facts.assumptions)


def test_a_telecommand_is_acknowledged_or_not_or_answered_by_a_reset(icd):
    messages = {m.name: m for m in icd.messages_of(icd.node("bootloader"))}
    assert (messages["Reset"].acknowledge, messages["Reset"].expects_reset) == (
        False,
        True,
    )
    assert messages["Run Selected Program"].expects_reset
    packet = messages["File Upload Packet"]
    assert (packet.acknowledge, packet.expects_reset) == (False, False)
    assert (
        messages["Erase File"].acknowledge and not messages["Erase File"].expects_reset
    )


def procedure(icd, node, name):
    """Return the procedure of a node; None if the node has no such procedure."""
    procedures = facts.of(icd, icd.node(node)).procedures
    return next((each for each in procedures if each.name == name), None)


def test_procedures_are_those_of_the_node_and_of_what_it_includes(icd):
    """Section 7.4: the bootloader takes uploads, and only it has programs to copy."""
    names = {
        node: {each.name for each in facts.of(icd, icd.node(node)).procedures}
        for node in ("common", "cubeacp", "bootloader", "cubemag")
    }
    assert names["cubeacp"] == {"list", "download", "erase", "format"}
    assert names["common"] == names["cubeacp"]
    assert names["bootloader"] == names["cubeacp"] | {
        "upload",
        "program_copy",
        "program_information",
    }
    assert names["cubemag"] == set()


def test_inputs_have_the_values_that_the_manual_supports(icd):
    destination, data = procedure(icd, "bootloader", "upload").inputs
    assert destination.values == (3, 4, 5, 6, 7, 8, 9)
    assert (data.is_bytes, data.most) == (True, 524_288)
    (program,) = procedure(icd, "bootloader", "program_copy").inputs
    assert (program.enum.name, program.values) == (
        "ProgramsList",
        (3, 4, 5, 6, 7, 8, 9),
    )


def test_times_are_milliseconds_and_constants_are_those_of_the_steps(icd, acp_facts):
    upload = procedure(icd, "bootloader", "upload")
    polls = [step for step in upload.steps if isinstance(step, Poll)]
    assert [(poll.interval, poll.timeout) for poll in polls] == [(50, 8000), (50, 5000)]
    download = procedure(icd, "cubeacp", "download")
    burst = next(
        step
        for step in download.steps
        if isinstance(step, Send) and step.message.name == "Initiate Download Burst"
    )
    assert burst.puts[0].value == Value(20, False)
    assert acp_facts.boot_ms == 5000


def test_a_response_on_each_bus_repeats_the_id_of_its_telecommand(acp_facts):
    """The positions are given in Table 40 and in the acknowledges of section 5."""
    data = {
        "uart": bytes([17, 0]),
        "i2c": bytes([17, 1, 0, 0]),  # of the telemetry that is polled
        "can": bytes([17]),
    }
    for bus, exchanges in acp_facts.bus_exchanges.items():
        assert exchanges.command
        for response in exchanges.command.responses:
            (echo,) = response.echoes
            assert data[bus][echo.place.at] == 17
    assert acp_facts.bus_exchanges.keys() == data.keys()


def test_a_wrong_checksum_is_the_only_refusal_after_which_a_telecommand_is_sent_again(
    acp_facts,
):
    for bus in ("uart", "i2c"):
        command = acp_facts.bus_exchanges[bus].command
        assert command
        (response,) = command.responses
        assert (response.verdict, dict(response.meanings)) == (
            "nak",
            {0: "ack", acp_facts.reasons["checksum"]: "again"},
        )


def test_only_i2c_polls_for_the_response(acp_facts):
    polls = {bus: each.command.poll for bus, each in acp_facts.bus_exchanges.items()}
    assert (polls["uart"], polls["can"]) == (None, None)
    assert polls["i2c"].telemetry == acp_facts.polled.telemetry_id


@pytest.mark.parametrize(
    ("step", "name"),
    [
        ({"as": "state", "poll": "File Information"}, "File Information"),
        ({"ignore": ["timeout"], "send": "Reset"}, "Reset"),
        ({"unless": "flag", "receive": "Buffer", "silence_ms": 5}, "Buffer"),
        ({"map": "send", "messages": ["Map 1"], "field": "Map"}, "map"),
        ({"bits": 8, "role": "source", "name": "Sender"}, "Sender"),
    ],
)
def test_an_assumption_is_named_after_the_message_of_its_step(step, name):
    section = {"steps": [{**step, "assumptions": {"bits": "Not stated."}}]}
    (assumption,) = assumptions_of(section, ("procedures", "list"))
    assert assumption.section == f"procedures.list.{name}"


WITHOUT_DETAIL = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
protocol:
  link:
    commands: {reasons: {length: Length}}
    buses:
      i2c:
        write: {address_7bit: 0x20}
        commands:
          ack: {message: Outcome, echo: Last, until: Done, status: Code, success: [Fine, Slow]}
enums:
  - {name: Codes, members: [{value: 0, name: Fine}, {value: 1, name: Slow}, {value: 2, name: Length}]}
messages:
  - {name: Stop, id: 7, kind: telecommand, length: 0}
  - name: Outcome
    id: 130
    kind: telemetry
    length: 3
    fields:
      - {at: 0,  bits: 8, name: Last, type: uint}
      - {at: 8,  bits: 1, name: Done, type: bool}
      - {at: 16, bits: 8, name: Code, type: enum, enum: Codes}
"""


def test_several_values_of_a_status_can_confirm_and_a_refusal_needs_no_detail(tmp_path):
    (tmp_path / "demo.yaml").write_text(WITHOUT_DETAIL)
    loaded = load([tmp_path])
    assert loaded.findings == []
    demo_facts = facts.of(loaded.icd, loaded.icd.node("demo"))
    assert demo_facts.reasons == {"length": 2}
    (response,) = demo_facts.bus_exchanges["i2c"].command.responses
    assert response.meanings == ((0, "ack"), (1, "ack"))
    assert response.reasons == ((0, "Fine"), (1, "Slow"), (2, "Length"))
    assert response.detail is None
    client = Client(links.link(loaded.icd, "demo"), "i2c")
    client.start(0, Request("telecommand", 7))
    assert client.transfers()
    assert client.transferred(1, b"") == []
    assert client.tick(1 + demo_facts.client.poll_interval) == [] and client.transfers()
    outcome = b"\x07\x01\x01"
    (done,) = client.transferred(30, outcome)
    assert isinstance(done, Done) and (done.id, done.data) == (7, outcome)
