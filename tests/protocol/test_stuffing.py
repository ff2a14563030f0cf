"""Delimited frames come back from received bytes, at the limits of their blocks."""

from __future__ import annotations

import pytest
from icdgen_runtime.wire.stream import StreamDecoder, stream_encode

from icdgen.protocol import facts
from icdgen.runtime_objects.links import link_of_node
from tests.features.outputs import icd_of

LINK = """\
icdgen: 1
node: {{name: demo, title: Demo, byte_order: little, bit_order: lsb0}}
protocol:
  link:
    framing: {{by: {framing}}}
    header: [{{at: 0, bits: 8, role: id}}]
messages:
  - name: Block
    id: 0x7D
    kind: telemetry
    length: 600
    fields: [{{at: 0, bits: 4800, name: Octets, type: bytes}}]
"""


@pytest.mark.parametrize("framing", ["cobs", "slip", "hdlc"])
def test_zeros_at_any_distance_are_received(framing, tmp_path):
    """A block of COBS has at most 254 bytes without a zero."""
    icd = icd_of(LINK.format(framing=framing), tmp_path)
    link = link_of_node(icd, icd.nodes[0])
    assert facts.of(icd, icd.nodes[0]).stream is not None
    for distance in [0, 1, *range(251, 258), *range(505, 512), 600]:
        data = (b"\x2f" * distance + b"\0" + b"\x30" * 600)[:600]
        events = StreamDecoder(link, "telemetry").feed(
            stream_encode(link, 0x7D, data, "telemetry")
        )
        assert [event.data for event in events] == [data], distance
