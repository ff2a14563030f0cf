"""`decode_many` and `decode_table` give the same values as decoding frame by frame.

The tests compare the columns with `from_bytes` for each frame, and check their types.
"""

from __future__ import annotations

import json
import struct
import subprocess
import sys

import numpy
import pytest

from icdgen.icd.places import raw_fields_in
from tests.python.reference import cases, frames, raw

WIDTHS = {"bool": "?", "uint": "u", "enum": "u", "int": "i", "float": "f"}


@pytest.mark.parametrize("physical", [False, True])
def test_columns_have_the_values_of_single_frames(package, physical):
    for case in cases(package):
        if not case.message.length:
            continue
        many = list(frames(case.message.length))[:200]
        columns = case.cls.decode_many(b"".join(many), physical=physical)
        rows = [case.cls.from_bytes(frame).as_dict(physical) for frame in many]
        assert list(columns) == list(rows[0]) if rows[0] else not columns
        for info, (name, column) in zip(
            (*case.cls.FIELDS, *case.cls.VIEWS), columns.items(), strict=True
        ):
            is_raw = info.type == "bytes" or (info.type == "text" and not physical)
            values = [bytes(row) for row in column] if is_raw else column.tolist()
            if info.curve and physical:
                assert _bits(column.tolist()) == _bits([row[name] for row in rows]), (
                    case.message.name,
                    name,
                )
            elif info.type == "float":
                bits = column.copy().view(f"u{info.bits // 8}").tolist()
                assert bits == [raw(package, info, row[name]) for row in rows], (
                    case.message.name,
                    name,
                )
            else:
                assert values == [row[name] for row in rows], (case.message.name, name)


def _bits(values: list) -> list[bytes]:
    """Return the bytes of all doubles, so that NaN and -0.0 compare exactly."""
    packed = []
    for value in values:
        elements = value if hasattr(value, "__len__") else (value,)
        packed += [struct.pack("<d", element) for element in elements]
    return packed


def test_columns_have_the_smallest_native_type(package):
    for case in cases(package):
        if not case.message.length:
            continue
        columns = case.cls.decode_many(bytes(3 * case.message.length))
        for info in case.cls.FIELDS:
            kind = columns[info.attribute].dtype
            assert kind.isnative
            if info.type in ("bytes", "text"):
                assert columns[info.attribute].shape == (3, info.bits // 8)
                continue
            size = (
                1
                if info.type == "bool"
                else next(size for size in (8, 16, 32, 64) if size >= info.bits) // 8
            )
            letter = "i" if info.signed else WIDTHS[info.type]
            assert kind == numpy.dtype(
                f"{letter}{'' if info.type == 'bool' else size}"
            ), info


@pytest.fixture(scope="module")
def angles(shipped):
    return shipped.module("cubeacp").EstimatedAttitudeAngles


def test_no_frames_give_empty_columns(angles):
    assert [len(column) for column in angles.decode_many(b"").values()] == [0, 0, 0]


def test_an_incomplete_frame_is_refused(shipped, angles):
    with pytest.raises(shipped.module().LengthError) as caught:
        angles.decode_many(bytes(13))
    assert (caught.value.expected, caught.value.actual) == (18, 13)


def test_messages_without_bytes_have_no_columns(odd):
    empty = odd.module("odd").TELECOMMANDS[1]
    assert empty.decode_many(b"") == {}
    with pytest.raises(odd.module().LengthError):
        empty.decode_many(b"x")


def test_columns_do_not_change_with_the_buffer(angles):
    buffer = bytearray(struct.pack("<3h", 1, 2, 3))
    columns = angles.decode_many(buffer)
    buffer[:] = bytes(6)
    assert columns["estimated_roll_angle"].tolist() == [1]


def test_columns_are_decoded_from_any_buffer(angles):
    frame = struct.pack("<3h", 1, 2, 3)
    array = numpy.frombuffer(frame * 2, dtype="<i2")
    for buffer in (
        memoryview(frame * 2),
        bytearray(frame * 2),
        memoryview(array),
        memoryview(b"".join(bytes([b, 0]) for b in frame * 2))[::2],
    ):
        assert angles.decode_many(buffer)["estimated_yaw_angle"].tolist() == [3, 3]


def test_tables_carry_units_and_names(shipped):
    acp = shipped.module("cubeacp")
    table = acp.EstimatedAttitudeAngles.decode_table(
        struct.pack("<6h", 1, 2, 3, -4, -5, -6)
    )
    assert table.column_names == [
        "estimated_roll_angle_deg",
        "estimated_pitch_angle_deg",
        "estimated_yaw_angle_deg",
    ]
    assert table["estimated_roll_angle_deg"].to_pylist() == [0.01, -0.04]
    assert table.schema.field(0).metadata == {
        b"name": b"Estimated Roll Angle",
        b"unit": b"deg",
    }
    assert table.schema.metadata[b"node"] == b"cubeacp"
    assert table.schema.metadata[b"message"] == b"Estimated Attitude Angles"
    assert json.loads(table.schema.metadata[b"ids"]) == [146]
    raw_table = acp.EstimatedAttitudeAngles.decode_table(
        struct.pack("<3h", 1, 2, 3), physical=False
    )
    assert raw_table["estimated_roll_angle"].to_pylist() == [1]
    state = acp.CurrentAdcsState.decode_table(bytes(12))
    values = json.loads(state.schema.field("control_mode").metadata[b"values"])
    assert values["0"] == acp.ConModeSelect(0).label


def test_tables_store_every_type(package):
    for case in cases(package):
        if not raw_fields_in(case.message.layout):
            continue
        many = list(frames(case.message.length))[-20:]
        table = case.cls.decode_table(b"".join(many), physical=False)
        for info in case.cls.FIELDS:
            if info.type != "float":
                expected = [
                    getattr(case.cls.from_bytes(frame), info.attribute)
                    for frame in many
                ]
                assert table[info.attribute].to_pylist() == expected, (
                    case.message.name,
                    info.name,
                )


def test_the_error_names_numpy_if_it_is_not_installed(shipped):
    code = (
        "import sys; sys.modules['numpy'] = None; from icdgen_messages.cubeacp import EstimatedAttitudeAngles as angles\n"
        "try: angles.decode_many(bytes(6))\nexcept ImportError as error: print(error.name)"
    )
    done = subprocess.run(
        [sys.executable, "-B", "-c", code],
        cwd=shipped.folder,
        capture_output=True,
        text=True,
    )
    assert done.stdout.strip() == "numpy", done.stderr
