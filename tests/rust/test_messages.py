"""Values and statements of the templates of messages in Rust."""

from __future__ import annotations

import pytest
import yaml

from icdgen.backends.rust import messages
from icdgen.backends.rust.elements import array_functions
from icdgen.describe import describe
from icdgen.describe.lengths import ElementBytes
from tests.icd.files import loaded, status

TYPES = """\
enums:
  - {name: Mode, members: [{value: 2, name: Idle}, {value: 3, name: Run}]}
structs:
  - name: Point
    length: 2
    fields:
      - {at: 0, bits: 4, name: X, type: uint, const: 5}
      - {at: 4, bits: 1, name: A, type: bool}
      - {at: 5, bits: 1, name: B, type: bool}
      - {at: 6, bits: 1, name: C, type: bool}
      - {at: 7, bits: 1, name: D, type: bool}
      - {at: 8, bits: 8, name: Type, type: uint}
"""


def message_of(folder, *fields, length=None, more=""):
    """Return the description of a message that ends with its last field."""
    keys = [yaml.safe_load(f"{{{field}}}") for field in fields]
    if length is None:
        ends = (row["at"] + row.get("bits", 16) * row.get("count", 1) for row in keys)
        length = -(-max(ends, default=0) // 8)
    result = loaded(folder, TYPES + status(*fields, length=length) + more)
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0].messages[0]


def flags(count: int, first: int = 0) -> list[str]:
    return [
        f"at: {first + n}, bits: 1, name: Flag {n}, type: bool" for n in range(count)
    ]


def test_four_flags_of_a_byte_are_read_from_a_table(tmp_path):
    assert messages.flag_bytes(message_of(tmp_path, *flags(3))) == []
    assert messages.flag_bytes(message_of(tmp_path, *flags(4))) == [0]
    message = message_of(tmp_path, *flags(16, 4))
    assert messages.flag_bytes(message) == [0, 1, 2]
    assert messages.literal(message).splitlines()[:3] == [
        "        Self {",
        "            flag_0: flags_0[4],",
        "            flag_1: flags_0[5],",
    ]


def test_the_literal_of_a_message_has_optional_fields_as_none(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Type, type: uint",
        "at: 8, bits: 8, name: Rate, type: uint, when: {Type: 1}",
    )
    assert messages.literal(message) == (
        "        Self {\n"
        "            r#type: bytes[0],\n"
        "            rate: None,\n"
        "        }"
    )
    assert messages.write_statements(message) == ["bytes[0] = self.r#type;"]
    assert messages.fits(message) == []


def test_the_literal_of_a_message_without_fields_is_empty(tmp_path):
    assert messages.literal(message_of(tmp_path)) == "        Self {}"


def test_fields_that_can_be_too_large_are_checked_in_order(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 4, name: Low, type: uint",
        "at: 8, bits: 8, name: Byte, type: uint",
        "at: 16, bits: 12, name: Rate, type: uint, when: {Low: 1}",
        "at: 32, name: Point, struct: Point",
    )
    assert messages.fits(message) == ["LOW.fit(self.low)?;", "self.point.fit()?;"]


@pytest.mark.parametrize(
    ("field", "derived"),
    [
        ("bits: 8, type: uint", "Clone, Copy, Debug, Default, PartialEq, Eq, Hash"),
        ("bits: 32, type: float", "Clone, Copy, Debug, Default, PartialEq"),
        ("bits: 8, type: uint, const: 1", "Clone, Copy, Debug, PartialEq, Eq, Hash"),
        (
            "bits: 8, type: uint, count: 32",
            "Clone, Copy, Debug, Default, PartialEq, Eq, Hash",
        ),
        ("bits: 8, type: uint, count: 33", "Clone, Copy, Debug, PartialEq, Eq, Hash"),
        ("bits: 256, type: bytes", "Clone, Copy, Debug, Default, PartialEq, Eq, Hash"),
        ("bits: 264, type: bytes", "Clone, Copy, Debug, PartialEq, Eq, Hash"),
    ],
)
def test_a_message_derives_the_traits_that_its_fields_have(tmp_path, field, derived):
    message = message_of(tmp_path, f"at: 0, name: A, {field}")
    assert messages.derives(message) == derived
    assert bool(messages.default(message)) == ("Default" not in derived)


def test_initial_values_are_those_of_the_constants(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 16, name: Type, type: uint, const: 1000",
        "at: 16, bits: 8, name: Mode, type: enum, enum: Mode, const: 3",
        "at: 25, bits: 1, name: Other, type: bool",
        "at: 32, bits: 32, name: Ratio, type: float",
        "at: 64, bits: 24, name: Data, type: bytes",
        "at: 88, bits: 8, name: Levels, type: int, count: 2",
        "at: 104, name: Point, struct: Point",
        "at: 120, bits: 8, name: Rate, type: uint, when: {Type: 1000}",
        "at: 128, bits: 8, name: Late, type: uint, when: {Other: true}",
        length=17,
    )
    assert messages.default(message).splitlines() == [
        "        Self {",
        "            r#type: 1_000,",
        "            mode: Coded::from_raw(3),",
        "            other: false,",
        "            ratio: 0.0,",
        "            data: [0; 3],",
        "            levels: [0; 2],",
        "            point: super::Point::default(),",
        "            rate: Some(0),",
        "            late: None,",
        "        }",
    ]


@pytest.mark.parametrize(
    ("field", "value"),
    [
        # New messages have the fewest elements, and absent ones are read from zeros.
        (
            "name: Points, struct: Point, count: Last",
            "[Self::read_points(&[0; 2]); 4]",
        ),
        (
            "name: Points, struct: Point, count: {field: Last, plus: 2}",
            "first(2, super::Point::default(), Self::read_points(&[0; 2]))",
        ),
        ("bits: 8, type: uint, name: Levels, const: 7, count: Last", "[0; 4]"),
        (
            "bits: 8, type: uint, name: Levels, const: 7, count: {field: Last, plus: 1}",
            "first(1, 7, 0)",
        ),
    ],
)
def test_absent_elements_of_a_new_message_are_zero(tmp_path, field, value):
    message = message_of(
        tmp_path,
        "at: 0, bits: 8, name: Version, type: uint, const: 1",
        "at: 8, bits: 8, name: Last, type: uint",
        f"at: 16, up_to: 4, {field}",
        length=2,
    )
    lines = messages.default(message).splitlines()
    assert lines[-2].split(": ", 1)[1] == f"{value},"


def test_constants_of_fields_have_the_type_of_their_values(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 16, name: Code, type: int, const: -1000",
        "at: 24, bits: 32, name: Ratio, type: float, special: ["
        "{value: nan, meaning: a}, {value: inf, meaning: b},"
        " {value: -inf, meaning: c}, {value: -99.5, meaning: d}]",
        "at: 56, bits: 8, name: Rate, type: uint, formula: raw*0.5, max: 100,"
        " special: [{value: 255, meaning: unknown}]",
        length=8,
    )
    constants = [
        messages.typed_constant(field, constant)
        for field, constant in message.constants
    ]
    assert constants == [
        ("i16", "-1_000"),
        ("f32", "f32::NAN"),
        ("f32", "f32::INFINITY"),
        ("f32", "f32::NEG_INFINITY"),
        ("f32", "-99.5"),
        ("u8", "255"),
        ("f64", "100.0"),
    ]


@pytest.mark.parametrize(
    ("step", "count", "text"),
    [
        (1, "count", "count"),
        (1, "a + b", "a + b"),
        (2, "count", "2 * count"),
        (2, "a + b", "2 * (a + b)"),
    ],
)
def test_bytes_of_elements_are_a_product(step, count, text):
    assert messages.times(step, count) == text


def test_bytes_before_elements_are_added():
    assert messages.bytes_of(ElementBytes(0, 2)) == "2 * count"
    assert messages.bytes_of(ElementBytes(3, 1)) == "3 + count"


def test_a_module_imports_only_the_names_that_it_uses():
    body = """\
/// array(bytes) and Error in a comment // flags(
let text = "take!( Coded \\" words(";
let value = take!(bytes[0; 2]);
pub fn present(&self) {
let other = self.present(1); Self::counted(2); &longest(3);
const RATE: Scale = Scale::new(0);
const LONG: Wide = Wide {};
put_array(&mut bytes);
array_more(1);
"""
    used = messages.used_names(body)
    names = {"Scale", "Self", "Wide", "array_more", "put_array", "take"}
    assert used - {""} == names
    assert messages.imports(used) == "{put_array, take, Scale, Wide}"
    assert messages.imports(frozenset({"array", "other"})) == "array"


def functions_of(message):
    return list(array_functions(message))


def test_an_element_of_a_struct_array_has_a_function(tmp_path):
    message = message_of(
        tmp_path, "at: 8, name: Points, struct: Point, count: 2", length=5
    )
    assert functions_of(message) == [
        {
            "reader": "read_points",
            "writer": "write_points",
            "of": "Points",
            "step": 2,
            "type": "super::Point",
            "tables": [0],
            "value": "        super::Point {\n"
            "            x: bytes[0] & 0x0f,\n"
            "            a: flags_0[4],\n"
            "            b: flags_0[5],\n"
            "            c: flags_0[6],\n"
            "            d: flags_0[7],\n"
            "            r#type: bytes[1],\n"
            "        }",
            "writings": [
                "bytes[0] |= part.x & 0x0f;",
                "bytes[0] |= u8::from(part.a) << 4;",
                "bytes[0] |= u8::from(part.b) << 5;",
                "bytes[0] |= u8::from(part.c) << 6;",
                "bytes[0] |= u8::from(part.d) << 7;",
                "bytes[1] = part.r#type;",
            ],
        }
    ]


def test_a_round_of_elements_that_are_no_bytes_has_a_function(tmp_path):
    message = message_of(
        tmp_path, "at: 8, bits: 4, name: Levels, type: int, count: 4", length=3
    )
    assert functions_of(message) == [
        {
            "reader": "read_levels",
            "writer": "write_levels",
            "of": "Levels",
            "step": 1,
            "type": "[i8; 2]",
            "tables": (),
            "value": "        [\n"
            "            i8::from_le_bytes([(bytes[0] & 0x0f) << 4]) >> 4,\n"
            "            i8::from_le_bytes([(bytes[0] >> 4) << 4]) >> 4,\n"
            "        ]",
            "writings": [
                "let value = u8::from_le_bytes(part[0].to_le_bytes());",
                "bytes[0] |= value & 0x0f;",
                "let value = u8::from_le_bytes(part[1].to_le_bytes());",
                "bytes[0] |= value << 4;",
            ],
        }
    ]


def test_an_element_of_three_bytes_has_a_function(tmp_path):
    message = message_of(
        tmp_path, "at: 0, bits: 24, name: Levels, type: uint, count: 4", length=12
    )
    assert functions_of(message) == [
        {
            "reader": "read_levels",
            "writer": "write_levels",
            "of": "Levels",
            "step": 3,
            "type": "u32",
            "tables": (),
            "value": "        let mut value = u32::from(bytes[0]);\n"
            "        value |= u32::from(bytes[1]) << 8;\n"
            "        value |= u32::from(bytes[2]) << 16;\n"
            "        value",
            "writings": [
                "let value = part;",
                "let value = value.to_le_bytes();",
                "bytes[0] = value[0];",
                "bytes[1] = value[1];",
                "bytes[2] = value[2];",
            ],
        }
    ]


def part_of(folder, count, field="bits: 16, name: Levels, type: uint, count"):
    """Return the last variable part of a message, which a field counts."""
    counter = "at: 0, bits: 8, name: Type, type: uint"
    part = f"at: 8, {field}: {count}, up_to: 9"
    return message_of(folder, counter, part, length=1).last_part


@pytest.mark.parametrize(
    ("count", "elements", "number"),
    [
        ("Type", "self.r#type", "number(self.r#type, 0, 0)"),
        (
            "{field: Type, plus: 2}",
            "number(self.r#type, 0, 2)",
            "number(self.r#type, 0, 2)",
        ),
        (
            "{field: Type, plus: -4}",
            "number(self.r#type, 4, 0)",
            "number(self.r#type, 4, 0)",
        ),
    ],
)
def test_the_size_of_a_part_follows_from_its_counter(tmp_path, count, elements, number):
    part = part_of(tmp_path, count)
    assert messages.part_count(part) == elements
    assert messages.part_bytes(part) == f"2 * {number}"
    assert messages.part_bytes(part, is_limited=True) == f"2 * {number}.min(9)"
    assert messages.counter_value(part) == "bytes[0]"


@pytest.mark.parametrize(
    ("count", "value"),
    [
        ("Type", "text.len()"),
        ("{field: Type, plus: -4}", "(text.len() + 4)"),
        ("{field: Type, plus: 1}", "text.len().saturating_sub(1)"),
    ],
)
def test_the_counter_of_a_text_follows_from_its_length(tmp_path, count, value):
    part = part_of(tmp_path, count, "name: Words, type: text, size")
    assert messages.counted_text(part) == value


CURVES = """\
structs:
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 16, name: Points, type: uint, count: Inner, up_to: 3}
      - {at: 8, after: Points, bits: 16, name: Sum, type: uint}
"""


def test_elements_with_arrays_have_as_many_bytes_as_their_arrays(tmp_path):
    text = CURVES + status(
        "at: 0, bits: 8, name: Last, type: uint",
        "at: 8, bits: 8, name: Inner, type: uint",
        "at: 16, name: Curves, struct: Curve, count: {field: Last, plus: 1}, up_to: 2",
    )
    result = loaded(tmp_path, text)
    assert result.ok, [finding.message for finding in result.findings]
    part = describe(result.icd).nodes[0].messages[0].last_part
    assert messages.element_bytes(part) == "3 + 2 * number(self.inner, 0, 0).min(3)"
    # Parts of such elements are counted in elements.
    assert messages.part_bytes(part) == "number(self.last, 0, 1)"


def test_an_overlay_over_two_bytes_is_a_block_of_its_method(tmp_path):
    message = message_of(
        tmp_path,
        "at: 0, bits: 16, name: Word, type: uint",
        "at: 4, bits: 8, name: Middle, type: uint, view: true",
    )
    (overlay,) = message.overlays
    assert messages.overlay_value(overlay) == (
        "{\n"
        "            let mut value = bytes[0] >> 4;\n"
        "            value |= (bytes[1] & 0x0f) << 4;\n"
        "            value\n"
        "        }"
    )
