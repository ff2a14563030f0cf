"""ICDs that look unusual but are correct: no rule may report them."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.icd.loaded import Loaded
from icdgen.loading import load
from icdgen.protocol import facts

FINE = sorted(Path(__file__).with_name("fine").glob("*.yaml"))


@pytest.mark.parametrize("path", FINE, ids=lambda path: path.stem)
def test_an_unusual_correct_icd_has_no_finding(path):
    assert load([path]).findings == []


SHARED = """\
icdgen: 1
node: {name: shared, title: Shared, byte_order: big, bit_order: msb0}
protocol:
  link:
    client: {reply_timeout_ms: 100, late_ms: 50}
messages:
  - {name: Ping, id: 1, kind: telecommand, length: 0, repeat: true}
  - {name: Reset, id: 2, kind: telecommand, length: 0, response: none}
"""
DEVICE = """\
icdgen: 1
include: [shared.yaml]
node: {name: device, title: Device, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: slip}
    header: [{at: 0, bits: 8, role: id}]
    commands: {ack: {message: Ack, echo: Command}}
messages:
  - {name: Ack, id: 6, kind: telemetry, length: 1, fields: [{at: 0, bits: 8, name: Command, type: uint}]}
"""


def test_commands_of_a_framed_link_can_be_in_a_file_that_its_device_includes(tmp_path):
    (tmp_path / "shared.yaml").write_text(SHARED)
    (tmp_path / "device.yaml").write_text(DEVICE)
    assert load([tmp_path]).findings == []


def test_a_file_for_other_files_to_include_can_be_checked_alone(tmp_path):
    shared = tmp_path / "shared.yaml"
    shared.write_text(SHARED)
    assert load([shared]).findings == []


BASE = """\
icdgen: 1
node: {name: base, title: Base, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: length}
    header: [{bits: 8, role: length}, {bits: 8, role: id}]
    trailer: [{bits: 8, role: checksum, checksum: parity, covers: {from: id, to: data}}]
    checksums: {parity: {kind: xor, width: 8}}
    client: {retries: 1}
messages:
  - {name: Ping, id: 1, kind: telecommand, length: 0}
"""
OWN = """\
icdgen: 1
include: [base.yaml]
node: {name: device, title: Device, byte_order: big, bit_order: msb0}
protocol:
  link:
"""
ROM = "    checksums: {rom: {kind: sum, width: 16}}\n"
SLIP = "    framing: {by: slip}\n    header: [{bits: 8, role: id}]\n"


def device(folder: Path, link: str) -> Loaded:
    (folder / "base.yaml").write_text(BASE)
    (folder / "device.yaml").write_text(OWN + link)
    return load([folder])


def test_a_device_adds_a_checksum_to_those_of_the_link_that_it_includes(tmp_path):
    loaded = device(tmp_path, ROM)
    (finding,) = loaded.findings
    assert "no field of a packet has the checksum `rom`" in finding.message
    (packet,) = facts.of(loaded.icd, loaded.icd.node("device")).stream.packets
    assert packet.check.algorithm.kind == "xor"


def test_another_framing_replaces_the_link_completely(tmp_path):
    loaded = device(tmp_path, SLIP)
    assert loaded.findings == []
    link_facts = facts.of(loaded.icd, loaded.icd.node("device"))
    (packet,) = link_facts.stream.packets
    assert packet.header_bytes == 1 and packet.trailer_bytes == 0
    assert link_facts.client.retries == 1


def test_responses_alone_do_not_change_the_link_of_an_included_file(tmp_path):
    (finding,) = device(tmp_path, "    commands: {ack: none}\n").findings
    assert "`commands` belongs to a framed link" in finding.message
