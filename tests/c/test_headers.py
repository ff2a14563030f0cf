"""Headers of generated C include what they use, each once."""

from __future__ import annotations

import pytest

from icdgen.backends.c import (
    CBackend,
    client_headers,
    file_comment,
    includes,
    procedure_headers,
)
from icdgen.backends.origin import origin
from icdgen.describe import describe
from icdgen.loading import load
from tests.describe.small import node_of
from tests.icd.files import loaded, write

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
include: [common.yaml]
enums:
  - {name: Own, members: [{value: 1, name: Idle}]}
structs:
  - name: Point
    length: 1
    fields: [{at: 0, bits: 8, name: Mode, type: enum, enum: Own}]
messages:
  - name: State
    id: 0
    kind: telemetry
    length: 8
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Own}
      - {at: 8, bits: 8, name: Again, type: enum, enum: Own}
      - {at: 16, bits: 8, name: Other, type: enum, enum: Shared}
      - {at: 24, name: Point, struct: Point}
      - {at: 32, name: Pair, struct: Pair}
      - {at: 48, name: Pairs, struct: Pair}
  - {name: Empty, id: 255, kind: telemetry, length: 0}
# common.yaml
icdgen: 1
node: {name: common, title: Common, byte_order: little, bit_order: lsb0}
enums:
  - {name: Shared, members: [{value: 1, name: Idle}]}
structs:
  - name: Pair
    length: 2
    fields: [{at: 0, bits: 16, name: X, type: uint}]
"""


@pytest.fixture
def nodes(tmp_path):
    result = loaded(tmp_path, ICD)
    assert result.ok, [finding.message for finding in result.findings]
    return {node.name: node for node in describe(result.icd).nodes}


def test_a_message_includes_its_enumerations_and_structs_each_once(nodes):
    state, empty = nodes["demo"].messages
    assert includes(state) == [
        "../icdgen.h",
        "../common/enums.h",
        "enums.h",
        "point.h",
        "../common/pair.h",
    ]
    assert includes(empty) == ["../icdgen.h"]


def test_a_message_with_wide_arithmetic_includes_only_its_header(tmp_path):
    wide = """\
messages:
  - name: State
    id: 0
    kind: telemetry
    length: 2
    fields: [{at: 0, bits: 16, name: Rate, type: uint, formula: raw*2^-70}]
"""
    node = node_of(tmp_path, wide)
    assert includes(node.messages[0]) == ["../icdgen_wide.h"]
    assert file_comment(node.messages[0]).startswith("/**\n * @file\n")


def test_clients_and_procedures_include_the_link_first(nodes):
    assert client_headers(nodes["demo"]) == [
        "link.h",
        "../common.h",
        "empty.h",
        "state.h",
    ]
    assert procedure_headers(nodes["demo"]) == ["link.h", "../common.h", "enums.h"]


def test_files_are_generated_for_what_a_node_declares(tmp_path, render):
    icd = loaded(tmp_path, ICD).icd
    assert [str(path) for path, _ in CBackend().files(icd, render)] == [
        "icdgen.h",
        "common/enums.h",
        "common/pair.h",
        "common.h",
        "demo/enums.h",
        "demo/point.h",
        "demo/state.h",
        "demo/empty.h",
        "demo.h",
    ]


LINKED = """\
protocol:
  link:
    buses:
      uart:
        framing: {by: escape, escape: 16, start: 2, end: 3, data: 16}
messages:
  - {name: Zero, id: 0, kind: telecommand, length: 0}
  - name: Wide
    id: 255
    kind: telemetry
    length: 2
    fields: [{at: 0, bits: 16, name: Rate, type: uint, formula: raw*2^-70}]
"""


def test_a_link_has_the_wire_layer_and_a_client_but_procedures_only_if_it_has_some(
    tmp_path, render
):
    icd = load([write(tmp_path, LINKED)], check=False).icd
    files = {str(path): text for path, text in CBackend().files(icd, render)}
    assert [*files] == [
        "icdgen.h",
        "icdgen_wide.h",
        "icdgen_wire.h",
        "icdgen_wire.c",
        "demo/zero.h",
        "demo/wide.h",
        "demo/link.h",
        "demo/link.c",
        "demo/client.h",
        "demo.h",
    ]
    node = icd.nodes[0]
    for path, text in files.items():
        of = None if path.startswith("icdgen") else node
        assert text.startswith(f"/* {origin(of)} */\n"), path
    assert "uint8_t id" in files["demo.h"]


@pytest.fixture
def render():
    from tests.c import harness

    return harness._renderer()
