"""Generated Rust reads and writes each kind of field with exactly these expressions."""

from __future__ import annotations

import pytest

from icdgen.backends.rust.bits import check_range, read_expression, write_field
from icdgen.describe import describe
from tests.icd.files import loaded

ENUMS = """\
enums:
  - {name: Mode, members: [{value: 0, name: Idle}, {value: 3, name: Run}]}
  - {name: Cause, members: [{value: 0, name: None}, {value: 700, name: Heat}]}
structs:
  - name: Point
    length: 2
    fields:
      - {at: 0, bits: 4, name: X, type: uint}
      - {at: 4, bits: 1, name: Type, type: bool}
      - {at: 8, bits: 8, name: Height, type: int}
  - name: Line
    length: 5
    fields:
      - {at: 0, name: Start, struct: Point}
      - {at: 16, name: Ends, struct: Point, count: 1}
"""
LITTLE, BIG = "byte_order: little, bit_order: lsb0", "byte_order: big, bit_order: msb0"


def message_of(folder, fields, length, orders=LITTLE, more=""):
    """Return the description of a message with these fields."""
    rows = "".join(f"      - {{{field}}}\n" for field in fields)
    result = loaded(
        folder,
        f"icdgen: 1\nnode: {{name: demo, title: Demo, {orders}}}\n{ENUMS}"
        f"messages:\n  - name: Status\n    id: 0\n    kind: telemetry\n"
        f"    length: {length}\n{more}    fields:\n{rows}",
    )
    assert result.ok, [finding.message for finding in result.findings]
    return describe(result.icd).nodes[0].messages[0]


def member_of(folder, field, orders=LITTLE, length=9):
    """Return the last member of a message with two flags and this field."""
    flags = [
        "at: 70, bits: 1, name: Last Flag, type: bool",
        "at: 71, bits: 1, name: Other Flag, type: bool",
    ]
    return message_of(folder, [*flags, field], length, orders).members[-1]


# Field, expression that reads it, and statements that write it.
SCALARS = {
    LITTLE: [
        ("at: 0, bits: 8, type: uint", "bytes[0]", ["bytes[0] = self.a;"]),
        (
            "at: 8, bits: 8, type: int",
            "i8::from_le_bytes([bytes[1]])",
            ["put!(self.a.to_le_bytes() => bytes[1; 1]);"],
        ),
        (
            "at: 0, bits: 16, type: uint",
            "u16::from_le_bytes(take!(bytes[0; 2]))",
            ["put!(self.a.to_le_bytes() => bytes[0; 2]);"],
        ),
        (
            "at: 16, bits: 32, type: float",
            "f32::from_le_bytes(take!(bytes[2; 4]))",
            ["put!(self.a.to_le_bytes() => bytes[2; 4]);"],
        ),
        (
            "at: 0, bits: 64, type: int",
            "i64::from_le_bytes(take!(bytes[0; 8]))",
            ["put!(self.a.to_le_bytes() => bytes[0; 8]);"],
        ),
        (
            "at: 0, bits: 1, type: bool",
            "bytes[0] & 0x01 != 0",
            ["bytes[0] |= u8::from(self.a);"],
        ),
        (
            "at: 15, bits: 1, type: bool",
            "bytes[1] & 0x80 != 0",
            ["bytes[1] |= u8::from(self.a) << 7;"],
        ),
        (
            "at: 0, bits: 4, type: uint",
            "bytes[0] & 0x0f",
            ["bytes[0] |= self.a & 0x0f;"],
        ),
        ("at: 5, bits: 3, type: uint", "bytes[0] >> 5", ["bytes[0] |= self.a << 5;"]),
        (
            "at: 2, bits: 3, type: uint",
            "(bytes[0] >> 2) & 0x07",
            ["bytes[0] |= (self.a & 0x07) << 2;"],
        ),
        (
            "at: 0, bits: 4, type: int",
            "i8::from_le_bytes([(bytes[0] & 0x0f) << 4]) >> 4",
            [
                "let value = u8::from_le_bytes(self.a.to_le_bytes());",
                "bytes[0] |= value & 0x0f;",
            ],
        ),
        (
            "at: 4, bits: 8, type: int",
            "{\n"
            "                let mut value = bytes[0] >> 4;\n"
            "                value |= (bytes[1] & 0x0f) << 4;\n"
            "                i8::from_le_bytes([value])\n"
            "            }",
            [
                "let value = self.a;",
                "let value = u8::from_le_bytes(value.to_le_bytes());",
                "bytes[0] |= value << 4;",
                "bytes[1] |= (value >> 4) & 0x0f;",
            ],
        ),
        (
            "at: 8, bits: 12, type: uint",
            "{\n"
            "                let mut value = u16::from(bytes[1]);\n"
            "                value |= u16::from(bytes[2] & 0x0f) << 8;\n"
            "                value\n"
            "            }",
            [
                "let value = self.a;",
                "let value = value.to_le_bytes();",
                "bytes[1] = value[0];",
                "bytes[2] |= value[1] & 0x0f;",
            ],
        ),
        (
            "at: 4, bits: 12, type: int",
            "{\n"
            "                let mut value = u16::from(bytes[0] >> 4);\n"
            "                value |= u16::from(bytes[1]) << 4;\n"
            "                i16::from_le_bytes((value << 4).to_le_bytes()) >> 4\n"
            "            }",
            [
                "let value = self.a;",
                "let value = u16::from_le_bytes(value.to_le_bytes());",
                "bytes[0] |= value.to_le_bytes()[0] << 4;",
                "bytes[1] = (value >> 4).to_le_bytes()[0];",
            ],
        ),
        (
            "at: 0, bits: 8, type: enum, enum: Mode",
            "Coded::from_raw(bytes[0])",
            ["bytes[0] = self.a.raw();"],
        ),
        (
            "at: 8, bits: 2, type: enum, enum: Mode",
            "Coded::from_raw(bytes[1] & 0x03)",
            ["bytes[1] |= self.a.raw() & 0x03;"],
        ),
        (
            "at: 0, bits: 16, type: enum, enum: Cause",
            "Coded::from_raw(u16::from_le_bytes(take!(bytes[0; 2])))",
            ["let value = self.a.raw();", "put!(value.to_le_bytes() => bytes[0; 2]);"],
        ),
        (
            "at: 24, bits: 24, type: bytes",
            "array(bytes, 3)",
            ["put_array(&mut bytes, 3, &self.a);"],
        ),
        (
            "at: 1, bits: 32, type: float",
            "{\n"
            "                let mut value = u32::from(bytes[0] >> 1);\n"
            "                value |= u32::from(bytes[1]) << 7;\n"
            "                value |= u32::from(bytes[2]) << 15;\n"
            "                value |= u32::from(bytes[3]) << 23;\n"
            "                value |= u32::from(bytes[4] & 0x01) << 31;\n"
            "                f32::from_bits(value)\n"
            "            }",
            [
                "let value = self.a.to_bits();",
                "bytes[0] |= value.to_le_bytes()[0] << 1;",
                "bytes[1] = (value >> 7).to_le_bytes()[0];",
                "bytes[2] = (value >> 15).to_le_bytes()[0];",
                "bytes[3] = (value >> 23).to_le_bytes()[0];",
                "bytes[4] |= ((value >> 31).to_le_bytes()[0]) & 0x01;",
            ],
        ),
    ],
    BIG: [
        (
            "at: 8, bits: 16, type: int",
            "i16::from_be_bytes(take!(bytes[1; 2]))",
            ["put!(self.a.to_be_bytes() => bytes[1; 2]);"],
        ),
        (
            "at: 0, bits: 1, type: bool",
            "bytes[0] & 0x80 != 0",
            ["bytes[0] |= u8::from(self.a) << 7;"],
        ),
        (
            "at: 15, bits: 1, type: bool",
            "bytes[1] & 0x01 != 0",
            ["bytes[1] |= u8::from(self.a);"],
        ),
        ("at: 0, bits: 3, type: uint", "bytes[0] >> 5", ["bytes[0] |= self.a << 5;"]),
        (
            "at: 1, bits: 3, type: uint",
            "(bytes[0] >> 4) & 0x07",
            ["bytes[0] |= (self.a & 0x07) << 4;"],
        ),
        (
            "at: 4, bits: 4, type: uint, byte_order: little",
            "bytes[0] & 0x0f",
            ["bytes[0] |= self.a & 0x0f;"],
        ),
        (
            "at: 4, bits: 12, type: uint",
            "{\n"
            "                let mut value = u16::from(bytes[0] & 0x0f) << 8;\n"
            "                value |= u16::from(bytes[1]);\n"
            "                value\n"
            "            }",
            [
                "let value = self.a;",
                "let value = value.to_le_bytes();",
                "bytes[0] |= value[1] & 0x0f;",
                "bytes[1] = value[0];",
            ],
        ),
        (
            "at: 0, bits: 24, type: int",
            "{\n"
            "                let mut value = u32::from(bytes[0]) << 16;\n"
            "                value |= u32::from(bytes[1]) << 8;\n"
            "                value |= u32::from(bytes[2]);\n"
            "                i32::from_le_bytes((value << 8).to_le_bytes()) >> 8\n"
            "            }",
            [
                "let value = self.a;",
                "let value = u32::from_le_bytes(value.to_le_bytes());",
                "let value = value.to_le_bytes();",
                "bytes[0] = value[2];",
                "bytes[1] = value[1];",
                "bytes[2] = value[0];",
            ],
        ),
        (
            "at: 2, bits: 10, type: uint",
            "{\n"
            "                let mut value = u16::from(bytes[0] & 0x3f) << 4;\n"
            "                value |= u16::from(bytes[1] >> 4);\n"
            "                value\n"
            "            }",
            [
                "let value = self.a;",
                "bytes[0] |= ((value >> 4).to_le_bytes()[0]) & 0x3f;",
                "bytes[1] |= value.to_le_bytes()[0] << 4;",
            ],
        ),
    ],
}


@pytest.mark.parametrize(
    ("orders", "field", "reading", "writing"),
    [(orders, *row) for orders, rows in SCALARS.items() for row in rows],
)
def test_a_scalar_is_read_and_written_at_its_bits(
    tmp_path, orders, field, reading, writing
):
    member = member_of(tmp_path, f"{field}, name: A", orders)
    assert read_expression(member, set()) == reading
    assert write_field(member) == writing


# Array, expression that reads it, and statements that write it.
ARRAYS = [
    (
        "at: 0, bits: 8, type: uint, count: 3",
        "array(bytes, 0)",
        ["put_array(&mut bytes, 0, &self.a);"],
    ),
    (
        "at: 8, bits: 16, type: int, count: 2, byte_order: big",
        "words(bytes, 1, i16::from_be_bytes)",
        ["put_words(&mut bytes, 1, &self.a, i16::to_be_bytes);"],
    ),
    (
        "at: 0, bits: 32, type: float, count: 2",
        "words(bytes, 0, f32::from_le_bytes)",
        ["put_words(&mut bytes, 0, &self.a, f32::to_le_bytes);"],
    ),
    (
        "at: 0, bits: 8, type: int, count: 2",
        "words(bytes, 0, i8::from_le_bytes)",
        ["put_words(&mut bytes, 0, &self.a, i8::to_le_bytes);"],
    ),
    (
        "at: 8, bits: 16, type: bytes, count: 3",
        "arrays(bytes, 1)",
        ["put_words(&mut bytes, 1, &self.a, |octets| octets);"],
    ),
    (
        "at: 0, bits: 8, type: enum, enum: Mode, count: 2",
        "words(bytes, 0, |word| Coded::from_raw(u8::from_le_bytes(word)))",
        ["put_words(&mut bytes, 0, &self.a, |value| value.raw().to_le_bytes());"],
    ),
    (
        "at: 4, bits: 4, type: uint, count: 2",
        "[bytes[0] >> 4, bytes[1] & 0x0f]",
        ["bytes[0] |= self.a[0] << 4;", "bytes[1] |= self.a[1] & 0x0f;"],
    ),
    (
        "at: 4, bits: 4, type: uint, count: 5",
        "[\n"
        "                bytes[0] >> 4,\n"
        "                bytes[1] & 0x0f,\n"
        "                bytes[1] >> 4,\n"
        "                bytes[2] & 0x0f,\n"
        "                bytes[2] >> 4,\n"
        "            ]",
        [
            "bytes[0] |= self.a[0] << 4;",
            "bytes[1] |= self.a[1] & 0x0f;",
            "bytes[1] |= self.a[2] << 4;",
            "bytes[2] |= self.a[3] & 0x0f;",
            "bytes[2] |= self.a[4] << 4;",
        ],
    ),
    (
        "at: 0, bits: 12, type: uint, count: 4",
        "rounds(bytes, 0, Self::read_a)",
        ["put_rounds(&mut bytes, 0, &self.a, Self::write_a);"],
    ),
    (
        "at: 0, bits: 12, type: uint, count: 2",
        "[\n"
        "                {\n"
        "                    let mut value = u16::from(bytes[0]);\n"
        "                    value |= u16::from(bytes[1] & 0x0f) << 8;\n"
        "                    value\n"
        "                },\n"
        "                {\n"
        "                    let mut value = u16::from(bytes[1] >> 4);\n"
        "                    value |= u16::from(bytes[2]) << 4;\n"
        "                    value\n"
        "                },\n"
        "            ]",
        [
            "let value = self.a[0];",
            "let value = value.to_le_bytes();",
            "bytes[0] = value[0];",
            "bytes[1] |= value[1] & 0x0f;",
            "let value = self.a[1];",
            "bytes[1] |= value.to_le_bytes()[0] << 4;",
            "bytes[2] = (value >> 4).to_le_bytes()[0];",
        ],
    ),
    # Elements of 4 bits are read by two in a round, and there are two rounds.
    (
        "at: 8, bits: 4, type: uint, count: 4",
        "rounds(bytes, 1, Self::read_a)",
        ["put_rounds(&mut bytes, 1, &self.a, Self::write_a);"],
    ),
    (
        "at: 8, bits: 1, type: bool, count: 16",
        "rounds(bytes, 1, Self::read_a)",
        ["put_rounds(&mut bytes, 1, &self.a, Self::write_a);"],
    ),
    (
        "at: 8, struct: Point, count: 2",
        "each(bytes, 1, Self::read_a)",
        ["put_each(&mut bytes, 1, &self.a, Self::write_a);"],
    ),
]


@pytest.mark.parametrize(("field", "reading", "writing"), ARRAYS)
def test_an_array_is_copied_or_read_by_its_elements(tmp_path, field, reading, writing):
    member = member_of(tmp_path, f"{field}, name: A")
    assert read_expression(member, set()) == reading
    assert write_field(member) == writing


def test_a_struct_is_an_expression_of_its_members(tmp_path):
    line = member_of(tmp_path, "at: 8, name: Main, struct: Line")
    assert read_expression(line, set()) == (
        "super::Line {\n"
        "                start: super::Point {\n"
        "                    x: bytes[1] & 0x0f,\n"
        "                    r#type: bytes[1] & 0x10 != 0,\n"
        "                    height: i8::from_le_bytes([bytes[2]]),\n"
        "                },\n"
        "                ends: each(bytes, 3, Self::read_main_ends),\n"
        "            }"
    )
    start, ends = line.instances[0]
    assert [write_field(member) for member in start.instances[0]] == [
        ["bytes[1] |= self.main.start.x & 0x0f;"],
        ["bytes[1] |= u8::from(self.main.start.r#type) << 4;"],
        ["put!(self.main.start.height.to_le_bytes() => bytes[2; 1]);"],
    ]
    assert write_field(ends) == [
        "put_each(&mut bytes, 3, &self.main.ends, Self::write_main_ends);"
    ]
    # In a function for an element of an outer array, names start with that of the array.
    assert read_expression(ends, set(), within="lines_") == (
        "each(bytes, 3, Self::read_lines_main_ends)"
    )
    assert write_field(ends, "part", "lines_") == [
        "put_each(&mut bytes, 3, &part.main.ends, Self::write_lines_main_ends);"
    ]


def test_flags_are_read_from_the_table_of_their_byte(tmp_path):
    flags = [f"at: {8 + n}, bits: 1, name: Flag {n}, type: bool" for n in range(3)]
    members = message_of(tmp_path, flags, 2).members
    assert [read_expression(flag, {1}) for flag in members] == [
        "flags_1[0]",
        "flags_1[1]",
        "flags_1[2]",
    ]
    assert read_expression(members[2], {0}) == "bytes[1] & 0x04 != 0"


def test_a_narrow_field_of_an_enumeration_is_stored_like_a_wide_one(tmp_path):
    wide = "at: 0, bits: 16, name: Wide, type: enum, enum: Mode"
    for at, reading, writing in (
        (
            16,
            "Coded::from_raw(u16::from(bytes[2] & 0x0f))",
            [
                "let value = self.a.raw().to_le_bytes();",
                "bytes[2] |= value[0] & 0x0f;",
            ],
        ),
        (
            22,
            "{\n"
            "                let mut value = bytes[2] >> 6;\n"
            "                value |= (bytes[3] & 0x03) << 2;\n"
            "                Coded::from_raw(u16::from(value))\n"
            "            }",
            [
                "let value = self.a.raw();",
                "bytes[2] |= value.to_le_bytes()[0] << 6;",
                "bytes[3] |= ((value >> 2).to_le_bytes()[0]) & 0x03;",
            ],
        ),
    ):
        narrow = f"at: {at}, bits: 4, name: A, type: enum, enum: Mode"
        member = message_of(tmp_path, [wide, narrow], 3 + (at == 22)).members[-1]
        assert read_expression(member, set()) == reading
        assert write_field(member) == writing


def named(folder, length, field):
    """Return a field whose name has a number of letters."""
    return member_of(folder, f"name: {'a' * length}, {field}")


def test_a_call_that_is_too_long_has_a_line_for_each_argument(tmp_path):
    field, name = "at: 0, bits: 12, type: uint, count: 4", "a" * 28
    line = f"rounds(bytes, 0, Self::read_{name})"
    assert len(f"            {name}: {line},") == 100
    assert read_expression(named(tmp_path, 28, field), set()) == line
    assert read_expression(named(tmp_path, 29, field), set()) == (
        "rounds(\n"
        "                bytes,\n"
        "                0,\n"
        f"                Self::read_{name}a,\n"
        "            )"
    )
    line = f"put_rounds(&mut bytes, 0, &self.{name[:22]}, Self::write_{name[:22]});"
    assert len(f"        {line}") == 100
    assert write_field(named(tmp_path, 22, field)) == [line]
    assert write_field(named(tmp_path, 23, field)) == [
        "put_rounds(\n"
        "            &mut bytes,\n"
        "            0,\n"
        f"            &self.{name[:23]},\n"
        f"            Self::write_{name[:23]},\n"
        "        );"
    ]


def test_a_closure_that_is_too_long_has_a_block(tmp_path):
    field = "at: 0, bits: 8, type: enum, enum: Mode, count: 2"
    line = "words(bytes, 0, |word| Coded::from_raw(u8::from_le_bytes(word)))"
    longest = 100 - len(f"            : {line},")
    assert read_expression(named(tmp_path, longest, field), set()) == line
    assert read_expression(named(tmp_path, longest + 1, field), set()) == (
        "words(bytes, 0, |word| {\n"
        "                Coded::from_raw(u8::from_le_bytes(word))\n"
        "            })"
    )


@pytest.mark.parametrize(("at", "lines"), [(796, 1), (798, 5)])
def test_a_list_of_60_characters_is_one_line(tmp_path, at, lines):
    field = f"at: {at}, bits: 2, name: A, type: uint, count: 3"
    text = read_expression(member_of(tmp_path, field, length=101), set())
    assert (len(text) == 60) == (lines == 1)
    assert len(text.splitlines()) == lines


# Field, and statements that return an error if its raw value does not fit.
CHECKS = [
    ("at: 0, bits: 4, name: A, type: uint", ["A.fit(self.a)?;"]),
    ("at: 0, bits: 4, name: Type, type: int", ["TYPE.fit(self.r#type)?;"]),
    ("at: 0, bits: 2, name: A, type: enum, enum: Mode", ["A.fit(self.a.raw())?;"]),
    (
        "at: 0, bits: 12, name: A, type: uint, count: 3",
        ["for value in self.a {", "    A.fit(value)?;", "}"],
    ),
    (
        "at: 0, bits: 2, name: A, type: enum, enum: Mode, count: 3",
        ["for value in self.a {", "    A.fit(value.raw())?;", "}"],
    ),
    ("at: 0, name: A, struct: Point", ["self.a.fit()?;"]),
    (
        "at: 0, name: A, struct: Point, count: 2",
        ["for part in &self.a {", "    part.fit()?;", "}"],
    ),
]


@pytest.mark.parametrize(("field", "statements"), CHECKS)
def test_each_value_that_can_be_too_large_is_checked(tmp_path, field, statements):
    assert check_range(member_of(tmp_path, field)) == statements


@pytest.mark.parametrize(
    ("field", "statements"),
    [
        (
            "at: 8, bits: 24, name: A, type: uint, count: rest, up_to: 4",
            ["for value in self.a().iter().copied() {", "    A.fit(value)?;", "}"],
        ),
        (
            "at: 8, name: A, struct: Point, count: rest, up_to: 4",
            ["for part in self.a() {", "    part.fit()?;", "}"],
        ),
    ],
)
def test_only_elements_in_the_frame_are_checked(tmp_path, field, statements):
    (member,) = (
        member
        for member in message_of(
            tmp_path, ["at: 0, bits: 8, name: B, type: uint", field], 1
        ).members[1:]
        if not member.model.is_count
    )
    assert check_range(member) == statements


def test_the_count_of_elements_up_to_the_end_has_no_bits(tmp_path):
    field = "at: 8, bits: 16, name: A, type: uint, count: rest, up_to: 4"
    (count,) = (
        member
        for member in message_of(
            tmp_path, ["at: 0, bits: 8, name: B, type: uint", field], 1
        ).members
        if member.model.is_count
    )
    assert (read_expression(count, set()), write_field(count)) == ("0", [])


def test_an_optional_field_is_written_from_a_variable(tmp_path):
    field = "at: 0, bits: 12, name: A, type: uint, when: {Last Flag: 1}"
    member = member_of(tmp_path, field)
    assert write_field(member)[0] == "let value = raw;"
    assert check_range(member) == ["A.fit(raw)?;"]
