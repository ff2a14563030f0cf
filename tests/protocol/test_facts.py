"""What the protocol layer is made from: the facts of the ICD, each assumption with its
reason.
"""

from __future__ import annotations

from dataclasses import asdict

import pytest
from icdgen_runtime.wire.uart import uart_kind

from icdgen.loading import load
from icdgen.protocol import facts
from tests import links


def test_a_node_has_the_facts_of_what_it_includes_and_its_own(icd, known):
    assert known.framing and known.can and known.files and known.checksum and known.mask
    bootloader = facts.of(icd, icd.node("bootloader"))
    assert bootloader.framing and asdict(bootloader.framing) == asdict(known.framing)
    assert bootloader.checksum is None and bootloader.mask is None


def test_a_node_without_a_protocol_has_none(icd):
    alone = facts.of(icd, icd.node("cubemag"))
    assert (alone.framing, alone.can, alone.files, alone.assumptions) == (
        None,
        None,
        None,
        (),
    )
    with pytest.raises(facts.Unsupported, match="uart"):
        facts.need(alone.framing, "uart")


WITHOUT_TELEMETRY = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
protocol:
  uart:
    framing: {escape: 0x10, start_of_message: 0x02, end_of_message: 0x03, escaped_data: 0x10}
    acknowledge:
      data: [{byte: 0, bytes: 1, name: Id, role: id, type: uint}, {byte: 1, bytes: 1, name: Error, role: error, type: uint}]
messages:
  - {name: Stop, id: 7, kind: telecommand, length: 0}
"""


def test_without_telemetry_an_acknowledge_is_no_reply(tmp_path):
    (tmp_path / "demo.yaml").write_text(WITHOUT_TELEMETRY)
    loaded = load([tmp_path])
    assert loaded.findings == []
    link = links.link(loaded.icd, "demo")
    assert uart_kind(link, bytes([7, 0])) == "acknowledge"


def test_buffers_are_as_long_as_the_longest_message_with_id_and_checksum(known):
    assert max(m.length for m in known.telemetry.values()) == 504
    assert known.longest_data == 504
    assert known.longest == 506


def test_every_assumption_says_what_is_held_and_why(known):
    held = {(a.section, a.key): a for a in known.assumptions}
    assert held["can.extended", "fill"].value == 0
    assert held["log_mask", "frame_order"].value == "rising bits"
    assert held["crc8", "covers_id"].value is False
    assert held["message Reset", "acknowledge"].value == "reset"
    assert all(a.why and a.value is not None for a in known.assumptions)


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


def test_uploads_belong_to_the_nodes_that_the_icd_names(icd, known):
    boot = facts.of(icd, icd.node("bootloader"))
    assert known.files.upload is None and not any(
        path.startswith("upload.") for path in known.files.steps
    )
    upload = boot.files.upload
    assert (
        upload.finalize.fields["offset"] == "Offset"
        and boot.files.steps["upload.finalize"] is upload.finalize
    )
    assert (upload.destinations, upload.destination_bytes) == (
        (3, 4, 5, 6, 7, 8, 9),
        524_288,
    )


def test_operations_on_programs_are_those_of_the_node(icd, known):
    boot = facts.of(icd, icd.node("bootloader"))
    assert (boot.program_information.timeout, boot.program_copy.programs) == (
        2000,
        (3, 4, 5, 6, 7, 8, 9),
    )
    assert (known.program_copy, known.program_information) == (None, None)


def test_procedures_have_their_numbers_and_times_are_milliseconds(icd, known):
    assert known.files.download.message_length == 20
    section = icd.protocol_of(icd.node("bootloader"))["file_transfer"]["upload"]
    assert (
        facts.of(icd, icd.node("bootloader")).files.upload.erase_timeout
        == section["erase_timeout_s"] * 1000
    )
    assert known.boot_ms == 5000
