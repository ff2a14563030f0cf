"""The wire layer of a crate contains only the parts that its ICDs describe.

`tests/conformance/test_wire.py` tests the complete wire layer.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from tests import links
from tests.conformance import wire_random
from tests.rust import harness
from tests.rust.tools import USED, Toolchain, run

SMALL = """\
icdgen: 1
node: {name: small, title: Small node, byte_order: big, bit_order: msb0}
protocol:
  link:
    buses:
      uart:
        framing: {by: escape, escape: 0x10, start: 0x02, end: 0x03, data: 0x10, other: ignore, escaped_in: [data]}
messages:
  - {name: Ping, kind: telecommand, id: 16, length: 2, fields: [{at: 0, bits: 12, name: Key, type: uint}]}
"""


def test_a_node_with_few_features_works_like_the_reference_codec(tmp_path):
    """The testee and the reference codec agree, also on unsupported requests.

    The ICD has another framing and big-endian numbers.
    """
    (tmp_path / "small.yaml").write_text(SMALL)
    icd = harness.read_unchecked(tmp_path / "small.yaml")
    link, generator = links.link(icd, "small"), random.Random(3)
    requests = [wire_random.stream(link, generator) for _ in range(500)]
    requests += [
        {"op": "uart_encode", "bytes": "10" + generator.randbytes(9).hex()}
        for _ in range(50)
    ]
    script = [
        {"at": 0, "telecommand": 16, "bytes": "1010"},
        {"at": 4, "receive": "10021001"},
        {"at": 1 << 31},
    ]
    requests += [
        {"op": "client", "bus": bus, "script": script} for bus in ("uart", "can", "i2c")
    ]
    requests += [
        {"op": "checksum", "name": "crc8", "bytes": ""},
        {"op": "procedure", "name": "list", "script": []},
        {"op": "dos_time", "value": 3},
    ]
    assert harness.differences(icd, harness.build_testee(icd), requests) == []


def test_a_joiner_needs_room_for_all_packets_of_a_message(shipped, tmp_path):
    tools = Toolchain("default")
    library = tools.library(shipped.crate, *USED)
    program = Path(__file__).with_name("joiner.rs")
    run(tools.program(program, library, tmp_path / "program"))


def test_a_node_without_a_protocol_has_no_link(shipped):
    texts = harness.texts(shipped.icd)
    assert (
        "LINK" in texts["src/cubeacp/mod.rs"]
        and "LINK" not in texts["src/cubemag/mod.rs"]
    )


def test_a_crate_without_a_protocol_has_no_wire_layer(strange):
    assert not [
        name
        for name, text in harness.texts(strange.icd).items()
        if "wire" in name or "crate::wire" in text
    ]


ESCAPED = """\
icdgen: 1
node: {name: small, title: Small node, byte_order: big, bit_order: msb0}
protocol:
  link:
    framing: {by: escape, escape: 0x10, START end: 0x03, data: 0x10}
    header: [{bits: 8, role: id}]
messages:
  - {name: Ping, kind: telecommand, id: 16, length: 0}
"""


@pytest.mark.parametrize(
    ("start", "value"),
    [("", "None"), ("start: 0x00,", "Some(0x00)"), ("start: 0xFF,", "Some(0xff)")],
)
def test_packets_begin_with_the_start_byte_of_the_icd_if_it_has_one(
    start, value, tmp_path
):
    (tmp_path / "small.yaml").write_text(ESCAPED.replace("START", start))
    texts = harness.texts(harness.read_unchecked(tmp_path / "small.yaml"))
    link = " ".join(texts["src/wire/links/small.rs"].split())
    assert f"escape: 0x10, start: {value}, end: 0x03, data: 0x10" in link
