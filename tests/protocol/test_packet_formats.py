"""Sizes of packets, from which generated code has its buffers."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.stream import stream_encode

from icdgen.protocol import facts
from tests.features.outputs import icd_of
from tests.links import link

LINK = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0}}
protocol:
  link:
    framing: {framing}
    header: [{{at: 0, bits: 8, role: id}}]
messages:
  - name: Block
    id: 0x7D
    kind: telemetry
    length: {length}
    fields: [{{at: 0, bits: 8, name: Numbers, type: uint, count: {length}}}]
"""
ESCAPE = "{by: escape, escape: 0x7D, start: 0, end: 0xFF, data: 0x2F}"


@pytest.mark.parametrize(
    ("framing", "length", "line"),
    [
        ("{by: slip}", 20, 42 + 2 - 1),  # a first byte 7D is not escaped
        ("{by: hdlc}", 20, 42 + 2),
        (ESCAPE, 20, 42 + 4),
        ("{by: cobs}", 1, 2 + 2),
        ("{by: cobs}", 252, 253 + 2),
        ("{by: cobs}", 254, 255 + 3),
        ("{by: cobs}", 506, 507 + 3),
        ("{by: cobs}", 508, 509 + 4),
    ],
)
def test_the_longest_line_has_space_for_a_message_of_the_worst_bytes(
    framing, length, line, tmp_path
):
    icd = icd_of(LINK.format(framing=framing, length=length), tmp_path)
    stream = facts.of(icd, icd.node("demo")).stream
    assert stream.longest == length + 1
    lines = [
        len(stream_encode(link(icd, "demo"), 0x7D, bytes([byte] * length), "telemetry"))
        for byte in range(256)
    ]
    assert max(lines) == line
    assert line <= stream.longest_line <= line + 1
