"""Examples in the comments of generated code compile: the value is a number and no
struct.
"""

from __future__ import annotations

import pytest

from icdgen import codec
from icdgen.describe import describe
from icdgen.describe.examples import Example, example_of_message
from tests.conformance.icds import read_unchecked
from tests.conftest import ROOT
from tests.icd.files import loaded, status

PARTS = """\
enums: [{name: Mode, members: [{value: 1, name: Idle}, {value: 5, name: Run}]}]
structs: [{name: Cell, length: 1, fields: [{at: 0, bits: 8, name: Kind, type: uint, const: 7}]}]
"""
WORD = "at: 0, bits: 16, name: Level, type: uint"
BYTE = WORD.replace("16", "8")


def example(folder, *fields: str, length: int = 9) -> Example:
    """Return the example of a message with these fields."""
    icd = loaded(folder, PARTS + status(*fields, length=length)).icd
    ((message,),) = (node.messages for node in describe(icd).nodes)
    return example_of_message(message)


@pytest.mark.parametrize(
    "path",
    ["examples/devices/p31u", "examples/devices/ublox", "tests/conformance/odd_icds"],
)
def test_the_value_of_an_example_is_a_number_in_its_frame(path):
    icd = read_unchecked(ROOT / path)
    shown = [
        (message, example_of_message(message))
        for node in describe(icd).nodes
        for message in node.messages
        if message.fields
    ]
    for message, field_example in shown:
        if field_example.shown is not None:
            field = field_example.shown.field
            assert field.struct is None and not field.count, (
                f"{message.name}: {field.name}"
            )
            if field_example.shown.raw and field.model.type != "float":
                assert any(field_example.frame), (
                    f"{message.name}: the frame does not hold {field.name}"
                )


@pytest.mark.parametrize(
    "path", ["icd", "examples/devices/ublox", "tests/conformance/odd_icds"]
)
def test_the_frame_of_an_example_is_that_of_a_new_message_with_its_value(path):
    for node in describe(read_unchecked(ROOT / path)).nodes:
        for message in node.messages:
            field_example = example_of_message(message)
            values = codec.initial_values(message.node, message.model)
            if (shown := field_example.shown) is not None:
                values[shown.field.model.name] = shown.raw
            frame = codec.encode(message.node, message.model, values)
            assert field_example.frame == frame, message.name


@pytest.mark.parametrize(
    ("fields", "name", "raw", "physical"),
    [
        ([WORD], "Level", 1234, None),
        ([BYTE], "Level", 123, None),
        ([BYTE.replace("8", "4")], "Level", 12, None),
        ([BYTE.replace("8", "3")], "Level", 1, None),
        ([WORD + ", max: 1234"], "Level", 1234, None),
        ([WORD + ", max: 1233"], "Level", 123, None),
        # The limits of a field with a formula are physical values.
        ([WORD + ", formula: raw*0.5, max: 617"], "Level", 1234, 617.0),
        ([WORD + ", formula: raw*0.5, below: 617"], "Level", 123, 61.5),
        ([WORD + ", formula: raw*10, max: 1229"], "Level", 12, 120.0),
        ([WORD + ", formula: raw*10, min: 12340"], "Level", 1234, 12340.0),
        ([WORD + ", formula: raw*10, max: 0"], "Level", 0, 0.0),
        (["at: 0, bits: 1, name: Flag, type: bool"], "Flag", 1, None),
        (["at: 0, bits: 8, name: Mode, type: enum, enum: Mode"], "Mode", 5, None),
        (["at: 0, bits: 32, name: Gain, type: float"], "Gain", 0x3FC00000, None),
        (
            ["at: 0, bits: 32, name: Gain, type: float, formula: raw*2"],
            "Gain",
            0x3FC00000,
            3.0,
        ),
        (
            [BYTE, "at: 8, bits: 16, name: Scaled, type: int, formula: raw*0.5"],
            "Scaled",
            1234,
            617.0,
        ),
        (
            ["at: 8, bits: 8, name: Kind, type: uint, const: 3", BYTE],
            "Level",
            123,
            None,
        ),
    ],
)
def test_the_value_of_an_example_is_valid_for_the_first_suitable_field(
    tmp_path, fields, name, raw, physical
):
    shown = example(tmp_path, *fields).shown
    assert shown is not None
    assert (shown.field.model.name, shown.raw, shown.physical) == (name, raw, physical)


@pytest.mark.parametrize(
    "fields",
    [
        [],
        [WORD + ", formula: raw*10, above: 12340"],
        [WORD + ", formula: raw*10, min: 50, max: 100"],
        ["at: 0, bits: 32, name: Gain, type: float, max: 2"],
        ["at: 0, bits: 8, name: Data, type: bytes"],
        [WORD + ", count: 2"],
        [BYTE + ", when: {Has: 1}", "at: 8, bits: 1, name: Has, type: bool"],
    ],
)
def test_an_example_without_a_suitable_field_shows_no_value(tmp_path, fields):
    assert example(tmp_path, *fields).shown is None


def test_the_counter_of_an_array_without_elements_stays_0_in_an_example(tmp_path):
    items = "at: 8, bits: 8, name: Items, type: uint, count: Level, up_to: 8"
    shown = example(tmp_path, BYTE, items, length=1)
    assert (shown.shown, shown.frame) == (None, b"\0")


def test_an_example_has_all_constants_and_briefly_at_most_eight_of_arrays(tmp_path):
    cells = "at: 0, name: Cells, struct: Cell, count: %d"
    few, many = example(tmp_path, cells % 8), example(tmp_path, cells % 9)
    assert few.brief == few.frame == b"\7" * 8 + b"\0"
    assert list(few.runs) == [(0, b"\7" * 8)]
    assert (many.frame, many.brief, list(many.runs)) == (b"\7" * 9, bytes(9), [])


def test_the_runs_of_an_example_are_its_bytes_other_than_0(tmp_path):
    constants = (
        f"at: {8 * at}, bits: 8, name: Kind {at}, type: uint, const: {at + 1}"
        for at in (0, 1, 4, 8)
    )
    assert list(example(tmp_path, *constants).runs) == [
        (0, b"\1\2"),
        (4, b"\5"),
        (8, b"\x09"),
    ]
