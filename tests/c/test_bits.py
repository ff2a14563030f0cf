"""Expressions that read and write fields in C agree with the reference codec, and every
operation in them has a defined result.
"""

from __future__ import annotations

import random

import pytest

from icdgen import codec
from icdgen.backends.c.bits import (
    bits_beyond_field,
    excess_type,
    field_term,
    read_field,
    store_word,
)
from icdgen.backends.c.decoding import decode_statements
from icdgen.backends.c.encoding import encode_statements
from icdgen.describe import MessageDescription, describe
from icdgen.describe.groups import grouped_fields
from icdgen.icd.places import NodePlace
from tests.c import harness, odd
from tests.c.statements import Members, evaluate, read, write
from tests.describe.small import message_of
from tests.limits import assert_limits


@pytest.fixture(scope="module")
def messages(tmp_path_factory) -> list[MessageDescription]:
    """Messages with random fields in all byte and bit orders."""
    icd = harness.read_unchecked(*odd.write(tmp_path_factory.mktemp("icd")))
    return [
        message
        for node in describe(icd).nodes
        for message in node.messages
        if message.members and message.name.startswith("odd")
    ]


def random_value(field: NodePlace, source: random.Random) -> int | bytes:
    if field.is_bytes:
        return source.randbytes(field.bits // 8)
    ends = [field.raw_min, field.raw_max, 0, -1 if field.is_signed else 1]
    return source.choice([*ends, source.randint(field.raw_min, field.raw_max)])


def types_of(message: MessageDescription) -> dict[str, tuple[int, bool]]:
    return {
        field.name: (field.storage.bits, field.storage.signed)
        for field in message.fields
        if not field.model.is_bytes
    }


def test_decode_reads_the_raw_values_of_the_reference_codec(messages):
    source = random.Random(1)
    assert len(messages) >= 32
    for message in messages:
        statements = decode_statements(message, list(grouped_fields(message)))
        for _ in range(4):
            frame = source.randbytes(message.model.length)
            expected = codec.decode(message.node, message.model, frame)
            assert read(statements, frame) == {
                field.name: expected[field.model.name] for field in message.fields
            }, message.name


def test_encode_writes_the_frame_of_the_reference_codec_byte_by_byte(messages):
    source = random.Random(2)
    for message in messages:
        statements = encode_statements(message, list(grouped_fields(message)))
        for _ in range(4):
            values = {
                field.model.name: random_value(field.model, source)
                for field in message.fields
            }
            members = {field.name: values[field.model.name] for field in message.fields}
            frame = write(statements, message.model.length, members, types_of(message))
            assert frame == codec.encode(message.node, message.model, values)


def test_bits_beyond_a_field_are_0_for_exactly_the_values_that_fit(messages):
    fields = [
        field for message in messages for field in message.fields if field.is_narrow
    ]
    assert len(fields) > 40
    for field in fields:
        types = field.storage
        expression = bits_beyond_field(field, field.name)

        def fits(value, field=field, expression=expression, types=types):
            if not types.min <= value <= types.max:
                return False
            member = Members({field.name: value}, {field.name: types})
            return int(evaluate(expression, message=member)) == 0

        assert_limits(fits, least=field.model.raw_min, most=field.model.raw_max)
        assert not types.signed or not fits(types.min)
        assert not fits(types.max)


@pytest.mark.parametrize(
    ("keys", "terms", "value"),
    [
        ("at: 8, bits: 8, type: uint", ["buffer[1]"], "{bits}"),
        ("at: 8, bits: 8, type: int", ["buffer[1]"], "icdgen_i8({bits})"),
        (
            "at: 8, bits: 16, type: int",
            ["icdgen_load_u16le(&buffer[1])"],
            "icdgen_i16({bits})",
        ),
        (
            "at: 0, bits: 64, type: uint, byte_order: big",
            ["icdgen_load_u64be(&buffer[0])"],
            "{bits}",
        ),
        ("at: 15, bits: 1, type: bool", ["buffer[1] & 0x80u"], "({bits}) != 0u"),
        ("at: 8, bits: 5, type: uint", ["buffer[1] & 0x1Fu"], "{bits}"),
        ("at: 10, bits: 5, type: uint", ["(buffer[1] >> 2) & 0x1Fu"], "{bits}"),
        (
            "at: 10, bits: 5, type: int",
            ["(buffer[1] >> 2) & 0x1Fu"],
            "ICDGEN_I8(icdgen_extend32({bits}, 0x10u))",
        ),
        (
            "at: 4, bits: 12, type: uint",
            [
                "ICDGEN_U32((buffer[0] >> 4) & 0x0Fu)",
                "ICDGEN_U32(buffer[1]) << 4",
            ],
            "ICDGEN_U16({bits})",
        ),
        (
            "at: 4, bits: 12, type: uint, byte_order: big",
            [
                "ICDGEN_U32(buffer[1])",
                "ICDGEN_U32((buffer[0] >> 4) & 0x0Fu) << 8",
            ],
            "ICDGEN_U16({bits})",
        ),
        (
            "at: 8, bits: 24, type: int",
            [
                "ICDGEN_U32(buffer[1])",
                "ICDGEN_U32(buffer[2]) << 8",
                "ICDGEN_U32(buffer[3]) << 16",
            ],
            "icdgen_extend32({bits}, 0x00800000u)",
        ),
        (
            "at: 4, bits: 16, type: int",
            [
                "ICDGEN_U32((buffer[0] >> 4) & 0x0Fu)",
                "ICDGEN_U32(buffer[1]) << 4",
                "ICDGEN_U32(buffer[2] & 0x0Fu) << 12",
            ],
            "icdgen_i16(ICDGEN_U16({bits}))",
        ),
        (
            "at: 4, bits: 32, type: float",
            [
                "ICDGEN_U32((buffer[0] >> 4) & 0x0Fu)",
                "ICDGEN_U32(buffer[1]) << 4",
                "ICDGEN_U32(buffer[2]) << 12",
                "ICDGEN_U32(buffer[3]) << 20",
                "ICDGEN_U32(buffer[4] & 0x0Fu) << 28",
            ],
            "{bits}",
        ),
    ],
)
def test_a_field_is_read_in_32_bits_without_an_undefined_shift(
    tmp_path, keys, terms, value
):
    (field,) = message_of(tmp_path, f"name: Value, {keys}", length=8).members
    read = read_field(field)
    assert (read.bits, list(read.terms), read.value) == (32, terms, value)
    assert read_field(field, "part").terms == tuple(
        term.replace("buffer", "part") for term in terms
    )


def test_a_field_of_more_than_32_bits_is_read_in_64(tmp_path):
    def is_narrow(bits):
        (field,) = message_of(
            tmp_path, f"name: Value, at: 1, bits: {bits}, type: int", length=8
        ).members
        read = read_field(field)
        prefix = f"ICDGEN_U{read.bits}("
        assert all(term.startswith(prefix) for term in read.terms)
        if bits == 33:
            assert read.value == (
                "icdgen_extend64({bits}, UINT64_C(0x0000000100000000))"
            )
        return read.bits == 32

    assert_limits(is_narrow, most=32)


@pytest.mark.parametrize(
    ("keys", "terms"),
    [
        # A `uint8_t` needs no conversion, and nothing is above its top bits.
        ("at: 8, bits: 5, type: uint", ["message->value"]),
        ("at: 10, bits: 5, type: uint", ["message->value << 2"]),
        ("at: 8, bits: 5, type: int", ["ICDGEN_U8(message->value) & 0x1F"]),
        ("at: 11, bits: 5, type: int", ["ICDGEN_U8(message->value) << 3"]),
        ("at: 15, bits: 1, type: bool", ["message->value << 7"]),
        (
            "at: 6, bits: 6, type: uint",
            ["message->value << 6", "message->value >> 2"],
        ),
        (
            "at: 4, bits: 10, type: uint, byte_order: big",
            ["ICDGEN_U8(message->value >> 6) << 4", "ICDGEN_U8(message->value) & 0x3F"],
        ),
        (
            "at: 4, bits: 10, type: int",
            [
                "ICDGEN_U8(message->value) << 4",
                "ICDGEN_U8(ICDGEN_U16(message->value) >> 4) & 0x3F",
            ],
        ),
        (
            "at: 4, bits: 32, type: float",
            [
                "ICDGEN_U8(icdgen_bits_f32(&message->value)) << 4",
                *(
                    f"ICDGEN_U8(icdgen_bits_f32(&message->value) >> {at})"
                    for at in (4, 12, 20, 28)
                ),
            ],
        ),
    ],
)
def test_each_byte_has_a_term_without_bits_of_other_fields(tmp_path, keys, terms):
    (field,) = message_of(tmp_path, f"name: Value, {keys}", length=8).members
    assert [field_term(field, piece) for piece in field.pieces] == terms


@pytest.mark.parametrize(
    ("keys", "statement"),
    [
        ("bits: 8, type: uint", "buffer[1] = message->value;"),
        ("bits: 8, type: int", "buffer[1] = ICDGEN_U8(message->value);"),
        (
            "bits: 16, type: uint",
            "icdgen_store_u16le(&buffer[1], message->value);",
        ),
        (
            "bits: 32, type: int, byte_order: big",
            "icdgen_store_u32be(&buffer[1], ICDGEN_U32(message->value));",
        ),
        (
            "bits: 64, type: float",
            "icdgen_store_u64le(&buffer[1], icdgen_bits_f64(&message->value));",
        ),
        # The type of an enumeration is that of its widest field.
        (
            "bits: 8, type: enum, enum: Mode",
            "buffer[1] = ICDGEN_U8(message->value);",
        ),
    ],
)
def test_a_word_is_stored_at_once(tmp_path, keys, statement):
    enum = "enums: [{name: Mode, members: [{value: 1, name: Idle}]}]\n"
    wide = "name: Wide, at: 80, bits: 16, type: enum, enum: Mode"
    used = [wide] * ("enum" in keys)
    field, *_ = message_of(
        tmp_path,
        f"name: Value, at: 8, {keys}",
        *used,
        length=12,
        head=enum if used else "",
    ).members
    assert store_word(field) == statement
    assert store_word(field, "part") == statement.replace("buffer", "part")


@pytest.mark.parametrize(
    ("keys", "expression"),
    [
        ("bits: 5, type: uint", "message->value & 0xE0u"),
        ("bits: 12, type: uint", "message->value & 0xF000u"),
        (
            "bits: 40, type: uint",
            "message->value & UINT64_C(0xFFFFFF0000000000)",
        ),
        (
            "bits: 5, type: int",
            "(ICDGEN_U32(message->value) + 0x00000010u) & 0xFFFFFFE0u",
        ),
        (
            "bits: 40, type: int",
            "(ICDGEN_U64(message->value) + UINT64_C(0x0000008000000000)) & "
            "UINT64_C(0xFFFFFF0000000000)",
        ),
        (
            "bits: 5, type: uint, when: {Kind: 1}",
            "demo_status_has_value(message) ? (message->value & 0xE0u) : 0u",
        ),
    ],
)
def test_bits_beyond_a_field_are_masked_in_its_type(tmp_path, keys, expression):
    kind = "name: Kind, at: 0, bits: 8, type: uint"
    _, field = message_of(
        tmp_path, kind, f"name: Value, at: 8, {keys}", length=8
    ).members
    assert bits_beyond_field(field, "value") == expression


def test_the_type_for_all_bits_beyond_is_that_of_the_widest_narrow_field(tmp_path):
    def is_32(bits):
        # A field of 64 bits has no bits beyond it.
        message = message_of(
            tmp_path,
            f"at: 0, name: Value, bits: {bits}, type: int",
            "at: 64, name: Whole, bits: 64, type: uint",
            length=16,
        )
        assert excess_type(message) == f"uint{32 if bits < 33 else 64}_t"
        return excess_type(message) == "uint32_t"

    assert_limits(is_32, most=32)
