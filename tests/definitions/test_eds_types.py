"""Types of electronic data sheets become fields: encodings with their defaults, labels,
flags, ranges, calibrations and units.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import EdsFieldType, EdsTypes, described
from icdgen.definitions.frames import BIG, LITTLE
from icdgen.definitions.model import Definitions, NotSupported
from tests.limits import assert_limits

BYTE = '<IntegerDataEncoding sizeInBits="8"/>'
BITS_ONLY = "its raw bits are imported as a number, without unit and limits"


class Read:
    """Type of this kind and content, read as the field of an entry."""

    def __init__(self, kind, inner="", more="", entry="<Entry/>", others=""):
        own = f'<{kind}DataType name="T_Type" {more}>{inner}</{kind}DataType>'
        text = (
            '<PackageFile><Package name="a/probe"><DataTypeSet>'
            f"{own}{others}</DataTypeSet></Package></PackageFile>"
        )
        root = safe_xml.parse("a.xml", text.encode(), account=Account())
        self.to = Definitions("a.xml")
        sheets = Sheets(root, (), self.to)
        self.types = EdsTypes(self.to, sheets)
        self.type = sheets.find_element("type", "T_Type", sheets.own[0])
        self.entry = safe_xml.parse("a.xml", entry.encode(), account=Account())
        self.field = self.why = None
        try:
            self.field = self.types.field_type(self.type, self.entry, "`P`")
        except NotSupported as why:
            self.why = str(why)

    @property
    def findings(self):
        self.types.report_raw_only()
        return [(each.message, each.help) for each in self.to.import_findings]

    @property
    def enums(self):
        return self.types.enums.declared()


def integer(more=""):
    return f'<IntegerDataEncoding sizeInBits="16" {more}/>'


def real(precision, bits="", more=""):
    size = f'sizeInBits="{bits}"' * bool(bits)
    keyword = f'encodingAndPrecision="{precision}"' * bool(precision)
    return f"<FloatDataEncoding {keyword} {size} {more}/>"


def summary_of(field):
    return (field.item, field.bits, field.order, field.code)


@pytest.mark.parametrize(
    ("kind", "inner", "more", "expected"),
    [
        ("Integer", integer(), "", ({"type": "uint"}, 16, BIG, "unsigned")),
        ("Integer", integer('encoding="TWOSCOMPLEMENT" byteOrder="LittleEndian"'), "",
         ({"type": "int"}, 16, LITTLE, "twosComplement")),
        ("Float", real(""), "", ({"type": "float"}, 32, BIG, "unsigned")),
        ("Float", real("IEEE754_2008_double", more='byteOrder="littleEndian"'), "",
         ({"type": "float"}, 64, LITTLE, "unsigned")),
        ("Float", real("ieee754_2008_SINGLE", 32), "", ({"type": "float"}, 32, BIG,
         "unsigned")),
        ("Boolean", "", "", ({"type": "bool"}, 1, BIG, "")),
        ("Boolean", '<BooleanDataEncoding sizeInBits="1" falseValue="zeroIsFalse"/>',
         "", ({"type": "bool"}, 1, BIG, "")),
        ("String", "", 'length="5"', ({"type": "text"}, 40, BIG, "unsigned")),
        ("String", '<StringDataEncoding terminationCharacter="0"/>',
         'length="5" fixedLength="TRUE"', ({"type": "text"}, 40, BIG, "unsigned")),
        ("String", "", 'length="5" fixedLength="0"', ({"type": "text", "up_to": 5}, 0,
         BIG, "unsigned")),
        ("Binary", "", 'sizeInBits="16"', ({"type": "bytes"}, 16, BIG, "")),
        ("Binary", "", 'sizeInBits="12"', ({"type": "uint"}, 12, BIG, "unsigned")),
        ("Binary", "", 'sizeInBits="80"', ({"type": "bytes"}, 80, BIG, "")),
        ("Binary", "", 'sizeInBits="80" fixedSize="False"', ({"type": "bytes",
         "up_to": 10}, 0, BIG, "unsigned")),
    ],
)  # fmt: skip
def test_a_type_has_keys_bits_order_and_encoding(kind, inner, more, expected):
    read = Read(kind, inner, more)
    assert (read.why, read.findings) == (None, [])
    assert summary_of(read.field) == expected


@pytest.mark.parametrize(
    "code", ["onesComplement", "signMagnitude", "BCD", "packedBCD"]
)
def test_another_encoding_of_integers_leaves_the_raw_bits_without_limits(code):
    range_ = '<Range><MinMaxRange min="1" max="5"/></Range>'
    read = Read("Integer", integer(f'encoding="{code}"') + range_)
    assert summary_of(read.field) == ({"type": "uint"}, 16, BIG, code)
    assert read.findings == [(f"`P` (message ``): it is encoded as {code}", BITS_ONLY)]


@pytest.mark.parametrize(
    ("inner", "item", "bits", "reason"),
    [
        (real("MILSTD_1750A_simple", 32), "uint", 32, "MILSTD_1750A_simple of 32 bits"),
        (real("IEEE754_2008_single", 64), "uint", 64, "IEEE754_2008_single of 64 bits"),
        (real("IEEE754_2008_quad", 128), "bytes", 128, "IEEE754_2008_quad of 128 bits"),
    ],
)
def test_another_encoding_of_floats_leaves_the_raw_bits(inner, item, bits, reason):
    unit = '<Semantics unit="volt"/>'
    read = Read("Float", inner + unit)
    assert summary_of(read.field) == ({"type": item}, bits, BIG, "")
    assert read.findings == [
        (f"`P` (message ``): it is encoded as {reason}", BITS_ONLY)
    ]


def test_an_integer_above_64_bits_is_bytes():
    def is_number(bits):
        inner = f'<IntegerDataEncoding sizeInBits="{bits}"/>'
        return Read("Integer", inner).field.item["type"] == "uint"

    assert_limits(is_number, most=64, step=8)
    assert Read("Integer", '<IntegerDataEncoding sizeInBits="65"/>').why == (
        "`P` has 65 bits"
    )


@pytest.mark.parametrize(
    ("kind", "inner", "more", "why"),
    [
        ("Integer", "", "", "`P` has a type without an encoding"),
        ("Integer", real(""), "", "`P` has a type without an encoding"),
        ("Float", BYTE, "", "`P` has a type without an encoding"),
        ("Integer", "<IntegerDataEncoding/>", "", "the size of `P` is ``"),
        ("Integer", '<IntegerDataEncoding sizeInBits="0"/>', "",
         "the size of `P` is `0`"),
        ("Integer", integer('encoding="gray"'), "", "its `encoding` is `gray`"),
        ("Integer", '<IntegerDataEncoding sizeInBits="12" byteOrder="littleEndian"/>',
         "", "the least significant byte of `P`, of 12 bits, is sent first"),
        ("Integer", integer('byteOrder="middle"'), "", "its `byteOrder` is `middle`"),
        ("Float", real("IEEE754_2008_quad"), "", "the size of `P` is ``"),
        ("Boolean", '<BooleanDataEncoding sizeInBits="72"/>', "",
         "the flag `T_Type` has 72 bits"),
        ("String", "", "", "the length of a text is ``"),
        ("String", "", 'length="0"', "the length of a text is `0`"),
        ("String", '<StringDataEncoding terminationCharacter="10"/>',
         'length="5" fixedLength="false"', "`T_Type` ends at the character `10`"),
        ("Binary", "", 'sizeInBits="12" fixedSize="0"', "`T_Type` has up to 12 bits"),
        ("Binary", "", 'sizeInBits="68"', "`T_Type` has 68 bits"),
        ("Odd", "", "", "`P` is a `OddDataType`"),
        (
            "Enumerated",
            BYTE + '<EnumerationList><Enumeration label="A" value="256"/>'
            "</EnumerationList>",
            "",
            "`P` never has the value `256` of `A`",
        ),
        (
            "Enumerated",
            '<IntegerDataEncoding sizeInBits="72"/><EnumerationList>'
            '<Enumeration label="A" value="1"/></EnumerationList>',
            "",
            "`P` never has the value `1` of `A`",
        ),
    ],
)  # fmt: skip
def test_another_type_is_refused_with_the_reason(kind, inner, more, why):
    assert Read(kind, inner, more).why == why


def test_the_encoding_of_an_entry_precedes_that_of_its_type():
    entry = f"<Entry>{integer()}</Entry>"
    assert Read("Integer", BYTE, entry=entry).field.bits == 16
    assert Read("Integer", BYTE).field.bits == 8


SUBRANGES = (
    '<SubRangeDataType name="T{0}_" baseType="{1}"><Range><MinMaxRange min="{2}" '
    'max="{3}" rangeType="inclusiveMinInclusiveMax"/></Range></SubRangeDataType>'
)


def subrange(base, low, high, others, entry="<Entry/>"):
    inner = f'<Range><MinMaxRange min="{low}" max="{high}"/></Range>'
    return Read("SubRange", inner, f'baseType="{base}"', entry, others)


def test_a_subrange_has_the_intersection_of_all_ranges():
    base = f'<IntegerDataType name="base">{BYTE}</IntegerDataType>'
    others = base + SUBRANGES.format(1, "base", 10, 90)
    read = subrange("T1_", 20, 200, others)
    assert read.field.item == {"type": "uint", "min": 20, "max": 90}
    entry = '<Entry><ValidRange><MinMaxRange min="0" max="50"/></ValidRange></Entry>'
    read = subrange("T1_", 20, 200, others, entry)
    assert read.field.item == {"type": "uint", "min": 20, "max": 50}


def test_subranges_are_not_based_on_themselves_or_on_too_many_others():
    why = "the type `T_Type` is based on itself, or on too many others"
    assert subrange("T_Type", 0, 1, "").why == why

    def is_read(count):
        base = f'<IntegerDataType name="T{count}_">{BYTE}</IntegerDataType>'
        others = "".join(
            SUBRANGES.format(number, f"T{number + 1}_", 0, 9)
            for number in range(1, count)
        )
        return subrange("T1_", 0, 1, base + others).why is None

    # With the type itself, there are 20.
    assert_limits(is_read, most=19)


def labelled(*labels, encoding=BYTE):
    listed = "".join(
        f'<Enumeration label="{label}"' + (f' value="{value}"/>' if value else "/>")
        for label, value in labels
    )
    return encoding + f"<EnumerationList>{listed}</EnumerationList>"


def test_labels_are_an_enumeration_of_the_transmitted_values():
    read = Read(
        "Enumerated", labelled(("On", "3"), ("Off", "0"), ("X", "3"), ("Y", ""))
    )
    # Of labels of equal value, the first one is the name.
    assert read.enums == [
        {
            "name": "T",
            "members": [
                {"value": 0, "name": "Off"},
                {"value": 3, "name": "On"},
                {"value": 4, "name": "Y"},
            ],
        }
    ]
    assert read.field.item == {"type": "enum", "enum": "T"}
    assert read.field.values == {"On": 3, "Off": 0, "X": 3, "Y": 4}
    bcd = '<IntegerDataEncoding sizeInBits="16" encoding="packedBCD"/>'
    read = Read("Enumerated", labelled(("A", "10"), encoding=bcd))
    assert read.field.values == {"A": 0x10} and read.findings == []
    assert [member["value"] for member in read.enums[0]["members"]] == [0x10]


def test_an_enumeration_without_labels_is_a_number():
    read = Read("Enumerated", BYTE)
    assert read.field.item == {"type": "uint"} and read.enums == []


def test_two_enumerations_of_a_name_have_their_package_in_front():
    read = Read("Enumerated", labelled(("A", "1")))
    read.types.enums.assign_enumeration({}, "T", "x", [{"value": 0, "name": "B"}])
    assert [enum["name"] for enum in read.enums] == ["probe T", "x T"]


@pytest.mark.parametrize(
    ("inner", "bits", "names"),
    [
        ('<BooleanDataEncoding sizeInBits="8"/>', 8, ("False", "True")),
        ('<BooleanDataEncoding sizeInBits="1" falseValue="nonZeroIsFalse"/>', 1,
         ("True", "False")),
    ],
)  # fmt: skip
def test_a_wide_or_inverse_flag_is_an_enumeration(inner, bits, names):
    read = Read("Boolean", inner)
    members = [{"value": value, "name": name} for value, name in enumerate(names)]
    assert read.enums == [{"name": "T", "members": members}]
    assert read.field.item == {"type": "enum", "enum": "T"}
    assert read.field.bits == bits and not read.findings
    assert [read.field.raw(name, "`P`") for name in names] == [0, 1]
    assert read.field.raw(names[1].upper(), "`P`") == 1


def test_a_value_is_a_label_or_an_integer_of_the_encoding():
    field = EdsFieldType({"type": "enum"}, 8, values={"On": 3, "7": 9})
    assert [field.raw(text, "`P`") for text in ("On", "7", "8", "0x10")] == [
        3,
        9,
        8,
        16,
    ]
    for text in ("on", "256", "-1", ""):
        with pytest.raises(NotSupported) as caught:
            field.raw(text, "`P`")
        assert str(caught.value) == f"`P` is never `{text}`"
    assert EdsFieldType({"type": "uint"}, 8, code="BCD").raw("9", "`P`") == 9
    flag = EdsFieldType({"type": "bool"}, 1, code="", values={"true": 1})
    assert flag.raw("TRUE", "`P`") == 1
    with pytest.raises(NotSupported, match="`P` is never `1`"):
        flag.raw("1", "`P`")
    with pytest.raises(NotSupported, match="`P` has a value and is of the type float"):
        EdsFieldType({"type": "float"}, 32).raw("1", "`P`")


POLYNOMIAL = (
    '<PolynomialCalibrator><Term coefficient="2" exponent="1"/></PolynomialCalibrator>'
)
RANGE = '<Range><MinMaxRange min="1" max="5"/></Range>'


def test_a_calibration_of_an_entry_is_a_formula_without_limits():
    unit = '<Semantics unit="volt"/>'
    inner = BYTE + RANGE + unit
    read = Read("Integer", inner, entry=f"<Entry>{POLYNOMIAL}</Entry>")
    assert read.field.item == {"type": "uint", "formula": "raw*2", "unit": "V"}
    read = Read("Integer", inner, entry=f"<LengthEntry>{POLYNOMIAL}</LengthEntry>")
    assert read.field.item == {"type": "uint", "unit": "V", "min": 1, "max": 5}


def test_a_calibration_that_is_not_supported_leaves_the_raw_bits():
    power = POLYNOMIAL.replace('exponent="1"', 'exponent="99"')
    unit = '<Semantics unit="volt"/>'
    read = Read("Integer", BYTE + RANGE + unit, entry=f"<Entry>{power}</Entry>")
    assert read.field.item == {"type": "uint"}
    ((text, help),) = read.findings
    assert text.startswith("`P` (message ``): it is calibrated by raw^99")
    assert help == BITS_ONLY


@pytest.mark.parametrize(
    ("inner", "more", "entry", "unit"),
    [
        ('<Semantics unit="Volt"/>', "", "<Entry/>", "V"),
        ('<Semantics unit="mV"/>', "", "<Entry/>", "mV"),
        ("", 'unit="metre"', "<Entry/>", "m"),
        ("", 'units="degreesCelsius"', "<Entry/>", "C"),
        ('<Semantics unit="volt"/>', "", '<Entry units="ampere"/>', "A"),
        ('<Semantics unit="volt"/>', 'unit="ampere"', "<Entry/>", "V"),
        ('<Semantics unit=""/>', 'unit="ampere"', "<Entry/>", "A"),
        ("<Semantics/>", "", "<Entry/>", None),
        ('<Semantics unit="none"/>', "", "<Entry/>", None),
    ],
)
def test_the_unit_is_that_of_the_entry_or_of_its_type(inner, more, entry, unit):
    read = Read("Integer", BYTE + inner, more, entry)
    assert read.field.item.get("unit") == unit


@pytest.mark.parametrize(
    ("short", "long", "summary"),
    [
        ("Speed", "It is measured", "Speed"),
        ("", "\n\n  First\n line \n \t\n Second", "First line"),
        ("@brief Speed", "", "Speed"), (r"\note", "Measured", "Measured"),
        ("a@b is \\not", "", "a@b is"), ("", "", None),
    ],
)  # fmt: skip
def test_a_summary_is_the_short_description_or_the_first_paragraph(
    short, long, summary
):
    element = safe_xml.parse(
        "a.xml",
        f'<E shortDescription="{short}"><LongDescription>{long}'
        "</LongDescription></E>".encode(),
    )
    assert described(element) == ({} if summary is None else {"summary": summary})
