"""Generated classes decode and encode integers of every width at every bit position.

The tests compare them with the reference codec, and check types and attributes of all
messages. `tests/conformance` does this for shipped and odd ICDs in all languages.
"""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.icd.places import raw_fields_in
from tests.python.reference import cases, frames, raw

TYPES = {
    "bool": bool,
    "uint": int,
    "int": int,
    "float": float,
    "bytes": bytes,
    "text": bytes,
}


def test_every_frame_decodes_to_the_reference_values_and_back(ordered):
    for node, message, cls in cases(ordered):
        infos = {info.name: info for info in (*cls.FIELDS, *cls.VIEWS)}
        for frame in frames(message.length):
            expected = codec.decode(node, message, frame)
            decoded = cls.from_bytes(frame)
            values = {
                name: raw(ordered, info, getattr(decoded, info.attribute))
                for name, info in infos.items()
            }
            assert values == expected, (message.name, frame.hex())
            assert decoded.to_bytes() == codec.encode(node, message, expected), (
                message.name,
                frame.hex(),
            )


def test_values_have_the_annotated_type(package):
    for case in cases(package):
        decoded = case.cls.from_bytes(b"\xa5" * case.message.length)
        for info in case.cls.FIELDS:
            assert type(getattr(decoded, info.attribute)) is (
                info.enum or TYPES[info.type]
            ), (
                case.message.name,
                info.name,
            )


def test_any_buffer_decodes(package):
    for case in cases(package):
        frame = bytes(range(256)) * 3
        frame = frame[: case.message.length]
        for buffer in (
            bytearray(frame),
            memoryview(frame),
            memoryview(bytearray(b"x" + frame))[1:],
        ):
            assert (
                case.cls.from_bytes(buffer).to_bytes()
                == case.cls.from_bytes(frame).to_bytes()
            )


def test_the_error_about_an_invalid_raw_value_names_the_field(odd):
    range_error = odd.module().RangeError
    for case in cases(odd):
        for field in raw_fields_in(case.message.layout):
            attribute = case.infos[field.name].attribute
            for value in invalid_values(field):
                message = case.cls()
                setattr(message, attribute, value)
                with pytest.raises(range_error) as caught:
                    message.to_bytes()
                assert caught.value.field == attribute, (case.message.name, value)
                assert attribute in str(caught.value)


def invalid_values(field) -> list[object]:
    """Raw values that are out of range for a field, or of a wrong type."""
    if field.type == "float":
        return [
            None,
            "1",
            b"1",
            10**400,
            *([3.5e38, -1e39] if field.bits == 32 else []),
        ]
    if field.is_bytes:
        return [
            b"",
            bytes(field.bits // 8 - 1),
            bytes(field.bits // 8 + 1),
            "x" * (field.bits // 8),
            None,
            5,
        ]
    return [
        field.raw_min - 1,
        field.raw_max + 1,
        1 << 64,
        -(1 << 63) - 1,
        10**30,
        -1.5,
        0.5,
        "1",
        None,
        b"\x01",
        [],
    ]


def test_classes_have_the_properties_of_the_icd(package):
    for node, message, cls in cases(package):
        assert (node.name, message.name, message.kind, message.length) == (
            cls.NODE,
            cls.NAME,
            cls.KIND,
            cls.LENGTH,
        )
        assert (message.table, message.acknowledge, message.ids) == (
            cls.TABLE,
            cls.ACKNOWLEDGED,
            cls.IDS,
        )
        if message.kind == "configuration":
            assert (message.set_id, message.get_id) == (cls.SET_ID, cls.GET_ID)
        else:
            assert message.id == cls.ID
        for field, info in zip(raw_fields_in(message.layout), cls.FIELDS, strict=True):
            assert (info.name, info.at, info.bits, info.type) == (
                field.name,
                field.at,
                field.bits,
                field.type,
            )
            assert info.unit == (field.unit.symbol if field.unit else "")
            assert info.const == field.const
            assert info.special == tuple((s.value, s.meaning) for s in field.special)
            assert bool(info.physical) == (field.has_formula or field.type == "text")
