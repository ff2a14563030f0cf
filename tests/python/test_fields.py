"""Declarations of fields in generated Python: type, place, default and limits."""

from __future__ import annotations

from fractions import Fraction
from itertools import count

import pytest

from icdgen.backends.python.fields import (
    accessors,
    annotation,
    constant_value,
    declaration,
    getter,
    inner,
    nested,
    number_literal,
    open_part,
    physical,
    view_info,
)
from tests.describe.small import message_of, node_of
from tests.icd.files import status
from tests.limits import assert_limits

HEAD = """\
enums:
  - name: Mode
    members:
      - {value: 0, name: Idle}
      - {value: 3, name: Run}
structs:
  - name: Point
    length: 3
    fields:
      - {at: 0, bits: 8, name: X, type: uint}
      - {at: 8, bits: 16, name: "Y", type: int}
"""


def message(folder, *fields, length=8):
    return message_of(folder, *fields, length=length, head=HEAD)


def declared(folder, keys, first=()):
    at = 8 * len(first)
    members = message(
        folder, *first, f"at: {at}, name: 'Say \"A\"', {keys}", length=24
    ).members
    line = declaration(members[-1])
    name, _, text = line.partition(": ")
    assert name == "say_a"
    return text


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ("bits: 8, type: uint", 'int = _base.field(NAME, 0, 8, "uint", default=0)'),
        ("bits: 5, type: int", 'int = _base.field(NAME, 0, 5, "int", default=0)'),
        (
            "bits: 1, type: bool",
            'bool = _base.field(NAME, 0, 1, "bool", default=False)',
        ),
        (
            "bits: 1, type: bool, const: 1",
            'bool = _base.field(NAME, 0, 1, "bool", default=True, const=1)',
        ),
        (
            "bits: 32, type: float",
            'float = _base.field(NAME, 0, 32, "float", default=0.0)',
        ),
        (
            "bits: 56, type: bytes",
            'bytes = _base.field(NAME, 0, 56, "bytes", default=bytes(7))',
        ),
        (
            "bits: 24, type: text",
            'bytes = _base.field(NAME, 0, 24, "text", default=bytes(3))',
        ),
        (
            "bits: 8, type: enum, enum: Mode",
            'Mode = _base.field(NAME, 0, 8, "enum", default=Mode.IDLE)',
        ),
        (
            "bits: 8, type: enum, enum: Mode, const: 3",
            'Mode = _base.field(NAME, 0, 8, "enum", default=Mode.RUN, const=3)',
        ),
        (
            "bits: 8, type: uint, const: 255",
            'int = _base.field(NAME, 0, 8, "uint", default=255, const=255)',
        ),
        (
            "bits: 8, type: uint, count: 3, const: 7",
            'tuple[int, ...] = _base.field(NAME, 0, 8, "uint", default=(7,) * 3, '
            "elements=3, const=7)",
        ),
        ("struct: Point", "Point = _base.part(NAME, 0, 24, factory=Point)"),
        (
            "struct: Point, count: 2",
            "tuple[Point, ...] = _base.part(NAME, 0, 24, factory=Point, elements=2)",
        ),
        (
            "bits: 16, type: uint, unit: m/s, byte_order: big, bit_order: msb0",
            'int = _base.field(NAME, 0, 16, "uint", default=0, unit="m/s", '
            'byte_order="big", bit_order="msb0")',
        ),
        (
            "bits: 8, type: uint, min: 1, max: 9, special: "
            "[{value: 255, meaning: 'no \"A\"'}]",
            'int = _base.field(NAME, 0, 8, "uint", default=0, '
            "special=(\n        (255, 'no \"A\"'),\n        ), minimum=1, maximum=9)",
        ),
        (
            "bits: 8, type: uint, formula: raw*0.5, above: 0.5, below: 9",
            'int = _base.field(NAME, 0, 8, "uint", default=0, above=0.5, below=9)',
        ),
    ],
)
def test_a_field_has_its_place_and_its_default(tmp_path, keys, text):
    got = " ".join(declared(tmp_path, keys).split())
    assert got.replace("( ", "(").replace(", )", ")") == " ".join(
        text.replace("NAME", "'Say \"A\"'").split()
    ).replace("( ", "(").replace(", )", ")")


def test_each_special_value_has_a_line(tmp_path):
    special = "special: [{value: 255, meaning: none}, {value: 254, meaning: busy}]"
    assert declared(tmp_path, f"bits: 8, type: uint, {special}").splitlines() == [
        "int = _base.field(",
        "        'Say \"A\"',",
        "        0,",
        "        8,",
        '        "uint",',
        "        default=0,",
        "        special=(",
        '            (255, "none"),',
        '            (254, "busy"),',
        "        ),",
        "    )",
    ]


def test_an_optional_field_has_the_values_of_its_conditions(tmp_path):
    first = (
        "at: 0, bits: 8, name: Kind, type: uint",
        "at: 8, bits: 8, name: Mode, type: enum, enum: Mode",
    )
    text = declared(
        tmp_path, "bits: 8, type: uint, when: {Kind: [9, 4], Mode: 3}", first
    )
    assert text == (
        '_lazy.Optional[int] = _base.field(\n        \'Say "A"\', 16, 8, "uint", '
        'default=0, when=(("kind", (4, 9,)), ("mode", (3,)),)\n    )'
    )


@pytest.mark.parametrize(
    ("keys", "plus", "text"),
    [
        (
            "type: uint, bits: 16",
            0,
            'tuple[int, ...] = _base.field("Data", 8, 16, "uint", default=(), '
            "elements=5, is_open=True)",
        ),
        (
            "type: uint, bits: 16, const: 3",
            2,
            'tuple[int, ...] = _base.field("Data", 8, 16, "uint", default=(3,) * 2, '
            "elements=5, is_open=True, fewest=2, const=3)",
        ),
        (
            "type: enum, enum: Mode, bits: 16",
            0,
            'tuple[Mode, ...] = _base.field("Data", 8, 16, "enum", default=(), '
            "elements=5, is_open=True, enum=Mode)",
        ),
        (
            "type: bytes",
            0,
            'bytes = _base.field("Data", 8, 40, "bytes", default=b"", is_open=True)',
        ),
        (
            "type: bytes",
            2,
            'bytes = _base.field("Data", 8, 40, "bytes", default=bytes(2), '
            "is_open=True, fewest=2)",
        ),
    ],
)
def test_a_part_of_variable_length_begins_with_the_fewest_elements(
    tmp_path, keys, plus, text
):
    size = "size" if "bytes" in keys else "count"
    data = message(
        tmp_path,
        "at: 0, bits: 8, name: Number, type: uint",
        f"at: 8, name: Data, {keys}, {size}: {{field: Number, plus: {plus}}}, up_to: 5",
        length=1,
    ).members[-1]
    line = declaration(data).replace("(\n        ", "(").replace("\n    )", ")")
    assert line == f"data: {text}"


def test_a_declaration_is_broken_at_120_columns_and_its_items_at_8_more(tmp_path):
    places = count()

    def text(length):
        folder = tmp_path / str(next(places))
        folder.mkdir()
        line = declaration(
            message(
                folder, f"at: 0, bits: 8, name: {'N' * length}, type: uint"
            ).members[0]
        )
        assert "".join(line.split()) == (
            f'{"n" * length}:int=_base.field("{"N" * length}",0,8,"uint",default=0)'
        ) or line.endswith(",\n    )")
        return line

    # name and text of the name; 4 columns of indentation
    fixed = len(': int = _base.field("", 0, 8, "uint", default=0)') + 4
    assert_limits(lambda length: "\n" not in text(length), most=(120 - fixed) // 2)
    items = len('"", 0, 8, "uint", default=0') + 8
    assert_limits(lambda length: text(length).count("\n") < 3, most=120 - items)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        (
            "bits: 16, type: int, formula: raw*0.5 - 3, unit: V",
            [
                "say_a_v: float = _base.scaled(1, -6, 2, default=-3.0)",
                "say_a_mv: int = _base.whole(500, -3000)",
            ],
        ),
        (
            "bits: 16, type: int, formula: raw*0.001, unit: V, count: 3",
            [
                "say_a_v: tuple[float, ...] = _base.scaled(1, 0, 1000, "
                "default=(0.0,) * 3)",
                "say_a_mv: tuple[int, ...] = _base.whole(1, 0)",
            ],
        ),
        (
            "bits: 16, type: text",
            ['say_a_text: str = _base.text(default="")'],
        ),
        (
            "bits: 16, type: text, count: 2",
            ['say_a_text: tuple[str, ...] = _base.text(default=("",) * 2)'],
        ),
        ("bits: 16, type: uint", []),
    ],
)
def test_a_physical_value_has_its_scale_and_the_value_of_a_new_message(
    tmp_path, keys, expected
):
    field = message(tmp_path, f"at: 0, name: 'Say \"A\"', {keys}", length=6).members[0]
    texts = [text for text, _ in accessors(field)]
    assert texts == expected
    comments = [comment for _, comment in accessors(field)]
    if "text" in keys:
        assert all(
            each.endswith("An invalid byte reads as U+FFFD.") for each in comments
        )


def test_the_physical_value_of_an_optional_field_is_optional(tmp_path):
    field = message(
        tmp_path,
        "at: 0, bits: 8, name: Kind, type: uint",
        "at: 8, bits: 8, name: Rate, type: uint, formula: raw*0.001, when: {Kind: 1}",
    ).members[1]
    assert [text for text, _ in accessors(field)] == [
        "rate_physical: _lazy.Optional[float] = _base.scaled(1, 0, 1000, default=0.0)",
        "rate_milli: _lazy.Optional[int] = _base.whole(1, 0)",
    ]


POINTS = "points: [[10, 1], [20, 6], [30, 26]]"


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        (
            "bits: 8, type: uint, formula: raw^2 + 1",
            "float = _base.curve((0.0, (1.0, 0.0, 1.0)), default=1.0)",
        ),
        (
            "bits: 8, type: int, formula: raw^2",
            "float = _base.curve_only((0.0, (0.0, 0.0, 1.0)), default=0.0)",
        ),
        (
            "bits: 8, type: uint, count: 2, formula: raw^2",
            "tuple[float, ...] = _base.curve((0.0, (0.0, 0.0, 1.0)), "
            "default=(0.0,) * 2)",
        ),
        # Outside of the points, the physical value is NaN and cannot be set.
        (
            f"bits: 8, type: uint, {POINTS}, outside: refuse",
            "float = _base.curve((10.0, ()), (10.0, (1.0, 0.5)), (20.0, (6.0, 2.0)), "
            '(30.0, (26.0,)), (30.000000000000004, ()), default=float("nan"), '
            "ends=(10, 30))",
        ),
        (
            f"bits: 8, type: uint, const: 20, {POINTS}, outside: extrapolate",
            "float = _base.curve((10.0, (1.0, 0.5)), (20.0, (6.0, 2.0)), "
            "(30.0, (26.0, 2.0)), default=6.0)",
        ),
    ],
)
def test_a_calibration_has_its_pieces_and_is_set_if_it_has_an_inverse(
    tmp_path, keys, text
):
    field = message(tmp_path, f"at: 0, name: Rate, {keys}").members[0]
    ((declared, _),) = accessors(field)
    line = " ".join(declared.split()).replace("( ", "(").replace(", )", ")")
    assert line == f"rate_physical: {text}"


@pytest.mark.parametrize(
    ("keys", "value"),
    [
        ("bits: 8, type: uint, const: 7", "7"),
        ("bits: 8, type: uint, formula: raw*0.5, min: 0.5", "0.5"),
        ("bits: 8, type: uint, formula: raw*0.5, min: 4", "4"),
        (
            "bits: 32, type: float, special: [{value: nan, meaning: idle}]",
            'float("nan")',
        ),
        (
            "bits: 64, type: float, special: [{value: -inf, meaning: idle}]",
            'float("-inf")',
        ),
        ("bits: 32, type: float, special: [{value: -1.5, meaning: idle}]", "-1.5"),
        ("bits: 8, type: int, special: [{value: -7, meaning: idle}]", "-7"),
    ],
)
def test_a_constant_is_a_literal(tmp_path, keys, value):
    (field,) = message(tmp_path, f"at: 0, name: Rate, {keys}").members
    (constant,) = field.constants
    assert constant_value(field, constant) == value


def test_a_limit_is_a_whole_number_or_the_nearest_float():
    assert number_literal(Fraction(8, 4)) == "2"
    assert number_literal(-3) == "-3"
    assert number_literal(Fraction(-1, 3)) == "-0.3333333333333333"


def views(folder, *fields, length=4, derived=""):
    text = HEAD + status(*fields, length=length) + derived
    (one,) = node_of(folder, text).messages
    return one.read_only_members


def test_an_overlay_field_is_read_from_the_frame_and_scaled_exactly(tmp_path):
    low, mode, falling, plain = views(
        tmp_path,
        "at: 0, bits: 32, name: Whole, type: uint",
        "at: 0, bits: 8, name: Low, type: int, view: true, unit: V, "
        "formula: raw*0.5 - 3",
        "at: 8, bits: 8, name: Mode, type: enum, enum: Mode, view: true",
        "at: 16, bits: 8, name: Falling, type: uint, view: true, formula: 1 - raw",
        "at: 24, bits: 8, name: Plain, type: uint, view: true, formula: raw*2",
    )
    assert view_info(low) == (
        '_base.FieldInfo("low", "Low", 0, 8, "int", unit="V", physical="low_v", '
        "scale=(1, -6, 2))"
    )
    assert getter(low) == '_base.view(self, "low", int)'
    assert physical(low) == "(self.low * 1 - 6) / 2"
    assert view_info(mode) == (
        '_base.FieldInfo("mode", "Mode", 8, 8, "enum", enum=Mode)'
    )
    assert getter(mode) == '_base.view(self, "mode", Mode)'
    assert physical(falling) == "(self.falling * -1 + 1) / 1"
    assert physical(plain) == "(self.plain * 2 + 0) / 1"


def test_an_overlay_on_a_calibration_has_a_line_for_each_of_several_pieces(tmp_path):
    single, several = views(
        tmp_path,
        "at: 0, bits: 16, name: Everything, type: uint",
        "at: 0, bits: 8, name: Single, type: uint, view: true, formula: raw^2",
        f"at: 8, bits: 8, name: Several, type: uint, view: true, {POINTS}, "
        "outside: extrapolate",
        length=2,
    )
    assert view_info(single) == (
        '_base.FieldInfo("single", "Single", 0, 8, "uint", '
        'physical="single_physical", curve=((0.0, (0.0, 0.0, 1.0)),))'
    )
    assert view_info(several) == (
        '_base.FieldInfo("several", "Several", 8, 8, "uint", '
        'physical="several_physical", curve=(\n'
        "                (10.0, (1.0, 0.5)),\n"
        "                (20.0, (6.0, 2.0)),\n"
        "                (30.0, (26.0, 2.0)),\n"
        "            ))"
    )
    assert physical(several) == '_base.on_curve(self, "several")'


def test_a_derived_value_has_its_operands_and_steps(tmp_path):
    (wide,) = views(
        tmp_path,
        "at: 0, bits: 16, name: Width, type: uint, formula: raw*0.01, unit: m",
        "at: 16, bits: 8, name: Last, type: uint",
        derived="    derived: [{name: Wide, formula: Width*2 + Last, unit: m}]\n",
    )
    assert view_info(wide) == (
        '_base.FieldInfo("wide_m", "Wide", 32, 64, "float", unit="m", '
        'derived=(("width_m", "last"), (2.0,), (("*", 0, 2), ("+", 3, 1))))'
    )
    assert getter(wide) == '_base.derived(self, "wide_m")'
    assert annotation(wide) == "float"


@pytest.mark.parametrize(
    ("begin", "keys", "behind", "text"),
    [
        (0, "count: rest, up_to: 5", False, '_base.Tail("data", "", 2, 5)'),
        (8, "count: Number, up_to: 5", False, '_base.Tail("data", "number", 2, 5)'),
        (
            8,
            "count: {field: Number, plus: -2}, up_to: 5",
            False,
            '_base.Tail("data", "number", 2, 5, -2)',
        ),
        (
            8,
            "count: Number, up_to: 5",
            True,
            '_base.Tail("data", "number", 2, 5, 0, 3)',
        ),
        (
            8,
            "count: {field: Number, plus: 1}, up_to: 5",
            True,
            '_base.Tail("data", "number", 2, 5, 1, 3)',
        ),
    ],
)
def test_a_tail_has_its_counter_and_the_bytes_behind_it(
    tmp_path, begin, keys, behind, text
):
    number = ["at: 0, bits: 8, name: Number, type: uint"] * (begin // 8)
    after = [f"at: {begin}, after: Data, bits: 24, name: Sum, type: uint"] * behind
    one = message(
        tmp_path,
        *number,
        f"at: {begin}, name: Data, type: uint, bits: 16, {keys}",
        *after,
        length=begin // 8,
    )
    assert open_part(one.last_part) == text


NESTED = """\
structs:
  - name: Curve
    length: 1
    fields:
      - {at: 0, bits: 8, name: Kind, type: uint}
      - {at: 8, bits: 16, name: Points, type: uint, count: Inner, up_to: 3}
messages:
  - name: Curves
    id: 7
    kind: telemetry
    length: 3
    fields:
      - {at: 0, bits: 8, name: Number, type: uint}
      - {at: 10, bits: 9, name: Inner, type: uint}
      - {at: 24, name: Curves, struct: Curve, count: Number, up_to: 2}
      - {at: 24, after: Curves, bits: 8, name: More, type: uint, count: rest, up_to: 4}
"""


def test_parts_before_the_last_have_their_places_and_those_of_their_counters(tmp_path):
    (curves,) = node_of(tmp_path, NESTED).messages
    assert inner(curves) == [
        '(_base.Tail("curves", "number", 7, 2), 3, ((0, 0, 8, 0),))'
    ]
    assert nested(curves) == [
        '("curves", _base.Tail("points", "inner", 2, 3), 1, '
        "((1, 2, 6, 0), (2, 0, 3, 6)))"
    ]
