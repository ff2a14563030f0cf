"""ICDs that look strange and are right: no rule may object."""

from __future__ import annotations

from pathlib import Path

import pytest

from icdgen.loading import load

FINE = sorted(Path(__file__).with_name("fine").glob("*.yaml"))


@pytest.mark.parametrize("path", FINE, ids=lambda path: path.stem)
def test_nothing_is_found(path):
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
