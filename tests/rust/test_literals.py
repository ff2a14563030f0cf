"""Links and types in generated Rust are expressions with exactly their values."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from icdgen.backends.literals import written
from icdgen.backends.rust.facts import member_name, value_of
from icdgen.backends.rust.literals import flat, flat_rows, part, rows, some, struct
from icdgen.backends.rust.types import (
    enum_path,
    message_path,
    one_type,
    open_type,
    raw_type,
    reason_number,
    struct_path,
)
from icdgen.describe import describe
from icdgen.protocol.declared import FactKind, ProtocolFact
from tests.icd.files import loaded, status


def text_of(value):
    return written(value, lambda text, indent: f"{indent}// {text}")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "None"),
        (0, "Some(0)"),
        (False, "Some(false)"),
        (1_000_000, "Some(1_000_000)"),
        ("RATE", "Some(RATE)"),
        (flat("Span", at=3, bytes=2), "Some(link::Span { at: 3, bytes: 2 })"),
        (flat_rows(["1", "2"]), "Some(&[1, 2])"),
    ],
)
def test_an_optional_value_is_some_or_none(value, text):
    assert text_of(some(value)) == text


def test_a_struct_has_a_field_per_line_with_its_assumption():
    value = struct(
        "Link",
        part("name", "3", "assumed"),
        part("rows", rows([flat("Row", name=True), "ROW"])),
        part("none", rows([])),
    )
    assert text_of(value) == (
        "link::Link {\n"
        "    // assumed\n"
        "    name: 3,\n"
        "    rows: &[\n"
        "        link::Row { name: true },\n"
        "        ROW,\n"
        "    ],\n"
        "    none: &[],\n"
        "}"
    )


@pytest.mark.parametrize(
    ("kind", "value", "text"),
    [
        (FactKind.NUMBER, 1000, "1_000"),
        (FactKind.TIME, 0, "0"),
        (FactKind.FLAG, True, "true"),
        (FactKind.OCTET, 5, "0x05"),
        (FactKind.CODE, 0x21, "0x0000_0021"),
        (FactKind.SPAN, (3, 2), "link::Span { at: 3, bytes: 2 }"),
        (
            FactKind.BUSES,
            ("can",),
            "link::PerBus { uart: false, i2c: false, can: true }",
        ),
        (FactKind.NUMBER, (1, 2000), "&[1, 2_000]"),
    ],
)
def test_a_fact_is_spelled_as_its_kind(kind, value, text):
    section = SimpleNamespace(rate=value)
    required = ProtocolFact("rate", kind, "rate", "rate")
    optional = ProtocolFact("rate", kind, "rate", "rate", default=None)
    assert text_of(value_of(required, section)) == text
    assert text_of(value_of(optional, section)) == f"Some({text})"
    assert text_of(value_of(optional, SimpleNamespace(rate=None))) == "None"


@pytest.mark.parametrize(("width", "text"), [(5, "0x07"), (8, "0x07"), (16, "0x0007")])
def test_a_code_of_a_checksum_has_the_digits_of_its_width(width, text):
    fact = ProtocolFact("poly", FactKind.CODE, "poly", "poly")
    assert value_of(fact, SimpleNamespace(poly=7, width=width)) == text


def test_the_name_of_a_time_ends_with_its_unit():
    names = [
        member_name(ProtocolFact("wait", kind, "wait", "wait"))
        for kind in (FactKind.TIME, FactKind.NUMBER)
    ]
    assert names == ["wait_ms", "wait"]


@pytest.mark.parametrize(
    ("bits", "text"),
    [
        (8, "u8::try_from(code).unwrap_or(u8::MAX)"),
        (16, "u16::try_from(code).unwrap_or(u16::MAX)"),
        (32, "code"),
        (64, "u64::from(code)"),
    ],
)
def test_a_number_of_a_reason_saturates_in_its_enumeration(bits, text):
    enum = SimpleNamespace(storage=SimpleNamespace(bits=bits))
    assert reason_number(enum) == text


TYPES = """\
enums:
  - name: Mode
    members:
      - {value: 1, name: Idle}
structs:
  - name: Point
    length: 1
    fields:
      - {at: 0, bits: 8, name: X, type: uint}
"""


def test_fields_have_the_type_of_their_raw_value(tmp_path):
    fields = (
        "at: 0, bits: 9, name: A, type: uint",
        "at: 9, bits: 7, name: B, type: int",
        "at: 16, bits: 1, name: C, type: bool",
        "at: 17, bits: 7, name: Flags, type: uint",
        "at: 24, bits: 32, name: D, type: float",
        "at: 56, bits: 24, name: E, type: bytes",
        "at: 80, bits: 8, name: F, type: enum, enum: Mode",
        "at: 88, name: G, struct: Point",
        "at: 96, bits: 8, name: H, type: uint, count: 3",
        "at: 120, bits: 64, name: I, type: int, when: {A: 1}",
    )
    result = loaded(tmp_path, TYPES + status(*fields, length=23))
    assert result.ok, [finding.message for finding in result.findings]
    (message,) = describe(result.icd).nodes[0].messages
    assert [raw_type(field) for field in message.members] == [
        "u16",
        "i8",
        "bool",
        "u8",
        "f32",
        "[u8; 3]",
        "Coded<enums::Mode>",
        "super::Point",
        "[u8; 3]",
        "Option<i64>",
    ]
    by_name = {field.name: field for field in message.members}
    assert one_type(by_name["h"]) == "u8"
    assert open_type(by_name["h"]) == "[u8]"
    assert open_type(by_name["e"]) == "[u8]"


def test_a_path_leads_from_another_node_to_its_crate_module(tmp_path):
    field = "at: 0, name: G, struct: Point"
    result = loaded(tmp_path, TYPES + status(field, length=1))
    node = describe(result.icd).nodes[0]
    own, other = node.model, SimpleNamespace(name="radio")
    (message,), (enum,) = node.messages, node.enums
    struct = message.members[0].struct
    assert enum_path(enum, own) == "enums::Mode"
    assert enum_path(enum, other) == "crate::demo::enums::Mode"
    assert message_path(message, own) == "Status"
    assert message_path(message, other) == "crate::demo::Status"
    assert struct_path(struct, own) == "super::Point"
    assert struct_path(struct, other) == "crate::demo::Point"
