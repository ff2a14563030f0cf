"""Containers of electronic data sheets become fields in the order of the frame: headers,
bodies and trailers, arrays, lists, and lengths that count.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.eds_layout import EdsLayout, Structs
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.eds_types import EdsTypes
from icdgen.definitions.model import Definitions, NotSupported
from tests.limits import assert_limits


def integer(name, bits, more="", inner=""):
    return (
        f'<IntegerDataType name="{name}"><IntegerDataEncoding sizeInBits="{bits}"'
        f' encoding="unsigned" {more}/>{inner}</IntegerDataType>'
    )


FEW = '<Range><MinMaxRange min="0" max="{}" rangeType="inclusiveMinInclusiveMax"/></Range>'
TYPES = (
    integer("byte", 8)
    + integer("nibble", 4)
    + integer("word", 16)
    + integer("little", 16, 'byteOrder="littleEndian"')
    + integer("few", 8, inner=FEW.format(9))
    + integer("none", 8, inner=FEW.format(0))
    + '<StringDataType name="open" length="9" fixedLength="false"/>'
    + '<BinaryDataType name="big" sizeInBits="524280" fixedSize="false"/>'
    + '<EnumeratedDataType name="axis"><EnumerationList>'
    '<Enumeration label="X" value="1"/><Enumeration label="Z" value="3"/>'
    "</EnumerationList></EnumeratedDataType>"
)


def container(entries, name="Main", trailers="", more="", inner=""):
    trailer = f"<TrailerEntryList>{trailers}</TrailerEntryList>" if trailers else ""
    return (
        f'<ContainerDataType name="{name}" {more}>{inner}'
        f"<EntryList>{entries}</EntryList>{trailer}</ContainerDataType>"
    )


def entry(type_, name, tag="Entry", inner="", more=""):
    return f'<{tag} name="{name}" type="{type_}" {more}>{inner}</{tag}>'


def array(name, of, *dimensions):
    inner = "".join(f"<Dimension {dimension}/>" for dimension in dimensions)
    return (
        f'<ArrayDataType name="{name}" dataTypeRef="{of}">'
        f"<DimensionList>{inner}</DimensionList></ArrayDataType>"
    )


def layout_of(main, types=""):
    """Return the layout of the container `Main`."""
    text = (
        '<PackageFile><Package name="p"><DataTypeSet>'
        f"{TYPES}{types}{main}</DataTypeSet></Package></PackageFile>"
    )
    to = Definitions("a.xml")
    root = safe_xml.parse("a.xml", text.encode(), account=Account())
    sheets = Sheets(root, (), to)
    layout = EdsLayout(sheets, EdsTypes(to, sheets), Structs())
    (element,) = (e for e in root.iter("ContainerDataType") if e.get("name") == "Main")
    layout.read(element)
    return layout


def rows(main, types="", start=0):
    """Return the name and position of each field."""
    fields = layout_of(main, types).fields(start)
    return [(field["name"], field["at"]) for field in fields]


def lost(main, types=""):
    """Return the reason why only bytes follow the first field."""
    layout = layout_of(main, types)
    assert len(layout.parts) == 2
    return str(layout.lost.why)


def failure(main, types=""):
    with pytest.raises(NotSupported) as caught:
        layout_of(main, types)
    return str(caught.value)


def test_trailers_follow_the_entries_from_the_derived_container_outwards():
    base = container(entry("byte", "A"), "Base", entry("byte", "Z"))
    middle = container(
        entry("byte", "B"), "Middle", entry("byte", "Y"), 'baseType="Base"'
    )
    main = container(
        entry("byte", "C"), "Main", entry("byte", "X"), 'baseType="Middle"'
    )
    names = [name for name, _ in rows(main, base + middle)]
    assert names == ["A", "B", "C", "X", "Y", "Z"]


def test_padding_moves_the_next_entry():
    pad = '<PaddingEntry sizeInBits="{}"/>'
    main = container(entry("nibble", "A") + pad.format(12) + entry("byte", "B"))
    assert rows(main) == [("A", 0), ("B", 16)]
    assert rows(main, start=16) == [("B", 0)]
    assert layout_of(container(entry("byte", "A") + pad.format(0))).at == 8
    assert layout_of(container(pad.format(8 * 65535))).length == 65535
    assert lost(container(entry("byte", "A") + pad.format(8 * 65535 + 1))) == (
        "the size of a padding is `524281`"
    )


def test_entries_of_a_nested_container_have_their_shortest_distinct_name():
    inner = container(entry("byte", "Level") + entry("byte", "value"), "Inner")
    main = container(entry("Inner", "First") + entry("Inner", "Second"))
    names = [name for name, _ in rows(main, inner)]
    assert len(set(names)) == 4
    assert names[1].endswith("First value") and names[3].endswith("Second value")
    single = [name for name, _ in rows(container(entry("Inner", "First")), inner)]
    assert single == ["Level", "First value"]


def test_an_array_has_the_product_of_its_dimensions():
    types = array("grid", "word", 'size="2"', 'size="3"') + array(
        "more", "grid", 'size="4"'
    )
    dimension = "<ArrayDimensions><Dimension size='5'/></ArrayDimensions>"
    main = container(entry("more", "A") + entry("byte", "B", inner=dimension))
    a, b = layout_of(main, types).fields(0)
    assert (a["count"], a["bits"], b["at"], b["count"]) == (24, 16, 24 * 16, 5)


def test_the_index_of_an_array_is_a_range_or_an_enumeration():
    types = array("ranged", "byte", 'indexTypeRef="few"')
    types += array("named", "byte", 'indexTypeRef="axis"')
    main = container(entry("ranged", "A") + entry("named", "B"))
    counts = [field["count"] for field in layout_of(main, types).fields(0)]
    # 0 to 9; and 1 to 3, although 2 has no label.
    assert counts == [10, 3]


@pytest.mark.parametrize(
    "bounds",
    ['min="3" rangeType="atLeast"', 'max="3" rangeType="atMost"', 'min="3" max="2"'],
)
def test_an_index_without_a_number_of_elements_is_refused(bounds):
    index = integer("index", 8, inner=f"<Range><MinMaxRange {bounds}/></Range>")
    types = index + array("many", "byte", 'indexTypeRef="index"')
    assert lost(container(entry("byte", "A") + entry("many", "B")), types) == (
        "the definition does not state how many elements `B` has"
    )


def test_an_index_of_one_value_has_one_element():
    index = integer("index", 8, inner='<Range><MinMaxRange min="3" max="3"/></Range>')
    types = index + array("single", "byte", 'indexTypeRef="index"')
    layout = layout_of(container(entry("single", "A") + entry("byte", "B")), types)
    assert layout.at == 16


def test_an_array_has_at_most_524280_elements_in_all_dimensions():
    def is_read(*sizes):
        types = array("many", "byte", *(f'size="{size}"' for size in sizes))
        layout = layout_of(container(entry("byte", "A") + entry("many", "B")), types)
        why = "" if layout.lost is None else str(layout.lost.why)
        return "is an array of" not in why and "a dimension of" not in why

    assert_limits(is_read, least=1, most=8 * 65535)
    assert_limits(lambda size: is_read(8, size), most=65535)


def test_arrays_of_many_bytes_are_bytes_and_others_have_at_most_1024_elements():
    def field(of, size):
        types = array("many", of, f'size="{size}"')
        return layout_of(container(entry("many", "A")), types).fields(0)[0]

    assert field("byte", 1024) == {
        "at": 0, "bits": 8, "name": "A", "type": "uint", "count": 1024,
    }  # fmt: skip
    assert field("byte", 1025) == {"at": 0, "bits": 8200, "name": "A", "type": "bytes"}

    def is_accepted(size):
        try:
            return field("word", size)["count"] == size
        except NotSupported as why:
            assert str(why) == f"`A` is an array of {size:,} elements"
            return False

    assert_limits(is_accepted, most=1024)


def test_an_array_of_containers_is_one_of_structs():
    inner = container(entry("byte", "x") + entry("little", "y"), "Point")
    types = inner + array("points", "Point", 'size="3"')
    main = container(entry("byte", "N") + entry("points", "A") + entry("points", "B"))
    layout = layout_of(main, types)
    assert layout.fields(0)[1:] == [
        {"at": 8, "name": "A", "struct": "Point", "count": 3},
        {"at": 80, "name": "B", "struct": "Point", "count": 3},
    ]
    (struct,) = layout.structs.items.values()
    assert struct == {
        "name": "Point",
        "length": 3,
        "fields": [
            {"at": 0, "bits": 8, "name": "x", "type": "uint"},
            {"at": 8, "bits": 16, "name": "y", "type": "uint", "byte_order": "little"},
        ],
    }


def test_a_struct_whose_name_is_used_has_its_package_in_front():
    types = container(entry("byte", "x"), "Point") + array(
        "points", "Point", 'size="3"'
    )
    main = container(entry("points", "A"))
    text = (
        f'<PackageFile><Package name="p"><DataTypeSet>{TYPES}{types}{main}'
        "</DataTypeSet></Package></PackageFile>"
    )
    to = Definitions("a.xml")
    root = safe_xml.parse("a.xml", text.encode(), account=Account())
    sheets = Sheets(root, (), to)
    structs = Structs(names={"Point"})
    layout = EdsLayout(sheets, EdsTypes(to, sheets), structs)
    layout.read(next(e for e in root.iter() if e.get("name") == "Main"))
    assert layout.fields(0)[0]["struct"] == "p Point"
    assert structs.names == {"Point", "p Point"}


def counted(type_, of="byte", more=""):
    length = entry(of, "N")
    return container(
        length + entry(type_, "L", "ListEntry", more='listLengthField="N"') + more
    )


@pytest.mark.parametrize(
    ("of", "most"), [("byte", 255), ("few", 9), ("none", 1), ("word", 1024)]
)
def test_a_list_has_the_most_elements_of_its_length_field(of, most):
    field = layout_of(counted("word", of)).fields(0)[1]
    assert field == {
        "at": 16 if of == "word" else 8, "name": "L", "bits": 16, "type": "uint",
        "count": "N", "up_to": most,
    }  # fmt: skip


def test_a_list_of_little_endian_numbers_or_of_structs_is_an_array():
    field = layout_of(counted("little")).fields(0)[1]
    assert (field["byte_order"], field["bits"]) == ("little", 16)
    inner = container(entry("byte", "x"), "Point")
    assert layout_of(counted("Point"), inner).fields(0)[1] == {
        "at": 8, "name": "L", "struct": "Point", "count": "N", "up_to": 255,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("main", "why"),
    [
        (
            container(entry("byte", "A") + entry("byte", "L", "ListEntry",
                      more='listLengthField="N"')),
            "`L` is there as often as `N` says, which is not a number in front of it",
        ),
        (
            container(entry("little", "N") + entry("nibble", "L", "ListEntry",
                      more='listLengthField="N"')),
            "`L` is a list of elements without a fixed number of bytes",
        ),
        (
            container(entry("byte", "N") + entry("byte", "L", "ListEntry",
                      "<ArrayDimensions><Dimension size='2'/></ArrayDimensions>",
                      'listLengthField="N"')),
            "`L` is a list of arrays, or begins within a byte",
        ),
        (
            container(entry("byte", "N") + entry("byte", "A",
                      inner="<PresentWhen/>")),
            "`A` is present only on a condition",
        ),
        (
            container(entry("byte", "N") + "<OddEntry name='A'/>"),
            "it has a `OddEntry`",
        ),
    ],
)  # fmt: skip
def test_entries_that_an_icd_cannot_represent_become_bytes(main, why):
    assert lost(main) == why


def test_fields_behind_a_list_have_whole_bytes_and_are_not_padded():
    names = [name for name, _ in rows(counted("byte", more=entry("word", "Z")))]
    assert names == ["N", "L", "Z"]
    assert failure(counted("byte", more=entry("nibble", "Z"))) == (
        "`Z` follows `L`, whose length is not fixed, and does not have whole bytes"
    )
    assert failure(counted("byte", more='<PaddingEntry name="Z" sizeInBits="8"/>')) == (
        "`Z` follows `L`, whose length is not fixed"
    )
    assert failure(counted("byte", more=entry("open", "Z"))) == (
        "`Z` follows `L`, and no field counts both"
    )


def length(inner="", type_="byte", name="N"):
    return entry(type_, name, "LengthEntry", inner)


def terms(*pairs):
    inner = "".join(f'<Term exponent="{e}" coefficient="{c}"/>' for e, c in pairs)
    return f"<PolynomialCalibrator>{inner}</PolynomialCalibrator>"


@pytest.mark.parametrize(
    ("inner", "size"),
    [
        ("", {"field": "N", "plus": -2}),  # 2 bytes are fixed
        (terms((1, 1), (0, 2)), "N"),
        (terms((1, 1), (0, 7)), {"field": "N", "plus": 5}),
        (terms((1, 2)), "rest"),
        (terms((1, 1), (0, "1/2")), "rest"),
    ],
)
def test_a_length_entry_counts_the_bytes_that_are_not_fixed(inner, size):
    main = container(length(inner) + entry("byte", "A") + entry("open", "T"))
    layout = layout_of(main)
    assert not layout.is_open  # the length states where the frame ends
    field = layout.fields(0)[2]
    assert (field["at"], field["size"], field["up_to"]) == (16, size, 9)


def test_fields_behind_count_as_fixed_bytes():
    main = container(length() + entry("open", "T") + entry("word", "CRC"))
    fields = layout_of(main).fields(0)
    assert fields[1]["size"] == {"field": "N", "plus": -3}
    assert fields[2] == {
        "at": 8, "after": "T", "bits": 16, "name": "CRC", "type": "uint",
    }  # fmt: skip


def test_without_a_length_a_field_extends_to_the_end():
    layout = layout_of(container(entry("byte", "A") + entry("open", "T")))
    assert layout.is_open
    assert layout.fields(0)[1]["size"] == "rest"
    big = layout_of(container(entry("byte", "A") + entry("big", "T"))).fields(0)[1]
    assert big["up_to"] == 65535 - 1


def test_the_length_of_a_fixed_container_is_a_constant():
    fields = layout_of(container(length() + entry("word", "A"))).fields(0)
    assert fields[0]["const"] == 3
    # 9 bytes and a half
    parts = "".join(entry("word", name) for name in "ABCD") + entry("nibble", "N")
    assert layout_of(container(length() + parts)).fields(0)[0]["const"] == 10
    fields = layout_of(container(length() + entry("open", "T"))).fields(0)
    assert "const" not in fields[0]


def test_a_container_begins_with_a_message_id_or_not():
    key, bits = layout_of(container(entry("word", "A") + entry("byte", "B"))).front()
    assert (key[0], bits) == (("A",), 16)
    assert layout_of(container(entry("nibble", "A"))).front() is None
    assert layout_of(container(entry("little", "A"))).front() is None
    assert layout_of(container("")).front() is None


PRIMARY = "".join(
    integer(f"u{bits}", bits) for bits in (1, 2, 3, 11, 14)
)  # fmt: skip


def packet(inner="", tag="Entry"):
    bits = (("u3", "V"), ("u1", "T"), ("u1", "S"), ("u11", "APID"), ("u2", "F"),
            ("u14", "C"))  # fmt: skip
    entries = "".join(entry(type_, name) for type_, name in bits)
    return container(entries + entry("word", "L", tag, inner) + entry("byte", "D"))


def test_a_primary_header_has_the_length_of_ccsds():
    assert layout_of(packet(), PRIMARY).header() is not None
    for pairs, is_header in (
        (((1, 1), (0, 7)), True),
        (((1, 1), (0, 6)), False),
        (((1, 2), (0, 7)), False),
    ):
        layout = layout_of(packet(terms(*pairs), "LengthEntry"), PRIMARY)
        assert (layout.header() is not None) == is_header, pairs
    assert layout_of(container(entry("word", "A"))).header() is None


def test_a_fixed_value_is_a_constant_but_not_in_an_array():
    fixed = entry("byte", "F", "FixedValueEntry", more='fixedValue="7"')
    assert layout_of(container(fixed)).fields(0)[0]["const"] == 7
    dimension = "<ArrayDimensions><Dimension size='2'/></ArrayDimensions>"
    several = entry("byte", "F", "FixedValueEntry", dimension, 'fixedValue="7"')
    assert lost(container(entry("byte", "A") + several)) == (
        "`F` is an array of elements of variable length, or of a constant"
    )
    text = entry("open", "T", inner=dimension)
    assert lost(container(entry("byte", "A") + text)) == (
        "`T` is an array of elements of variable length, or of a constant"
    )


@pytest.mark.parametrize(
    ("kind", "text", "summary"),
    [
        ('errorControlType="CRC8"', "", "CRC8."),
        ("", "", "an error control."),
        ('errorControlType="CRC8"', "Of all bytes", "Of all bytes. CRC8."),
        ('errorControlType="CRC8"', "Of all bytes!", "Of all bytes! CRC8."),
    ],
)
def test_an_error_control_is_a_field_that_nothing_checks(kind, text, summary):
    more = f'{kind} shortDescription="{text}"'
    layout = layout_of(container(entry("byte", "C", "ErrorControlEntry", more=more)))
    assert layout.fields(0)[0]["summary"] == summary
    (finding,) = layout.types.to.import_findings
    name = summary.removesuffix(".").rpartition(". ")[2].rpartition("! ")[2]
    assert (finding.code, finding.message) == (
        "IMP082",
        f"`C` is {name} of what is in the frame",
    )


def test_an_abstract_container_and_an_entry_without_a_name_are_named_in_reasons():
    any_ = container(entry("byte", "x"), "Any", more='abstract="true"')
    assert lost(container(entry("byte", "A") + entry("Any", "Q")), any_) == (
        "`Q` is any container that is based on `Any`"
    )
    nameless = container(entry("byte", "A") + '<Entry type="Any"/>')
    layout = layout_of(nameless, any_)
    assert layout.lost.name == "unnamed 8"
    assert str(layout.lost.why) == (
        "`unnamed 8` is any container that is based on `Any`"
    )
