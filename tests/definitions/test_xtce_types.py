"""Types of XTCE become fields: encodings with their defaults, arrays, flags, times,
units and limits.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Definitions, NotSupported
from icdgen.definitions.xtce_names import XtceNames
from icdgen.definitions.xtce_types import (
    XtceFieldType,
    XtceTypes,
    described,
    repeated,
    special_values,
)
from tests.limits import assert_limits

INTEGER = '<IntegerDataEncoding sizeInBits="8"/>'
FLOAT = '<FloatDataEncoding sizeInBits="32"/>'
OTHERS = """\
<IntegerParameterType name="byte"><IntegerDataEncoding/></IntegerParameterType>
<IntegerParameterType name="nibble"><IntegerDataEncoding sizeInBits="4"/>
</IntegerParameterType>
<FloatParameterType name="little"><FloatDataEncoding
 byteOrder="leastSignificantByteFirst"/></FloatParameterType>
<ArrayParameterType name="array" arrayTypeRef="byte"/>
<AggregateParameterType name="pair"><MemberList><Member name="x" typeRef="byte"/>
<Member name="y" typeRef="nibble"/></MemberList></AggregateParameterType>
<StringParameterType name="open"><StringDataEncoding><SizeInBits><DynamicValue>
<ParameterInstanceRef parameterRef="A"/></DynamicValue></SizeInBits>
</StringDataEncoding></StringParameterType>
"""


class Read:
    """Type of this kind and content, read as a field."""

    def __init__(self, kind, inner="", more="", others=""):
        own = f'<{kind}ParameterType name="T_Type" {more}>{inner}</{kind}ParameterType>'
        text = (
            f'<SpaceSystem name="probe"><TelemetryMetaData><ParameterTypeSet>{own}'
            f"{OTHERS}{others}</ParameterTypeSet></TelemetryMetaData></SpaceSystem>"
        )
        root = safe_xml.parse("a.xml", text.encode(), account=Account())
        self.to = Definitions("a.xml")
        names = XtceNames({"a.xml": root}, self.to)
        self.types = XtceTypes(self.to, names)
        self.element = root[0][0][0]
        self.named = lambda name: names.type_of(name, self.element)
        self.field = self.why = None
        try:
            self.field = self.types.field_type(self.element, "`P`")
        except NotSupported as why:
            self.why = str(why)

    @property
    def findings(self):
        self.types.report_raw_only()
        return [finding.message for finding in self.to.import_findings]

    @property
    def enums(self):
        return self.types.enums.declared()


def keys(kind, inner="", more="", others=""):
    """Return the keys of the field, which needs no finding."""
    read = Read(kind, inner, more, others)
    assert (read.findings, read.why) == ([], None)
    return read.field.item


def form(kind, inner="", more=""):
    """Return type, bits and order of the field."""
    field = Read(kind, inner, more).field
    return field.item["type"], field.bits, field.order


@pytest.mark.parametrize(
    ("kind", "inner", "more", "expected"),
    [
        # Without an encoding: defaults of the type
        ("Integer", "", "", ("int", 32, BIG)),
        ("Integer", "", 'signed="false" sizeInBits="16"', ("uint", 16, BIG)),
        ("Integer", "", 'signed="true" sizeInBits="64"', ("int", 64, BIG)),
        ("Float", "", "", ("float", 32, BIG)),
        ("Float", "", 'sizeInBits="64"', ("float", 64, BIG)),
        # With an encoding: its defaults, whatever the type says
        ("Integer", "<IntegerDataEncoding/>", 'signed="true"', ("uint", 8, BIG)),
        ("Integer", '<IntegerDataEncoding encoding="twosComplement" sizeInBits="12"/>',
         'sizeInBits="32"', ("int", 12, BIG)),
        ("Integer", '<IntegerDataEncoding encoding="twosCompliment"/>', "", ("int", 8,
         BIG)),
        ("Float", "<FloatDataEncoding/>", "", ("float", 32, BIG)),
        ("Float", INTEGER, "", ("uint", 8, BIG)),
        ("Float", '<FloatDataEncoding encoding="IEEE754" sizeInBits="64"/>', "",
         ("float", 64, BIG)),
        # Order of the bytes
        ("Integer",
         '<IntegerDataEncoding sizeInBits="16" byteOrder="leastSignificantByteFirst"/>',
         "", ("uint", 16, LITTLE)),
        ("Float", '<FloatDataEncoding byteOrder="leastSignificantByteFirst"/>', "",
         ("float", 32, LITTLE)),
        ("Boolean", '<IntegerDataEncoding sizeInBits="1"/>', "", ("bool", 1, BIG)),
        ("Binary", "<BinaryDataEncoding><SizeInBits><FixedValue>24</FixedValue>"
         "</SizeInBits></BinaryDataEncoding>", "", ("bytes", 24, BIG)),
        ("Binary", "<BinaryDataEncoding><SizeInBits><FixedValue>12</FixedValue>"
         "</SizeInBits></BinaryDataEncoding>", "", ("uint", 12, BIG)),
    ],
)  # fmt: skip
def test_an_encoding_has_type_bits_and_order(kind, inner, more, expected):
    assert form(kind, inner, more) == expected


def bytes_in_order(*significances, more=""):
    listed = "".join(f'<Byte byteSignificance="{value}"/>' for value in significances)
    return (
        f'<IntegerDataEncoding sizeInBits="16" {more}><ByteOrderList>{listed}'
        "</ByteOrderList></IntegerDataEncoding>"
    )


@pytest.mark.parametrize(
    ("significances", "order"),
    [((1, 0), BIG), ((0, 1), LITTLE), ((0,), BIG), ((), BIG), ((0, 1, 2, 3), LITTLE)],
)
def test_a_list_of_bytes_is_a_byte_order(significances, order):
    assert form("Integer", bytes_in_order(*significances)) == ("uint", 16, order)


@pytest.mark.parametrize(
    ("kind", "inner", "why", "bits"),
    [
        ("Integer", bytes_in_order(1, 0, 2),
         "its bytes are sent in the order [1, 0, 2]", 16),
        ("Integer", '<IntegerDataEncoding byteOrder="middle"/>',
         "its bytes are sent in the order middle", 8),
        ("Integer", '<IntegerDataEncoding encoding="BCD" sizeInBits="64"/>',
         "an integer is encoded as `BCD`", 64),
        ("Float", '<FloatDataEncoding encoding="MILSTD_1750A" sizeInBits="48"/>',
         "a float is encoded as `MILSTD_1750A`", 48),
        ("Float", '<FloatDataEncoding sizeInBits="16"/>', "a float has 16 bits", 16),
        ("Integer", '<IntegerDataEncoding bitOrder="leastSignificantBitFirst"/>',
         "its least significant bit is sent first", 8),
        ("Float", '<FloatDataEncoding bitOrder="leastSignificantBitFirst"/>',
         "its least significant bit is sent first", 32),
        ("Integer", '<IntegerDataEncoding sizeInBits="72"/>', "an integer has 72 bits",
         72),
        (
            "String",
            "<StringDataEncoding><SizeInBits><Fixed><FixedValue>40</FixedValue></Fixed>"
            "<TerminationChar>2C</TerminationChar></SizeInBits></StringDataEncoding>",
            "it ends at the byte `2C`",
            40,
        ),
    ],
)  # fmt: skip
def test_an_encoding_that_is_not_supported_leaves_the_raw_bits(kind, inner, why, bits):
    read = Read(kind, inner)
    assert read.field == XtceFieldType(
        {"type": "uint" if bits <= 64 else "bytes"}, bits, is_raw=True
    )
    assert read.findings == [f"`P` (message ``): {why}"]
    assert read.to.import_findings[0].help == (
        "its raw bits are imported, without their meaning"
    )


@pytest.mark.parametrize(
    ("kind", "inner", "why"),
    [
        ("Boolean", "", "the type `T_Type` has no encoding"),
        ("Enumerated", "", "the type `T_Type` has no encoding"),
        ("Integer", '<IntegerDataEncoding sizeInBits="65"/>', "an integer has 65 bits"),
        ("Integer", '<IntegerDataEncoding sizeInBits="0"/>', "an integer has 0 bits"),
        (
            "String",
            "<StringDataEncoding><SizeInBits><LeadingSize/></SizeInBits>"
            "</StringDataEncoding>",
            "it has a length prefix",
        ),
        ("String", "<StringDataEncoding/>",
         "its size is neither a number nor that of a parameter"),
        ("Boolean", FLOAT, "a flag is encoded as float"),
        ("Enumerated", FLOAT, "`P` has labels, and is encoded as float"),
    ],
)  # fmt: skip
def test_a_type_without_a_known_size_or_meaning_is_refused(kind, inner, why):
    read = Read(kind, inner)
    assert (read.why, read.field) == (why, None)


def test_raw_bits_have_at_most_65535_whole_bytes():
    def is_imported(size):
        inner = f'<IntegerDataEncoding encoding="BCD" sizeInBits="{8 * size}"/>'
        return Read("Integer", inner).field is not None

    assert_limits(is_imported, least=1, most=65535)


def text(size, more="", variable=""):
    fixed = f"<Fixed><FixedValue>{size}</FixedValue></Fixed>"
    size = f"<SizeInBits>{fixed}{variable}</SizeInBits>"
    return f"<StringDataEncoding {more}>{size}</StringDataEncoding>"


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        (text(80), ("text", 80)), (text(80, 'encoding="UTF-8"'), ("text", 80)),
        (text(80, 'encoding="US-ASCII"'), ("text", 80)),
        (text(80, 'encoding="ISO-8859-1"'), ("text", 80)),
        (text(80, 'encoding="UTF-16"'), ("bytes", 80)),
        (text(8, variable="<TerminationChar>00</TerminationChar>"), ("text", 8)),
        (text(8, variable="<TerminationChar/>"), ("text", 8)),
    ],
)  # fmt: skip
def test_a_text_of_another_encoding_is_bytes(inner, expected):
    assert form("String", inner)[:2] == expected


def test_a_text_has_whole_bytes():
    # Other sizes are raw bits up to 64.
    assert [form("String", text(bits))[0] for bits in (7, 8, 9, 16)] == [
        "uint",
        "text",
        "uint",
        "text",
    ]
    for bits in (0, 68):
        assert Read("String", text(bits)).why == f"text or bytes have {bits} bits"


def dynamic(inner="", reference='parameterRef="N"', kind="Parameter"):
    return f"<DynamicValue><{kind}InstanceRef {reference}/>{inner}</DynamicValue>"


def adjusted(**keys):
    listed = " ".join(f'{key}="{value}"' for key, value in keys.items())
    return f"<LinearAdjustment {listed}/>"


@pytest.mark.parametrize(
    ("inner", "size", "plus"),
    [
        (dynamic(adjusted(slope=8)), "N", 0),
        (dynamic(adjusted(slope=8, intercept=-16)), "N", -2),
        (dynamic(adjusted(slope="8.0", intercept="24")), "N", 3),
        (dynamic(adjusted(slope=8, intercept=4)), "N", None),
        (dynamic(adjusted(slope=16)), "N", None), (dynamic(), "N", None),
        (dynamic(adjusted(slope="8", intercept="0.5")), "N", None),
        (dynamic(adjusted(slope="x")), "N", None),
        (dynamic(adjusted(slope=8), 'argumentRef="M"', "Argument"), "M", 0),
    ],
)  # fmt: skip
@pytest.mark.parametrize("outer", ["SizeInBits", "Variable"])
def test_bytes_have_the_size_that_a_parameter_gives_in_bits(inner, size, plus, outer):
    encoding = "Binary" if outer == "SizeInBits" else "String"
    read = Read(
        encoding,
        f"<{encoding}DataEncoding><{outer}>{inner}</{outer}></{encoding}DataEncoding>",
    )
    type_ = {"Binary": "bytes", "String": "text"}[encoding]
    item = {"type": type_, "size": "rest", "up_to": 65535}
    assert read.field == XtceFieldType(item, 0, size=size, plus=plus)


def test_a_size_without_a_reference_is_refused():
    for inner in ("<DynamicValue/>", dynamic(reference="")):
        read = Read(
            "Binary",
            f"<BinaryDataEncoding><SizeInBits>{inner}</SizeInBits>"
            "</BinaryDataEncoding>",
        )
        assert read.why == "its size is neither a number nor that of a parameter"


def dimension(last, first="<FixedValue>0</FixedValue>"):
    return (
        f"<Dimension><StartingIndex>{first}</StartingIndex><EndingIndex>{last}"
        "</EndingIndex></Dimension>"
    )


def array(of, *dimensions):
    listed = f"<DimensionList>{''.join(dimensions)}</DimensionList>" * bool(dimensions)
    return Read("Array", listed, f'arrayTypeRef="{of}"')


FIXED = "<FixedValue>{}</FixedValue>".format


def test_an_array_has_the_elements_from_the_first_to_the_last_index():
    assert array("little", dimension(FIXED(2))).field == XtceFieldType(
        {"type": "float", "bits": 32, "count": 3}, 96, LITTLE
    )
    field = array("nibble", dimension(FIXED(4), FIXED(3))).field
    assert (field.item["count"], field.bits) == (2, 8)

    def is_array(count):
        return array("byte", dimension(FIXED(count - 1))).field is not None

    assert_limits(is_array, least=1, most=1024)


@pytest.mark.parametrize(
    ("of", "dimensions", "why"),
    [
        ("byte", [], "`P` is an array of no dimensions"),
        ("byte", [dimension(FIXED(1))] * 2, "`P` is an array of 2 dimensions"),
        ("array", [dimension(FIXED(1))], "`P` is an array of arrays"),
        ("pair", [dimension(FIXED(1))], "`P` is an array of elements of variable size"),
        ("open", [dimension(FIXED(1))], "`P` is an array of elements of variable size"),
        ("byte", [dimension(dynamic(), FIXED(1))],
         "`P` is an array of as many elements as another parameter says"),
        ("byte", [dimension(FIXED(3), dynamic())],
         "`P` is an array of as many elements as another parameter says"),
        ("byte", [dimension(FIXED(1), FIXED(2))], "`P` is an array of 0 elements"),
        ("nibble", [dimension(dynamic())],
         "`P` is an array of elements without a fixed size in bytes"),
        ("pair", [dimension(dynamic())],
         "`P` is an array of elements without a fixed size in bytes"),
        ("byte", [dimension(dynamic(adjusted(slope=2)))],
         "`P` is an array of a number of elements that no parameter counts"),
        ("byte", [dimension(dynamic(adjusted(intercept="0.5")))],
         "`P` is an array of a number of elements that no parameter counts"),
        ("byte", [dimension(dynamic(reference=""))],
         "`P` is an array of a number of elements that no parameter counts"),
    ],
)  # fmt: skip
def test_another_array_is_refused_with_the_reason(of, dimensions, why):
    assert array(of, *dimensions).why == why


def test_the_last_index_that_a_parameter_gives_is_part_of_the_array():
    # The default of `slope` is 1.
    assert array("byte", dimension(dynamic())).field == XtceFieldType(
        {"type": "uint", "bits": 8, "count": "rest", "up_to": 1024}, 0, size="N", plus=1
    )
    field = array("little", dimension(dynamic(adjusted(intercept=-1)))).field
    assert (field.plus, field.order, field.size) == (0, LITTLE, "N")


def test_an_aggregate_has_its_members_and_no_field():
    read = Read("Integer", INTEGER)
    pair = read.named("pair")
    field = read.types.field_type(pair, "`P`")
    assert (field.item, field.bits) == ({}, 0)
    assert field.members == [("x", read.named("byte")), ("y", read.named("nibble"))]
    assert read.types.member(pair, "y", "`P`") is read.named("nibble")
    with pytest.raises(NotSupported, match="`P`: `pair` has no member `z`"):
        read.types.member(pair, "z", "`P`")


def test_an_array_repeats_a_field_once_as_the_field_itself():
    field = XtceFieldType({"type": "uint"}, 4, LITTLE, values={"A": 1})
    assert repeated(field, 1, "`P`") is field
    assert repeated(field, 2, "`P`") == XtceFieldType(
        {"type": "uint", "bits": 4, "count": 2}, 8, LITTLE, values={"A": 1}
    )


def labels(*rows):
    listed = "".join(
        f'<Enumeration value="{value}" label="{label}" {more}/>'
        for value, label, more in rows
    )
    return f"<EnumerationList>{listed}</EnumerationList>"


def test_labels_are_an_enumeration_named_after_its_type():
    listed = labels(
        (3, "On", ""), (0, "Off", ""), (5, "Odd", 'maxValue="7"'), (3, "X", "")
    )
    read = Read("Enumerated", INTEGER + listed)
    # Of equal labels the first value counts, of equal values the first label.
    assert read.field.values == {"Off": 0, "On": 3, "Odd": 5}
    assert read.enums == [
        {
            "name": "T",
            "members": [
                {"value": 0, "name": "Off"},
                {"value": 3, "name": "On"},
                {"value": 5, "to": 7, "name": "Odd"},
            ],
        }
    ]
    assert read.field.item == {"type": "enum", "enum": "T"} and read.findings == []


def test_a_label_covers_up_to_1024_values_in_ascending_order():
    def is_label(last):
        encoding = '<IntegerDataEncoding sizeInBits="16"/>'
        listed = labels((1, "A", f'maxValue="{last}"'))
        return Read("Enumerated", encoding + listed).why is None

    assert_limits(is_label, least=1, most=1024)
    read = Read("Enumerated", INTEGER + labels((5, "A", 'maxValue="4"')))
    assert read.why == "`P` has a label for the values 5 to 4"


def test_a_fault_of_labels_is_reported_once_for_each_type():
    read = Read("Enumerated", INTEGER + labels((0, "A", ""), (256, "B", "")))
    read.types.field_type(read.element, "`Q`")
    assert read.findings == [
        "`T`: it never has the value 256, which has a name",
    ]


def test_a_flag_has_the_words_of_its_type_and_of_xml():
    read = Read(
        "Boolean",
        '<IntegerDataEncoding sizeInBits="1"/>',
        'zeroStringValue="Shut" oneStringValue="Open"',
    )
    assert read.field.item == {"type": "bool"} and read.enums == []
    assert read.field.values == {"Shut": 0, "Open": 1, "false": 0, "true": 1}
    read = Read("Boolean", '<IntegerDataEncoding sizeInBits="1"/>')
    assert read.field.values == {"False": 0, "True": 1, "false": 0, "true": 1}


def test_a_flag_of_several_bits_is_an_enumeration():
    members = [{"value": 0, "name": "False"}, {"value": 1, "name": "True"}]
    read = Read("Boolean", INTEGER)
    assert read.enums == [{"name": "T", "members": members}]
    assert read.field.item == {"type": "enum", "enum": "T"} and read.field.bits == 8
    assert form("Boolean", INTEGER.replace("8", "2"))[:2] == ("enum", 2)


def calibrated(*terms):
    listed = "".join(
        f'<Term coefficient="{factor}" exponent="{power}"/>'
        for power, factor in enumerate(terms)
    )
    return (
        '<IntegerDataEncoding sizeInBits="8"><DefaultCalibrator><PolynomialCalibrator>'
        f"{listed}</PolynomialCalibrator></DefaultCalibrator></IntegerDataEncoding>"
    )


def unit_set(*units):
    listed = "".join(f"<Unit {more}>{text}</Unit>" for text, more in units)
    return f"<UnitSet>{listed}</UnitSet>"


@pytest.mark.parametrize(
    ("units", "symbol"),
    [
        ([("V", "")], "V"), ([("m", ""), ("s", 'power="-2"')], "m/s^2"),
        ([("m", 'power="2"')], "m^2"), ([("s", 'power="-1"')], "s^-1"),
        ([("N", ""), ("m", "")], "N.m"), ([("", ""), ("A", "")], "A"),
        ([("m", 'power="0.5"')], "m^0.5"), ([("m", 'power="x"')], "m"),
        ([("none", "")], None), ([], None),
    ],
)  # fmt: skip
def test_units_have_their_powers(units, symbol):
    assert keys("Integer", INTEGER + unit_set(*units)).get("unit") == symbol


def test_the_unit_is_that_of_the_nearest_type_that_has_one():
    def base(name, more, *units):
        return (
            f'<IntegerParameterType name="{name}" {more}>{unit_set(*units)}'
            "<IntegerDataEncoding/></IntegerParameterType>"
        )

    others = base("far", "", ("A", "")) + base("near", 'baseType="far"', ("V", ""))
    assert keys("Integer", unit_set(), 'baseType="near"', others) == {
        "type": "uint",
        "unit": "V",
    }


def test_types_are_not_based_on_themselves_or_on_more_than_20_others():
    read = Read("Integer", "", 'baseType="T_Type"')
    assert read.why == "the type `T_Type` is based on itself"

    def is_read(count):
        others = "".join(
            f'<IntegerParameterType name="b{number}" baseType="b{number + 1}"/>'
            for number in range(1, count)
        )
        last = f'<IntegerParameterType name="b{count}"/>'
        return Read("Integer", INTEGER, 'baseType="b1"', others + last).why is None

    # With the type itself, there are 20.
    assert_limits(is_read, most=19)


def valid(more, outer=""):
    inner = f"<ValidRange {more}/>"
    return f"<ValidRangeSet {outer}>{inner}</ValidRangeSet>"


RAW = 'validRangeAppliesToCalibrated="false"'


@pytest.mark.parametrize(
    ("inner", "limits"),
    [
        ('<ValidRange minInclusive="1" maxInclusive="9"/>', {"min": 1, "max": 9}),
        (valid('minExclusive="0" maxExclusive="2.5"'), {"above": 0, "below": 2.5}),
        (valid('minInclusive="-0.0"'), {"min": 0}),
        (valid('minInclusive="x" maxInclusive="4"'), {"max": 4}),
        (valid('minInclusive="1e-9" maxInclusive="1e3"'), {"max": 1000}),
        (valid('minInclusive="1"') + valid('maxInclusive="2"'), {}),
        (valid('minInclusive="1"', RAW), {"min": 1}), ("", {}),
    ],
)  # fmt: skip
def test_a_valid_range_is_the_limits_of_a_number(inner, limits):
    assert keys("Integer", INTEGER + inner) == {"type": "uint", **limits}


@pytest.mark.parametrize(
    ("range_", "limits"),
    [
        (valid('minInclusive="1"'), {"min": 1}),
        (valid('minInclusive="1"', 'validRangeAppliesToCalibrated="true"'), {"min": 1}),
        (valid('minInclusive="1"', RAW), {}),
        (f'<ValidRange minInclusive="1" {RAW}/>', {}),
    ],
)
def test_limits_of_raw_values_are_none_of_calibrated_ones(range_, limits):
    assert keys("Float", calibrated(0, 2) + range_) == {
        "type": "uint",
        "formula": "raw*2",
        **limits,
    }


def table(*pairs):
    listed = "".join(f'<SplinePoint raw="{x}" calibrated="{y}"/>' for x, y in pairs)
    spline = f"<SplineCalibrator>{listed}</SplineCalibrator>"
    return INTEGER.replace("/>", ">") + (
        f"<DefaultCalibrator>{spline}</DefaultCalibrator></IntegerDataEncoding>"
    )


def test_a_lookup_table_of_all_raw_values_is_complete_and_has_no_raw_limits():
    points = [[0, 0], [128, 10], [255, 5]]
    item = {"type": "uint", "points": points}
    range_ = valid('minInclusive="1"', RAW)
    assert keys("Float", table(*points) + range_) == item
    assert keys("Float", table(*points) + valid('minInclusive="1"')) == item | {
        "min": 1
    }
    part = points[:2]
    assert keys("Float", table(*part)) == item | {"points": part, "outside": "refuse"}


def test_a_calibration_that_is_not_supported_leaves_the_raw_values_without_unit():
    encoding = "<ContextCalibratorList/>"
    inner = f"<IntegerDataEncoding>{encoding}</IntegerDataEncoding>"
    read = Read("Integer", inner + unit_set(("V", "")) + valid('minInclusive="1"'))
    assert read.field.item == {"type": "uint"} and not read.field.is_raw
    why = "its calibration depends on other parameters"
    assert read.findings == [f"`P` (message ``): {why}"]
    assert read.to.import_findings[0].help == (
        "its raw values are imported, without the unit"
    )


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("", {"unit": "s"}),
        ('units="seconds" scale="0.5" offset="10"',
         {"formula": "raw*0.5 + 10", "unit": "s"}),
        ('units="days"', {"unit": "days"}), ('scale="1" offset="0"', {"unit": "s"}),
        ('offset="-3"', {"formula": "raw - 3", "unit": "s"}),
    ],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["AbsoluteTime", "RelativeTime"])
def test_a_time_has_scale_offset_and_unit(more, expected, kind):
    inner = f"<Encoding {more}>{INTEGER}</Encoding>"
    assert keys(kind, inner) == {"type": "uint", **expected}


def test_special_values_are_those_that_icdgen_wrote():
    listed = "".join(
        f'<AncillaryData name="ICD {name}">{text}</AncillaryData>'
        for name, text in {
            "special nan": "unknown", "special -inf": "too low", "special 255": "none",
            "special 1.5": "half", "special 1e3": "many", "special x": "no number",
            "special 7": "", "other 8": "another",
        }.items()
    )  # fmt: skip
    root = safe_xml.parse(
        "a.xml",
        f"<Parameter><AncillaryDataSet>{listed}</AncillaryDataSet>"
        "</Parameter>".encode(),
        account=Account(),
    )
    assert special_values(root) == {
        "special": [
            {"value": "nan", "meaning": "unknown"},
            {"value": "-inf", "meaning": "too low"},
            {"value": 255, "meaning": "none"},
            {"value": 1.5, "meaning": "half"},
            {"value": 1000.0, "meaning": "many"},
        ]
    }
    assert special_values(safe_xml.parse("a.xml", b"<Parameter/>")) == {}


@pytest.mark.parametrize(
    ("short", "long", "summary"),
    [
        ("Speed", "It is measured", "Speed. It is measured."),
        ("Speed?", "Measured!", "Speed? Measured!"),
        ("Speed", "Speed of the wheel", "Speed of the wheel"),
        ("Speed of the wheel", "Speed", "Speed of the wheel"), ("Speed", None, "Speed"),
        (None, "Measured", "Measured"),
    ],
)  # fmt: skip
def test_a_summary_has_both_descriptions_without_repetition(short, long, summary):
    attribute = "" if short is None else f'shortDescription="{short}"'
    inner = "" if long is None else f"<LongDescription>{long}</LongDescription>"
    element = safe_xml.parse("a.xml", f"<P {attribute}>{inner}</P>".encode())
    empty = safe_xml.parse("a.xml", b"<P/>")
    assert described(empty, element) == {"summary": summary}
    other = safe_xml.parse("a.xml", b'<P shortDescription="Other"/>')
    assert described(element, other) == {"summary": summary}
    assert described(empty) == {}
