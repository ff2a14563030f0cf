"""Fixed values, constraints and lengths of electronic data sheets make entries constant,
narrow their range, or are refused with the reason.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.eds_parts import (
    Constraint,
    EdsPart,
    LinearConversion,
    apply_constraint,
    fix_raw_value,
    line_of,
    set_fixed_value,
    set_length,
)
from icdgen.definitions.eds_ranges import ALL, Range
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import EdsFieldType, EdsTypes
from icdgen.definitions.eds_values import UNSIGNED
from icdgen.definitions.model import Definitions, NotSupported

NARROW = """\
<SubRangeDataType name="Narrow" baseType="Byte">
 <Range><MinMaxRange min="3" max="9" rangeType="{}"/></Range>
</SubRangeDataType>
"""


def sheets_of(inner="", types=""):
    """Return an index, the factory of types, and the elements of ``inner``."""
    byte = (
        '<IntegerDataType name="Byte"><IntegerDataEncoding sizeInBits="8"'
        ' encoding="unsigned" byteOrder="bigEndian"/></IntegerDataType>'
    )
    text = (
        f'<PackageFile><Package name="p"><DataTypeSet>{byte}{types}</DataTypeSet>'
        f"<X>{inner}</X></Package></PackageFile>"
    )
    to = Definitions("a.xml")
    root = safe_xml.parse("a.xml", text.encode(), account=Account())
    sheets = Sheets(root, (), to)
    return sheets, EdsTypes(to, sheets), list(root.find("Package/X"))


def field_type(bits=8, type="uint", code=UNSIGNED, values=None, range=ALL, **item):
    return EdsFieldType(
        {"type": type, **item}, bits, code=code, values=values or {}, range=range
    )


def part_of(of, entry=None, bits=None):
    item = of.item if of else {}
    bits = of.bits if bits is None and of else bits or 0
    return EdsPart(("N",), item, 0, bits, entry=entry, field_type=of)


def failure(call, *arguments):
    with pytest.raises(NotSupported) as caught:
        call(*arguments)
    return str(caught.value)


def test_a_constant_replaces_limits_and_meanings_of_single_values():
    of = field_type(min=1, max=9, special=[{"value": 3}], unit="s", summary="x")
    item = of.item
    fix_raw_value(of, 7, "N")
    assert item is of.item
    assert item == {"type": "uint", "unit": "s", "summary": "x", "const": 7}
    fix_raw_value(of, 7, "N")
    assert failure(fix_raw_value, of, 8, "N") == (
        "it depends on `N`, which is both 7 and 8"
    )
    assert item["const"] == 7


@pytest.mark.parametrize(
    ("kind", "result"),
    [("bool", "uint"), ("int", "int"), ("enum", "enum"), ("uint", "uint")],
)
def test_a_constant_flag_is_a_number(kind, result):
    of = field_type(type=kind)
    fix_raw_value(of, 1, "N")
    assert of.item == {"type": result, "const": 1}


@pytest.mark.parametrize(
    ("bits", "text", "const"),
    [
        (16, "AB", "0x4142"),
        (24, "AB", "0x414200"),
        (24, "", "0x000000"),
        (16, "é", "0xC3A9"),
        (64, "ABCDEFGH", "0x4142434445464748"),
    ],
)
def test_a_fixed_text_of_up_to_64_bits_is_a_number_with_its_bytes(bits, text, const):
    of = field_type(bits, "text", code="")
    set_fixed_value(of, text, "N")
    assert of.item == {"type": "uint", "const": of.item["const"]}
    assert of.item["const"].spelling == const
    assert of.item["const"] == int(const, 16)


def test_longer_texts_and_other_types_have_no_constant():
    for of in (
        field_type(72, "text", code=""),
        field_type(0, "text", code="", up_to=9),
        field_type(24, "bytes", code=""),
        field_type(32, "float", code=""),
    ):
        before = dict(of.item)
        set_fixed_value(of, "12345", "N")
        assert of.item == before


def test_a_fixed_text_must_fit_its_type():
    for bits in (16, 72):
        text = "x" * (bits // 8)
        set_fixed_value(field_type(bits, "text", code=""), text, "N")
        assert failure(
            set_fixed_value, field_type(bits, "text", code=""), text + "y", "N"
        ) == (f"`N` is longer than its type: `{text}y`")


def test_a_fixed_number_or_label_is_a_constant():
    of = field_type(values={"On": 3})
    set_fixed_value(of, "On", "N")
    assert of.item["const"] == 3
    of = field_type()
    set_fixed_value(of, "0x10 + 1", "N")
    assert of.item["const"] == 17
    assert failure(set_fixed_value, field_type(), "256", "N") == "`N` is never `256`"


def applied(text, of, types="", bits=None):
    """Apply a constraint; return the raw value that it requires."""
    sheets, eds_types, (element,) = sheets_of(text, types)
    constraint = Constraint(("A", "N"), element)
    return apply_constraint(part_of(of, bits=bits), constraint, sheets, eds_types)


def between(low, high, kind="inclusiveMinInclusiveMax"):
    limits = f'<MinMaxRange min="{low}" max="{high}" rangeType="{kind}"/>'
    return f"<RangeConstraint>{limits}</RangeConstraint>"


LABELS = "<RangeConstraint><EnumeratedRange>{}</EnumeratedRange></RangeConstraint>"


@pytest.mark.parametrize(
    ("text", "raw"),
    [
        ('<ValueConstraint value="5"/>', 5),
        ('<ValueConstraint value=" 2 + 2 "/>', 4),
        ('<ValueConstraint value="On"/>', 3),
        (LABELS.format("<Label> On </Label>"), 3),
        (between(6, 6), 6),
        (between(6, 7, "inclusiveMinExclusiveMax"), 6),
        (between("6.5", "7.5"), 7),
    ],
)
def test_a_constraint_of_a_single_value_makes_a_field_constant(text, raw):
    of = field_type(values={"On": 3})
    assert applied(text, of) == raw
    assert of.item == {"type": "uint", "const": raw}


@pytest.mark.parametrize(
    ("text", "limits"),
    [
        (between(6, 8), {"min": 6, "max": 8}),
        (between(6, 8, "exclusiveMinExclusiveMax"), {"const": 7}),
        (between(6, 9, "exclusiveMinExclusiveMax"), {"min": 7, "max": 8}),
        (between(6, 300), {"min": 6}),
        (between(6, 0, "atLeast"), {"min": 6}),
        (between(0, 6, "lessThan"), {"max": 5}),
    ],
)
def test_a_constraint_of_several_values_narrows_the_range(text, limits):
    of = field_type()
    raw = applied(text, of)
    assert raw == limits.get("const")
    assert of.item == {"type": "uint", **limits}


def test_a_range_is_narrowed_within_the_range_of_the_type():
    of = field_type(range=Range(Fraction(2), Fraction(7)), min=2, max=7)
    assert applied(between(5, 9), of) is None
    assert of.range == Range(Fraction(5), Fraction(7))
    assert of.item == {"type": "uint", "min": 5, "max": 7}


def test_a_float_can_be_narrowed_but_not_fixed_by_a_range():
    of = field_type(32, "float", code="")
    assert applied(between(6, 6), of) is None
    assert of.item == {"type": "float", "min": 6, "max": 6}


@pytest.mark.parametrize(
    "more",
    [
        {"formula": "raw*2"},
        {"points": [[0, 1], [1, 2]]},
        {"const": 7},
        {"special": [{"value": 9}]},
    ],
)
def test_limits_are_not_stated_where_they_have_another_meaning(more):
    of = field_type(**more)
    assert applied(between(6, 8), of) is None
    assert of.item == {"type": "uint", **more}
    assert of.range == Range(Fraction(6), Fraction(8))


def test_a_constraint_of_a_type_is_that_of_its_range():
    types = NARROW.format("inclusiveMinInclusiveMax")
    of = field_type()
    assert applied('<TypeConstraint type="Narrow"/>', of, types) is None
    assert of.item == {"type": "uint", "min": 3, "max": 9}
    of = field_type()
    assert applied('<TypeConstraint type="Narrow"/>', of,
                   types.replace('max="9"', 'max="3"')) == 3  # fmt: skip


SEVERAL = "it depends on `A.N`, which has one of several values"


@pytest.mark.parametrize(
    ("text", "of", "why"),
    [
        (LABELS.format("<Label>On</Label><Label>Off</Label>"), {}, SEVERAL),
        ("<RangeConstraint/>", {}, SEVERAL),
        (between(6, 8), {"type": "enum"}, SEVERAL),
        (between(6, 6), {"type": "enum"}, SEVERAL),
        ('<TypeConstraint type="Byte"/>', {}, SEVERAL),
        ("<OddConstraint/>", {}, "it is constrained by a `OddConstraint`"),
        (
            '<ValueConstraint value="256"/>',
            {},
            "it depends on `A.N`, which is never `256`",
        ),
        (
            '<ValueConstraint value="1"/>',
            {"type": "float"},
            "it depends on `A.N`, which has a value and is of the type float",
        ),
        (
            '<ValueConstraint value="1"/>',
            {"const": 2},
            "it depends on `A.N`, which is both 2 and 1",
        ),
    ],
)
def test_other_constraints_are_refused_with_the_reason(text, of, why):
    before = field_type(**of)
    assert failure(applied, text, before) == why
    assert before.item == field_type(**of).item


def test_a_constraint_needs_a_scalar_field():
    text, why = (
        '<ValueConstraint value="1"/>',
        "it depends on `A.N`, but it has no such field",
    )
    sheets, types, (element,) = sheets_of(text)
    constraint = Constraint(("A", "N"), element)
    assert failure(apply_constraint, None, constraint, sheets, types) == why
    assert failure(applied, text, None) == why
    assert failure(applied, text, field_type(), "", 16) == why  # an array


def entry_with(inner):
    return f"<LengthEntry>{inner}</LengthEntry>"


def terms(*pairs):
    inner = "".join(f'<Term exponent="{e}" coefficient="{c}"/>' for e, c in pairs)
    return entry_with(f"<PolynomialCalibrator>{inner}</PolynomialCalibrator>")


LINES = [
    (entry_with(""), (1, 0)),
    (terms(), (1, 0)),
    (terms((1, 4), (0, 6)), (4, 6)),
    (terms((1, "1/2"), (0, -7)), (Fraction(1, 2), -7)),
    (terms((1, 2), (1, 3)), (5, 0)),
    (terms((0, 6)), None),  # a constant
    (terms((1, 0)), None),
    (terms((1, 1), (2, 1)), None),
    (terms((1, "x")), None),
    (entry_with("<SplineCalibrator/>"), None),
]


@pytest.mark.parametrize(("text", "line"), LINES)
def test_a_length_is_linear_or_has_no_conversion(text, line):
    sheets, _, (entry,) = sheets_of(text)
    assert line_of(entry, sheets) == (None if line is None else LinearConversion(*line))


def length_of(text, length, **of):
    sheets, _, (entry,) = sheets_of(text)
    of = field_type(**of)
    set_length(part_of(of, entry), length, sheets)
    return of.item.get("const")


@pytest.mark.parametrize(
    ("text", "length", "const"),
    [
        (entry_with(""), 10, 10),
        (entry_with(""), 255, 255),
        (entry_with(""), 256, None),
        (terms((1, 4), (0, 6)), 10, 1),
        (terms((1, 4), (0, 6)), 6, 0),
        (terms((1, 4), (0, 6)), 11, None),
        (terms((1, 4), (0, 6)), 2, None),  # below 0
        (terms((1, "1/2"), (0, 1)), 10, 18),
        (terms((0, 6)), 10, None),
    ],
)
def test_a_length_entry_has_the_raw_value_of_the_length(text, length, const):
    assert length_of(text, length) == const


def test_only_integers_without_a_constant_get_the_length():
    assert length_of(entry_with(""), 10, type="int", code="twosComplement") == 10
    assert length_of(entry_with(""), 10, type="enum") is None
    assert length_of(entry_with(""), 10, const=3) == 3
    assert length_of(entry_with(""), 10, bits=16, code="BCD") == 0x0100
    sheets, _, (entry,) = sheets_of(entry_with(""))
    set_length(part_of(None, entry), 10, sheets)
