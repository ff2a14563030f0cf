"""Array fields are tuples of raw and physical values, in errors, JSON and columns.

`tests/every_language/arrays.py` tests what all languages have in common.
"""

from __future__ import annotations

import math

import pytest

from tests.python import packages

ICD = """\
icdgen: 1
node: {name: arrays, title: Arrays, byte_order: little, bit_order: lsb0}
enums:
  - name: Mode
    members:
      - {value: 0, name: Idle}
      - {value: 1, name: Active}
messages:
  - name: Everything
    id: 1
    kind: telemetry
    length: 43
    fields:
      - {at: 0, bits: 16, count: 3, name: Temperatures, type: int, unit: C, formula: raw*0.01}
      - {at: 48, bits: 12, count: 2, name: Levels, type: uint, byte_order: big, bit_order: msb0, formula: raw/4}
      - {at: 72, bits: 1, count: 8, name: Flags, type: bool}
      - {at: 80, bits: 2, count: 4, name: Modes, type: enum, enum: Mode}
      - {at: 88, bits: 32, count: 2, name: Floats, type: float}
      - {at: 152, bits: 64, count: 2, name: Doubles, type: float, byte_order: big}
      - {at: 280, bits: 8, count: 8, name: Octets, type: uint}
"""


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("arrays")
    (folder / "arrays.yaml").write_text(ICD, encoding="utf-8")
    return packages.write(
        packages.read(folder / "arrays.yaml"), folder, "array_messages"
    )


@pytest.fixture(scope="module")
def everything(package):
    return package.module("arrays").Everything


def test_physical_values_of_an_array_are_read_and_set_together(everything):
    message = everything(temperatures=(1, -2, 32767))
    assert message.temperatures_c == (0.01, -0.02, 327.67)
    message.temperatures_c = [1, 2.5, -3]
    message.levels_physical = (1023.75, 0.25)
    assert (message.temperatures, message.levels) == ((100, 250, -300), (4095, 1))
    assert everything.from_physical(temperatures_c=(1, 2, 3)).temperatures == (
        100,
        200,
        300,
    )
    assert everything().as_dict(physical=True)["temperatures_c"] == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("attribute", "value", "message_text"),
    [
        ("temperatures", (1, 2), "temperatures takes 3 values, not (1, 2)"),
        ("temperatures", 7, "temperatures takes 3 values, not 7"),
        (
            "temperatures",
            (1, 2, 40000),
            "temperatures[2] takes integers from -32768 to 32767, not 40000",
        ),
        ("levels", (1, 4096), "levels[1] takes integers from 0 to 4095, not 4096"),
        ("levels", (1, 2, 3), "levels takes 2 values, not (1, 2, 3)"),
        ("flags", (True,) * 7, "flags takes 8 values"),
        (
            "modes",
            (0, 1, 2, 4),
            "modes[3] takes members of Mode or integers from 0 to 3, not 4",
        ),
        ("floats", (1e39, 0.0), "floats[0] takes 32-bit floats, not 1e+39"),
        (
            "octets",
            [1, 2, 3, 4, 5, 6, 7, -1],
            "octets[7] takes integers from 0 to 255, not -1",
        ),
    ],
)
def test_an_array_value_out_of_range_is_refused_and_the_element_is_named(
    package, everything, attribute, value, message_text
):
    message = everything()
    setattr(message, attribute, value)
    with pytest.raises(package.module().RangeError) as caught:
        message.to_bytes()
    assert message_text in str(caught.value)


def test_nans_in_arrays_keep_their_bits(everything):
    frame = bytearray(43)
    frame[11:19] = bytes.fromhex("0100807f3c5aa5ff")
    frame[19:27] = bytes.fromhex("7ff0000000000001")
    message = everything.from_bytes(bytes(frame))
    assert all(map(math.isnan, (*message.floats, message.doubles[0])))
    assert message.to_bytes() == bytes(frame)


def test_an_array_survives_a_round_trip_through_json(everything):
    message = everything.from_bytes(bytes(11) + bytes(24) + bytes(range(8)))
    assert everything.from_json(message.to_json()) == message


def test_arrays_are_columns_of_two_dimensions_and_lists_in_tables(everything):
    frames = [
        bytes((7 * number + index) % 128 for index in range(43)) for number in range(5)
    ]
    messages = [everything.from_bytes(frame) for frame in frames]
    columns = everything.decode_many(b"".join(frames))
    for name in (
        "temperatures",
        "levels",
        "flags",
        "modes",
        "floats",
        "doubles",
        "octets",
    ):
        assert columns[name].shape == (5, len(getattr(messages[0], name)))
        assert [tuple(row) for row in columns[name].tolist()] == [
            getattr(message, name) for message in messages
        ]
    table = everything.decode_table(b"".join(frames))
    assert (
        str(table.schema.field("temperatures_c").type)
        == "fixed_size_list<item: double>[3]"
    )
    assert [tuple(row) for row in table["temperatures_c"].to_pylist()] == [
        message.temperatures_c for message in messages
    ]


def test_field_information_of_an_array_has_one_part_for_each_element(everything):
    info = everything.FIELDS[0]
    assert (info.attribute, info.at, info.bits, info.elements) == (
        "temperatures",
        0,
        16,
        3,
    )
    assert [(part.attribute, part.at) for part in info.parts] == [
        ("temperatures[0]", 0),
        ("temperatures[1]", 16),
        ("temperatures[2]", 32),
    ]
