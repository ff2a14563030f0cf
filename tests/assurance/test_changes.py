"""Single changes of an ICD: which values are tried, and which are left out."""

from __future__ import annotations

import pytest

from icdgen.backends.assurance import changes
from icdgen.backends.assurance.changes import formulas, tables
from icdgen.icd.model import Node
from tests.icd.files import HEAD, loaded


def node_of(folder, text: str) -> Node:
    return loaded(folder, text).icd.nodes[0]


def changes_of(folder, field: str, length: int, *others: str, more: str = "") -> list:
    """Return kind, old and new value of the changes of the first field."""
    rows = "".join(f"      - {{{row}}}\n" for row in (field, *others))
    text = (
        f"{more}messages:\n  - name: Status\n    id: 1\n    kind: telemetry\n"
        f"    length: {length}\n    fields:\n{rows}"
    )
    node = node_of(folder, text)
    layout = node.messages[0].layout
    first = layout.nodes[0]
    return [
        (change.kind, change.old, change.now)
        for change, _ in changes.of_line(first, layout, node.orders)
    ]


def by(kind: str, old: int, *steps: int) -> list[tuple]:
    return [(kind, old, old + step) for step in steps]


TYPES = [("type", "uint", "int"), ("type", "uint", "bytes")]


@pytest.mark.parametrize(
    ("field", "length", "expected"),
    [
        ("at: 0, bits: 8, name: A, type: uint", 1, [*by("width", 8, -1), *TYPES]),
        ("at: 8, bits: 8, name: A, type: uint", 2,
         [*by("offset", 8, -8, -1), *by("width", 8, -1), *TYPES]),
        ("at: 8, bits: 8, name: A, type: uint", 3,
         [*by("offset", 8, -8, -1, 1, 8), *by("width", 8, -1, 1), *TYPES]),
        ("at: 7, bits: 1, name: A, type: bool", 2,
         [*by("offset", 7, -1, 1, 8), ("type", "bool", "uint"), ("type", "bool", "int")]),
        ("at: 1, bits: 1, name: A, type: uint", 1,
         [*by("offset", 1, -1, 1), *by("width", 1, 1), ("type", "uint", "int"),
          ("type", "uint", "bool")]),
        ("at: 0, bits: 32, name: A, type: float", 4,
         [("type", "float", "uint"), ("type", "float", "int"), ("type", "float", "bytes")]),
        ("at: 8, bits: 16, name: A, type: bytes", 4,
         [*by("offset", 8, -8, 8), *by("width", 16, -8, 8), ("type", "bytes", "uint"),
          ("type", "bytes", "int")]),
        ("at: 0, bits: 80, name: A, type: text", 10,
         [*by("width", 80, -8), ("type", "text", "bytes")]),
        ("at: 0, bits: 8, count: 2, name: A, type: int", 3,
         [*by("offset", 0, 1, 8), *by("width", 8, -1, 1), *by("count", 2, -1, 1),
          ("type", "int", "uint")]),
        ("at: 0, bits: 8, count: 2, name: A, type: int", 2,
         [*by("width", 8, -1), *by("count", 2, -1), ("type", "int", "uint")]),
        ("at: 8, bits: 8, count: 2, name: A, type: int", 3,
         [*by("offset", 8, -8, -1), *by("width", 8, -1), *by("count", 2, -1),
          ("type", "int", "uint")]),
        ("at: 4, bits: 8, name: A, type: uint", 2,
         [*by("offset", 4, -1, 1), *by("width", 8, -1, 1), ("type", "uint", "int")]),
        ("at: 0, bits: 8, name: A, type: uint, const: 7", 1,
         [*by("width", 8, -1), ("type", "uint", "int"), *by("const", 7, -1, 1)]),
        ("at: 0, bits: 8, name: A, type: uint, unit: m, min: 0, max: 9", 1,
         [*by("width", 8, -1), ("type", "uint", "int"), *by("limit", 0, -1, 1),
          *by("limit", 9, -1, 1)]),
        ("at: 0, bits: 16, name: A, type: uint, byte_order: big", 2,
         [*by("width", 16, -1), *TYPES, ("byte order", "big", "little")]),
        ("at: 0, bits: 8, name: A, type: uint, byte_order: big", 1,
         [*by("width", 8, -1), *TYPES]),
        ("at: 0, bits: 32, name: A, type: float, special: [{value: nan, meaning: B}]", 4,
         [("special", "nan", "inf"), ("special", "nan", "-inf")]),
    ],
)  # fmt: skip
def test_each_number_of_a_field_is_changed_if_the_result_fits(
    tmp_path, field, length, expected
):
    assert changes_of(tmp_path, field, length) == expected


@pytest.mark.parametrize(
    "other",
    [
        "at: 8, bits: 8, name: B, type: uint, when: {A: 1}",
        "at: 8, bits: 8, name: B, type: uint, count: A, up_to: 3",
    ],
)
def test_a_field_that_others_depend_on_is_not_changed(tmp_path, other):
    field = "at: 0, bits: 8, name: A, type: uint"
    assert changes_of(tmp_path, field, 1 + ("when" in other), other) == []


def test_each_number_of_a_formula_is_changed_in_its_last_digit_and_by_ten():
    assert list(formulas("raw*0.50 - 3")) == [
        "raw*0.49 - 3",
        "raw*0.51 - 3",
        "raw*5.00 - 3",
        "raw*0.05 - 3",
        "raw*0.50 - 2",
        "raw*0.50 - 4",
        "raw*0.50 - 30",
        "raw*0.50 - 0.3",
        "-raw*0.50 - 3",
        "raw*0.50 - 3 + 1",
    ]
    assert list(formulas("raw = value/2"))[-2:] == [
        "raw = -value/2",
        "raw = value/2 + 1",
    ]
    assert list(formulas("raw")) == ["-raw", "raw + 1"]


def test_each_number_of_a_table_is_changed_by_one():
    assert list(tables([[0, 1.5], [10, "1e1"]])) == [
        [[-1, 1.5], [10, "1e1"]],
        [[1, 1.5], [10, "1e1"]],
        [[0, 0.5], [10, "1e1"]],
        [[0, 2.5], [10, "1e1"]],
        [[0, 1.5], [9, "1e1"]],
        [[0, 1.5], [11, "1e1"]],
        [[0, 1.5], [10, 9.0]],
        [[0, 1.5], [10, 11.0]],
    ]


def test_members_are_changed_but_ranges_do_not_overlap(tmp_path):
    text = (
        "enums:\n  - name: Mode\n    members: [{value: 5, name: A}, {value: 0, to: 4, "
        "name: B}, {value: 8, to: 9, name: C}]\nmessages: []\n"
    )
    (enum,) = node_of(tmp_path, text).enums
    result = list(changes.of_enum(enum))
    assert [(change.key, change.old, change.now) for change, _ in result] == [
        ("value", 5, 4),
        ("value", 5, 6),
        ("value", 0, -1),
        ("value", 0, 1),
        ("to", 4, 3),
        ("value", 8, 7),
        ("value", 8, 9),
        ("to", 9, 8),
        ("to", 9, 10),
    ]
    assert [member.value for member in result[1][1].members] == [6, 0, 8]
    assert [member.to for member in result[-1][1].members] == [None, 4, 10]


def test_attributes_of_messages_and_nodes_are_changed(tmp_path):
    head = HEAD.replace("lsb0}", "lsb0, node_type: 0, interface_version: 2}")
    text = (
        f"{head}messages:\n"
        "  - {name: Both, set_id: 0, get_id: 9, kind: configuration, length: 2, "
        "byte_order: big, fields: [{at: 0, bits: 12, name: A, type: uint}]}\n"
        "  - {name: Rest, id: 1, kind: telemetry, length: 0, fields: [{at: 0, bits: 8, "
        "name: B, type: uint, count: rest, up_to: 3}]}\n"
    )
    node = node_of(tmp_path, text)
    both, rest = (
        [(c.kind, c.key, c.old, c.now) for c, _ in changes.of_message(message, node)]
        for message in node.messages
    )
    assert both == [
        ("id", "set_id", 0, 1),
        ("id", "get_id", 9, 8),
        ("id", "get_id", 9, 10),
        ("length", "length", 2, 1),
        ("length", "length", 2, 3),
        ("byte order", "byte_order", "big", "little"),
    ]
    assert rest == [("id", "id", 1, 0), ("id", "id", 1, 2)]
    assert [(c.kind, c.key, c.old, c.now) for c, _ in changes.of_node(node)] == [
        ("node", "node_type", 0, -1),
        ("node", "node_type", 0, 1),
        ("node", "interface_version", 2, 1),
        ("node", "interface_version", 2, 3),
        ("bit order", "bit_order", "lsb0", "msb0"),
    ]
