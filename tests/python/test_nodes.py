"""Modules of nodes in generated Python: names, ids, imports and the docstring."""

from __future__ import annotations

import pytest

from icdgen.backends.python.nodes import (
    by_id,
    declared,
    enum_classes,
    imports_of,
    listing,
    literals,
    mapping,
    node_docstring,
    public,
    public_of_node,
)
from icdgen.describe import describe
from tests.describe.small import node_of
from tests.icd.files import loaded

ICD = """\
enums:
  - name: Run Mode
    members:
      - {value: 1, name: Idle}
structs:
  - name: Point
    length: 2
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Run Mode}
      - {at: 8, bits: 8, name: "Y", type: int}
messages:
  - {name: Zero, id: 0, kind: telecommand, length: 0}
  - {name: Last, id: 255, kind: telecommand, length: 0}
  - name: State
    set_id: 7
    get_id: 9
    kind: configuration
    length: 3
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Run Mode}
      - {at: 8, name: Point, struct: Point}
  - name: Start
    id: 5
    kind: telecommand
    shares_id: true
    length: 2
    fields:
      - {at: 0, bits: 8, name: Action, type: uint, const: 1}
      - {at: 12, bits: 4, name: More, type: uint, const: 0xA}
  - name: Stop
    id: 5
    kind: telecommand
    shares_id: true
    length: 1
    fields:
      - {at: 0, bits: 8, name: Action, type: uint, const: 2}
      - {at: 8, bits: 16, name: Rest, type: uint, count: rest, up_to: 2}
"""


def test_ids_of_a_direction_are_in_order_with_a_row_for_each_message_of_a_shared_one(
    tmp_path,
):
    node = node_of(tmp_path, ICD)
    assert by_id(node, "telecommand") == [
        (0, '"Zero"'),
        (
            5,
            "(\n"
            '        ("Start", range(2, 3), ((0, 0xFF, 0x01), (1, 0xF0, 0xA0),)),\n'
            '        ("Stop", range(1, 6, 2), ((0, 0xFF, 0x02),)),\n'
            "    )",
        ),
        (7, '"State"'),
        (255, '"Last"'),
    ]
    assert by_id(node, "telemetry") == [(9, '"State"')]


def test_names_of_a_node_are_listed_with_their_modules(tmp_path):
    node = node_of(tmp_path, ICD)
    pairs = declared(node)
    assert pairs == sorted(pairs, key=lambda pair: pair[::-1])
    assert dict(pairs) == {
        "RunMode": "._types.run_mode",
        "Point": "._types.point",
        "Zero": "._types.zero",
        "Last": "._types.last",
        "State": "._types.state",
        "Start": "._types.start",
        "Stop": "._types.stop",
    }
    assert public_of_node(node) == sorted(
        [
            "DIGEST", "ENUMS", "NAME", "TELECOMMANDS", "TELEMETRY", "TITLE",
            "decode_telecommand", "decode_telemetry", *dict(pairs),
        ]
    )  # fmt: skip
    assert enum_classes(node) == [("Run Mode", "RunMode")]
    assert public([node]) == [
        "FieldInfo", "IcdError", "LengthError", "Message", "NODES", "OpenEnum",
        "RangeError", "Struct", "UnknownIdError", "demo", "is_special",
    ]  # fmt: skip


LINKED = """\
protocol:
  link:
    buses:
      uart:
        framing: {by: escape, escape: 16, start: 2, end: 3, data: 16}
messages:
  - {name: Zero, id: 0, kind: telecommand, length: 0}
"""


def test_a_node_with_a_link_has_its_description(tmp_path):
    node = node_of(tmp_path, LINKED)
    assert declared(node) == [("LINK", "._link"), ("Zero", "._types.zero")]
    assert "LINK" in public_of_node(node)
    # Without procedures, there is no module for them.
    assert "procedures" not in public_of_node(node)


@pytest.mark.parametrize(
    ("keys", "names"),
    [
        ("", []),
        (", node_type: 0", ["NODE_TYPE"]),
        (", interface_version: 0", ["INTERFACE_VERSION"]),
        (", node_type: 3, interface_version: 1", ["INTERFACE_VERSION", "NODE_TYPE"]),
    ],
)
def test_constants_of_a_node_are_public_if_the_icd_has_them(tmp_path, keys, names):
    text = (
        "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, "
        f"bit_order: lsb0{keys}}}\n"
    )
    node = node_of(tmp_path, text)
    assert [
        name
        for name in public_of_node(node)
        if name in ("NODE_TYPE", "INTERFACE_VERSION")
    ] == names


def test_a_class_is_imported_from_the_node_that_declares_it(tmp_path):
    text = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
include: [common.yaml]
enums:
  - name: Own
    members:
      - {value: 1, name: Idle}
messages:
  - name: State
    id: 130
    kind: telemetry
    length: 4
    fields:
      - {at: 0, bits: 8, name: Mode, type: enum, enum: Own}
      - {at: 8, bits: 8, name: Other, type: enum, enum: Shared}
      - {at: 16, name: Pair, struct: Pair}
# common.yaml
icdgen: 1
node: {name: common, title: Common, byte_order: little, bit_order: lsb0}
enums:
  - name: Shared
    members:
      - {value: 1, name: Idle}
structs:
  - name: Pair
    length: 2
    fields:
      - {at: 0, bits: 16, name: X, type: uint}
"""
    result = loaded(tmp_path, text)
    assert result.ok, [finding.message for finding in result.findings]
    (node,) = (each for each in describe(result.icd).nodes if each.name == "demo")
    (state,) = node.messages
    assert imports_of(state) == [
        "from ...common._types.pair import Pair",
        "from ...common._types.shared import Shared",
        "from .own import Own",
    ]


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ("", ""),
        (
            "document: ICD 7, version: v2, date: '2024-01-31'",
            "From ICD 7, v2, 2024-01-31.\n\n",
        ),
        (
            "document: ICD 7, version: v2, section: '3'",
            "From ICD 7, v2, section 3.\n\n",
        ),
        ("document: ICD 7, section: '3'", "From ICD 7, section 3.\n\n"),
    ],
)
def test_the_docstring_of_a_node_cites_its_document(tmp_path, keys, text):
    source = f", source: {{{keys}}}" if keys else ""
    icd = (
        "icdgen: 1\nnode: {name: demo, title: Demo, byte_order: little, "
        f"bit_order: lsb0{source}}}\n"
        "missing: [{kind: telemetry, id: 255, name: Log, why: No layout is given}]\n"
    )
    assert node_docstring(node_of(tmp_path, icd).model) == (
        f'"""Demo.\n\n{text}Missing: telemetry 255, Log. No layout is given.\n"""'
    )


def test_dictionaries_and_lists_are_literals_with_a_line_for_each_item():
    assert listing([]) == "[]"
    assert listing(["a", 'b"']) == '[\n    "a",\n    \'b"\',\n]'
    assert mapping([("A", "b")]) == '{\n    "A": "b",\n}'
    assert literals([(0, "A"), (255, "B")]) == "{\n    0: A,\n    255: B,\n}"
