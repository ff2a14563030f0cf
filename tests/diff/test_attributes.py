"""The comparison reports a change of any attribute of an ICD. Each test gives one
attribute another value.
"""

from __future__ import annotations

from dataclasses import fields, replace
from fractions import Fraction

import pytest

from icdgen.diff.compare import compare
from icdgen.icd.curve import table
from icdgen.icd.display import display_of
from icdgen.icd.formula import Scale
from icdgen.icd.layout import Array, Condition, Orders, Scalar, StructRef
from icdgen.icd.layout_copies import (
    with_attributes,
    with_enum,
    with_node,
    with_struct_layout,
)
from icdgen.icd.meanings import Limits, Special
from icdgen.icd.model import ContainedMessage, Enum, Icd, Member, Message
from icdgen.icd.units import STANDARD
from icdgen.loading import load
from tests.icd.files import write

ICD = """\
icdgen: 1
node: {name: demo, title: Demo, byte_order: little, bit_order: lsb0}
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 1, name: Busy}]}
  - {name: State, members: [{value: 0, name: Well}, {value: 1, name: Broken}]}
structs:
  - {name: Pair, length: 2, fields: [{at: 0, bits: 16, name: First, type: uint}]}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 16
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 16, name: Level, type: uint}
      - {at: 32, bits: 16, name: Levels, type: uint, count: 2}
      - {at: 64, name: Both, struct: Pair, count: 2}
      - {at: 96, bits: 8, name: Mode, type: enum, enum: Mode}
"""

NO_CHANGE = {
    "errata": "DIF403 to DIF405 compare the errata of the node",
    "formula": "the calibration is compared, not its spelling",
    "source": "a position in a file",
    "length": "of variable-length bytes only: see DIF119",
}
"""Attributes that are compared elsewhere, or not at all on purpose."""

OTHER = {
    "name": "Altogether Different",
    "at": 24,
    "identifier": "Another Word",
    "aliases": ("Also This",),
    "summary": "Another sentence.",
    "orders": Orders(byte="big"),
    "present_if": (Condition("Kind", (1,)),),
    "type": "int",
    "bits": 8,
    "unit": STANDARD["V"],
    "scale": Scale(Fraction(2), Fraction(0)),
    "curve": table([(0.0, 0.0), (10.0, 5.0)], ""),
    "const": 3,
    "special": (Special(7, "not known"),),
    "limits": Limits(max=Fraction(100)),
    "display": display_of("hex"),
    "size": 4,
}
"""Another value for each attribute of a field."""


@pytest.fixture(scope="module")
def icd(tmp_path_factory) -> Icd:
    return load([write(tmp_path_factory.mktemp("attributes"), ICD)]).icd


def reported(
    icd: Icd, *, message: Message | None = None, enum: Enum | None = None
) -> set[str]:
    """Return the codes of the changes after replacing a message or an enumeration of an
    ICD.
    """
    node = icd.nodes[0]
    if enum is not None:
        layout = with_enum(node.messages[0].layout, node.enums[0], enum)
        message = replace(node.messages[0], layout=layout)
    enums = (enum, *node.enums[1:]) if enum is not None else node.enums
    new = replace(node, messages=(message,), enums=enums)
    return {change.code for change in compare(icd, Icd((new,))).changes}


def names(kind: type) -> list[str]:
    return [field.name for field in fields(kind) if field.name not in NO_CHANGE]


@pytest.mark.parametrize("name", names(Scalar))
def test_another_value_of_any_attribute_of_a_field_is_reported(icd, name):
    message = icd.nodes[0].messages[0]
    level, mode = message.layout.fixed[1], message.layout.fixed[-1]
    old, value = (
        (mode, icd.nodes[0].enums[1]) if name == "enum" else (level, OTHER[name])
    )
    layout = with_node(message.layout, old, with_attributes(old, **{name: value}))
    assert reported(icd, message=replace(message, layout=layout))


@pytest.mark.parametrize(
    "name", [name for name in names(Array) if name not in ("item", "present_if")]
)
def test_another_value_of_any_attribute_of_an_array_is_reported(icd, name):
    message = icd.nodes[0].messages[0]
    old = message.layout.fixed[2]
    value = old.at + 40 if name == "at" else OTHER[name]
    layout = with_node(message.layout, old, with_attributes(old, **{name: value}))
    assert reported(icd, message=replace(message, layout=layout))


@pytest.mark.parametrize(
    "name", [name for name in names(StructRef) if name not in ("layout", "present_if")]
)
def test_another_value_of_any_attribute_of_an_array_of_structs_is_reported(icd, name):
    message = icd.nodes[0].messages[0]
    old = message.layout.fixed[3]
    value = old.at + 40 if name == "at" else OTHER[name]
    layout = with_node(message.layout, old, with_attributes(old, **{name: value}))
    assert reported(icd, message=replace(message, layout=layout))


@pytest.mark.parametrize(
    "name", [name for name in names(Scalar) if name not in ("present_if", "identifier")]
)
def test_another_value_of_any_attribute_of_a_field_of_a_struct_is_reported(icd, name):
    message = icd.nodes[0].messages[0]
    struct = icd.nodes[0].structs[0].layout
    old = struct.fixed[0]
    value = {"at": 4, "enum": icd.nodes[0].enums[1]}.get(name) or OTHER[name]
    changed = with_node(struct, old, with_attributes(old, **{name: value}))
    assert reported(
        icd,
        message=replace(
            message, layout=with_struct_layout(message.layout, struct, changed)
        ),
    )


OF_MESSAGE = {
    "name": "Altogether Different",
    "kind": "telecommand",
    "id": 131,
    "identifier": "Another Word",
    "group": "Others",
    "table": 3,
    "page": 4,
    "summary": "Another sentence.",
    "acknowledge": False,
    "response": "none",
    "repeat": True,
    "requested": False,
    "period_ms": 250,
    "hazard": "It burns.",
    "contains": (ContainedMessage("Status", 0),),
    "reserved": 2,
    "may_end_early": "zeros",
    "aliases": ("Also This",),
}
"""Another value for each attribute of a message that the ICD states."""

NOT_OF_MESSAGE = {
    **dict.fromkeys(
        ("length", "fields", "tail", "inner", "node"), "computed from others"
    ),
    **dict.fromkeys(("set_id", "get_id"), "of configuration messages"),
    "layout": "see the tests of fields",
    "errata": NO_CHANGE["errata"],
    "source": NO_CHANGE["source"],
    "expects_reset": "counts only without an acknowledge",
    "assumptions": "about the manual; not in the output of `icdgen show`, which is compared too",
}
"""Attributes of a message that are compared elsewhere, or not at all on purpose."""


@pytest.mark.parametrize(
    "name",
    [field.name for field in fields(Message) if field.name not in NOT_OF_MESSAGE],
)
def test_another_value_of_any_attribute_of_a_message_is_reported(icd, name):
    message = icd.nodes[0].messages[0]
    assert reported(icd, message=replace(message, **{name: OF_MESSAGE[name]}))


def test_another_length_of_a_message_is_reported(icd):
    message = icd.nodes[0].messages[0]
    assert reported(
        icd, message=replace(message, layout=replace(message.layout, length=17))
    )


OF_ENUM = {
    "name": "Altogether",
    "identifier": "Another",
    "summary": "Another sentence.",
    "table": 3,
    "aliases": ("Also This",),
}


@pytest.mark.parametrize("name", OF_ENUM)
def test_another_value_of_any_attribute_of_an_enumeration_is_reported(icd, name):
    old = icd.nodes[0].enums[0]
    assert {field.name for field in fields(Enum)} == {
        *OF_ENUM,
        "members",
        "node",
        "errata",
        "source",
    }
    assert reported(icd, enum=replace(old, **{name: OF_ENUM[name]}))


@pytest.mark.parametrize(
    "name",
    [field.name for field in fields(Member) if field.name not in ("errata", "source")],
)
def test_another_value_of_any_attribute_of_a_member_is_reported(icd, name):
    old = icd.nodes[0].enums[0]
    value = OF_ENUM | {"value": 5, "to": 9}
    changed = replace(old.members[1], **{name: value[name]})
    assert reported(icd, enum=replace(old, members=(old.members[0], changed)))


@pytest.mark.parametrize("name", ("summary", "aliases"))
def test_a_changed_text_of_a_struct_is_reported(icd, name):
    node = icd.nodes[0]
    struct = replace(node.structs[0], **{name: OTHER[name]})
    changes = compare(icd, Icd((replace(node, structs=(struct,)),))).changes
    assert [(change.code, change.where.node) for change in changes] == [
        ("DIF401", "demo")
    ]
