"""Entries of XTCE containers get their positions, conditions and constants, or the
reason why an ICD cannot represent them.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.frames import BIG
from icdgen.definitions.model import Definitions, NotSupported
from icdgen.definitions.xtce_layout import XtceLayout
from icdgen.definitions.xtce_names import XtceNames
from icdgen.definitions.xtce_types import XtceTypes
from tests.limits import assert_limits

TYPES = """\
<IntegerParameterType name="byte"><IntegerDataEncoding/></IntegerParameterType>
<IntegerParameterType name="signed">
 <IntegerDataEncoding encoding="twosComplement"/></IntegerParameterType>
<IntegerParameterType name="nibble"><IntegerDataEncoding sizeInBits="4"/>
</IntegerParameterType>
<IntegerParameterType name="little"><IntegerDataEncoding sizeInBits="12"
 byteOrder="leastSignificantByteFirst"/></IntegerParameterType>
<IntegerParameterType name="short"><IntegerDataEncoding sizeInBits="4"
 byteOrder="leastSignificantByteFirst"/></IntegerParameterType>
<IntegerParameterType name="scaled"><IntegerDataEncoding><DefaultCalibrator>
 <PolynomialCalibrator><Term coefficient="2" exponent="1"/></PolynomialCalibrator>
</DefaultCalibrator></IntegerDataEncoding></IntegerParameterType>
<IntegerParameterType name="bcd"><IntegerDataEncoding encoding="BCD"/>
</IntegerParameterType>
<FloatParameterType name="float"><FloatDataEncoding sizeInBits="32"/>
</FloatParameterType>
<EnumeratedParameterType name="mode"><IntegerDataEncoding/><EnumerationList>
<Enumeration value="3" label="On"/><Enumeration value="4" label="5"/>
</EnumerationList></EnumeratedParameterType>
<ArrayParameterType name="bytes" arrayTypeRef="byte"><DimensionList><Dimension>
<StartingIndex><FixedValue>0</FixedValue></StartingIndex>
<EndingIndex><FixedValue>4</FixedValue></EndingIndex></Dimension></DimensionList>
</ArrayParameterType>
<BinaryParameterType name="rest"><BinaryDataEncoding><SizeInBits><DynamicValue>
<ParameterInstanceRef parameterRef="A"/></DynamicValue></SizeInBits></BinaryDataEncoding>
</BinaryParameterType>
<AggregateParameterType name="pair"><MemberList><Member name="x" typeRef="byte"/>
<Member name="y" typeRef="nibble"/></MemberList></AggregateParameterType>
"""
PARAMETERS = {
    "A": "byte", "B": "byte", "C": "byte", "S": "signed", "N": "nibble", "L": "little",
    "H": "short", "K": "scaled", "D": "bcd", "F": "float", "M": "mode", "R": "rest",
    "P": "pair", "Y": "bytes",
}  # fmt: skip


def system(containers):
    parameters = "".join(
        f'<Parameter name="{name}" parameterTypeRef="{type_}"/>'
        for name, type_ in PARAMETERS.items()
    )
    return (
        f'<SpaceSystem name="s"><TelemetryMetaData><ParameterTypeSet>{TYPES}'
        f"</ParameterTypeSet><ParameterSet>{parameters}</ParameterSet><ContainerSet>"
        f"{containers}</ContainerSet></TelemetryMetaData></SpaceSystem>"
    )


def container(entries, name="Main", more=""):
    return (
        f'<SequenceContainer name="{name}">{more}<EntryList>{entries}</EntryList>'
        "</SequenceContainer>"
    )


def entry(name, inner=""):
    return f'<ParameterRefEntry parameterRef="{name}">{inner}</ParameterRefEntry>'


def location(bits, origin=None):
    reference = f' referenceLocation="{origin}"' if origin else ""
    value = f"<FixedValue>{bits}</FixedValue>"
    return f"<LocationInContainerInBits{reference}>{value}</LocationInContainerInBits>"


def layout_of(entries, others="", more=""):
    """Return the layout of a container with these entries."""
    text = system(container(entries, more=more) + others)
    root = safe_xml.parse("a.xml", text.encode(), account=Account())
    to = Definitions("a.xml")
    names = XtceNames({"a.xml": root}, to)
    layout = XtceLayout(names=names, types=XtceTypes(to, names))
    layout.read(names.all("container")[0])
    return layout


def laid_out(entries, others="", more="", start=0):
    layout = layout_of(entries, others, more)
    message = {"name": "Main", "kind": "telemetry"}
    return layout.laid_out(message, start, BIG, layout.types.to)


def rows(entries, *keys, **more):
    """Return name, position, and these keys of each field."""
    fields = laid_out(entries, **more).get("fields", [])
    return [tuple(field.get(key) for key in ("name", "at", *keys)) for field in fields]


def failure(entries, others="", more=""):
    with pytest.raises(NotSupported) as caught:
        laid_out(entries, others, more)
    return str(caught.value)


def test_entries_follow_each_other():
    message = laid_out(entry("A") + entry("N") + entry("N") + entry("B"))
    assert message == {
        "name": "Main",
        "kind": "telemetry",
        "length": 3,
        "fields": [
            {"at": 0, "bits": 8, "name": "A", "type": "uint"},
            {"at": 8, "bits": 4, "name": "N", "type": "uint"},
            {"at": 12, "bits": 4, "name": "N 2", "type": "uint"},
            {"at": 16, "bits": 8, "name": "B", "type": "uint"},
        ],
    }


@pytest.mark.parametrize(
    ("inner", "at"),
    [
        (location(16), 24),
        (location(16, "previousEntry"), 24),
        (location(-8), 0),
        (location(16, "containerStart"), 16),
        (location(0, "containerStart"), 0),
    ],
)
def test_a_location_counts_from_the_previous_entry_or_the_start(inner, at):
    assert layout_of(entry("A") + entry("B", inner)).parts[1].at == at


def test_locations_in_an_included_container_count_from_its_start():
    inner = container(entry("B") + entry("C", location(16, "containerStart")), "Inner")
    entries = entry("A") + '<ContainerRefEntry containerRef="Inner"/>' + entry("N")
    layout = layout_of(entries, inner)
    assert [part.at for part in layout.parts] == [0, 8, 24, 32]
    assert layout.jumps and layout.size == 0


@pytest.mark.parametrize(
    ("inner", "why"),
    [
        (location(8, "containerEnd"),
         "where `B` is located is not a number of bits from the previous entry"),
        ("<LocationInContainerInBits><DynamicValue/></LocationInContainerInBits>",
         "where `B` is located is not a number of bits from the previous entry"),
        (location(-9), "`B` is located in front of its container"),
    ],
)  # fmt: skip
def test_other_locations_end_the_fields_with_the_reason(inner, why):
    layout = layout_of(entry("A") + entry("B", inner) + entry("C"))
    assert (layout.lost.name, str(layout.lost.why)) == ("B", why)
    # All bytes behind the last field, and no further entries.
    assert [part.path[-1] for part in layout.parts] == ["A", "B"]
    assert layout.parts[1].at == 8 and layout.parts[1].bits == 0
    assert failure(entry("B", inner)) == why  # nothing in front of it


def repeat(count, more=""):
    value = f"<FixedValue>{count}</FixedValue>"
    return f"<RepeatEntry><Count>{value}</Count>{more}</RepeatEntry>"


def test_a_repeated_entry_is_an_array_of_at_most_1024_elements():
    assert rows(entry("A", repeat(3)) + entry("B"), "count") == [
        ("A", 0, 3), ("B", 24, None),
    ]  # fmt: skip

    def is_accepted(count):
        try:
            layout_of(entry("A", repeat(count)))
        except NotSupported as why:
            assert str(why) == f"`A` is repeated {count} times"
            return False
        return True

    assert_limits(is_accepted, most=1024)
    assert failure(entry("A", repeat(-1))) == "`A` is repeated -1 times"
    why = "how often `A` is repeated, or the gap between, is not a number"
    assert failure(entry("A", repeat(2, "<Offset/>"))) == why
    assert failure(entry("A", "<RepeatEntry/>")) == why


def test_a_repeated_container_has_its_entries_again():
    entries = f'<ContainerRefEntry containerRef="Inner">{repeat(2)}</ContainerRefEntry>'
    assert rows(entries, others=container(entry("A") + entry("N"), "Inner")) == [
        ("A", 0), ("N", 8), ("A 2", 12), ("N 2", 20),
    ]  # fmt: skip


def fixed(bits, value, name=""):
    named = f' name="{name}"' if name else ""
    return f'<FixedValueEntry{named} binaryValue="{value}" sizeInBits="{bits}"/>'


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (fixed(8, "1F"), [("Fixed 8", 8, 8, 0x1F)]),
        (fixed(4, "1F"), [("Fixed 8", 8, 4, 0xF)]),  # the lowest bits
        (fixed(8, "1F", "Mark"), [("Mark", 8, 8, 0x1F)]),
        (fixed(8, "00", "Mark"), [("Mark", 8, 8, 0)]),
        (fixed(8, "00"), []),  # reserved
        (fixed(64, "F" * 16), [("Fixed 8", 8, 64, (1 << 64) - 1)]),
        (fixed(65, "00", "Mark"), []),
    ],
)
def test_a_fixed_value_is_a_constant_or_reserved(text, expected):
    fields = rows(entry("A") + text + entry("N"), "bits", "const")
    assert fields[1:-1] == expected
    assert fields[-1][:2] == ("N", 8 + int(text.split('sizeInBits="')[1].split('"')[0]))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (fixed(65, "1"), "a fixed value has 65 bits"),
        (fixed(0, "1"), "a fixed value has 0 bits"),
        (fixed(8 * 65535 + 1, "0"), "a fixed value has 524281 bits"),
        (fixed(8, "1G"), "a fixed value is `1G`"),
        (fixed(8, ""), "a fixed value is ``"),
        (fixed("x", "1"), "a size is `x`"),
    ],
)
def test_other_fixed_values_are_refused(text, why):
    assert failure(text) == why


def test_a_fixed_value_has_1_to_524280_bits():
    def is_read(bits):
        try:
            return layout_of(fixed(bits, "0")).at == bits
        except NotSupported:
            return False

    assert_limits(is_read, least=1, most=8 * 65535)


def test_aggregates_are_nested_up_to_50_times():
    def is_read(depth):
        nested = "".join(
            f'<AggregateParameterType name="n{level}"><MemberList><Member name="m" '
            f'typeRef="n{level + 1}"/></MemberList></AggregateParameterType>'
            for level in range(depth)
        )
        last = f'<IntegerParameterType name="n{depth}"/>'
        parameter = '<Parameter name="Q" parameterTypeRef="n0"/>'
        text = system(container(entry("Q")))
        text = text.replace("<ParameterTypeSet>", f"<ParameterTypeSet>{nested}{last}")
        text = text.replace("<ParameterSet>", f"<ParameterSet>{parameter}")
        root = safe_xml.parse("a.xml", text.encode(), account=Account())
        to = Definitions("a.xml")
        names = XtceNames({"a.xml": root}, to)
        layout = XtceLayout(names=names, types=XtceTypes(to, names))
        try:
            layout.read(names.all("container")[0])
        except NotSupported as why:
            assert str(why).endswith("has members nested without end")
            return False
        return layout.at == 32

    assert_limits(is_read, most=50)


def test_an_aggregate_is_its_members_in_order():
    assert rows(entry("P") + entry("N"), "bits") == [
        ("P x", 0, 8), ("P y", 8, 4), ("N", 12, 4),
    ]  # fmt: skip
    assert rows(entry("A") + entry("P/y")) == [("A", 0), ("P y", 8)]


def test_bits_with_the_least_significant_byte_first_count_from_the_least_significant_bit():
    assert rows(entry("L") + entry("N"), "bits", "view") == [
        # The bits of `N` are the low half of byte 1, which `L` has, too.
        ("L", 0, 12, None), ("N", 8, 4, True),
    ]  # fmt: skip
    assert failure(entry("H")) == (
        "the least significant byte of the 4 bits of `H` is sent first"
    )


def comparison(name="A", value="1", operator=None, tag="parameterRef", raw=""):
    given = f' comparisonOperator="{operator}"' if operator else ""
    return f'<Comparison {tag}="{name}" value="{value}"{given}{raw}/>'


def only_if(inner):
    return f"<IncludeCondition>{inner}</IncludeCondition>"


def condition(name="A", value="1", operator="=="):
    return (
        f'<Condition><ParameterInstanceRef parameterRef="{name}"'
        f' useCalibratedValue="false"/><ComparisonOperator>{operator}'
        f"</ComparisonOperator><Value>{value}</Value></Condition>"
    )


def tagged(tag, *inner):
    return f"<{tag}>{''.join(inner)}</{tag}>"


BEHIND = entry("C", location(24, "containerStart"))


@pytest.mark.parametrize(
    ("inner", "when"),
    [
        (comparison(), {"A": 1}),
        (comparison(operator="=="), {"A": 1}),
        (comparison(operator=" == "), {"A": 1}),
        (tagged("ComparisonList", comparison(), comparison("B", 2)), {"A": 1, "B": 2}),
        (tagged("BooleanExpression", condition()), {"A": 1}),
        (
            tagged("BooleanExpression",
                   tagged("ANDedConditions", condition(), condition("B", 7))),
            {"A": 1, "B": 7},
        ),
        (tagged("ORedConditions", condition(), condition("A", 3)), {"A": [1, 3]}),
        (
            tagged("ANDedConditions",
                   tagged("ORedConditions", condition(), condition("A", 3)),
                   condition("B", "0x10")),
            {"A": [1, 3], "B": 16},
        ),
    ],
)  # fmt: skip
def test_an_optional_entry_depends_on_equalities_of_fields_in_front(inner, when):
    entries = entry("A") + entry("B") + entry("N", only_if(inner)) + BEHIND
    fields = rows(entries, "when")
    assert fields == [
        ("A", 0, None), ("B", 8, None), ("N", 16, when), ("C", 24, None),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("inner", "why"),
    [
        ("", "`N` is present only on a condition that is empty"),
        (
            comparison(operator="!="),
            "`N` is present only if there is `A != 1`, which is not an equality",
        ),
        (
            tagged("ORedConditions", condition(), condition("B")),
            "`N` is present on a condition of several fields",
        ),
        (
            comparison() + comparison(value=2),
            "`N` is present on a condition of several fields",
        ),
        (
            tagged("ORedConditions", condition(),
                   tagged("ANDedConditions", condition(), condition("B"))),
            "`N` is present only if there is one of several things that must hold"
            " together",
        ),
        (
            tagged("Condition", '<ParameterInstanceRef parameterRef="A"/>',
                   "<ComparisonOperator>==</ComparisonOperator>",
                   '<ParameterInstanceRef parameterRef="B"/>'),
            "`N` is present only if there is a comparison of two parameters",
        ),
        ("<CustomAlgorithm/>", "`N` is present only if there is a `CustomAlgorithm`"),
        (comparison("C"), "it depends on `C`, which it does not have"),
        (comparison("N"), "it depends on `N`, which it does not have"),
        (comparison("X"), "there is no parameter `X`"),
        (comparison("X", tag="argumentRef"), "there is no argument `X`"),
    ],
)  # fmt: skip
def test_other_conditions_are_refused_with_the_reason(inner, why):
    entries = entry("A") + entry("B") + entry("N", only_if(inner)) + BEHIND
    assert str(layout_of(entries).lost.why) == why


def test_an_entry_behind_an_optional_one_states_its_position():
    optional = entry("A") + entry("N", only_if(comparison()))
    assert failure(optional + entry("B")) == (
        "`B` follows `N`, which is present only on a condition"
    )
    assert failure(optional + entry("B", location(4))) == (
        "`B` follows `N`, which is present only on a condition"
    )
    assert failure(optional) == "frames end before `N` where it is not there"
    size = "<BinaryEncoding><SizeInBits><FixedValue>{}</FixedValue></SizeInBits></BinaryEncoding>"
    assert laid_out(optional, more=size.format(12))["length"] == 2
    assert laid_out(optional, more=size.format(24))["length"] == 3
    assert failure(optional, more=size.format(11)).startswith("frames end before")


def test_conditions_cannot_be_nested():
    inner = container(entry("B", only_if(comparison())), "Inner")
    entries = entry("A") + (
        f'<ContainerRefEntry containerRef="Inner">{only_if(comparison())}'
        "</ContainerRefEntry>"
    )
    assert failure(entries, inner) == "`Inner` is present only on nested conditions"


BASE = entry("A") + entry("M") + entry("K") + entry("S")


def restricted(inner, base=BASE):
    """Return the layout of a container that is derived with these restrictions."""
    of = f"<RestrictionCriteria>{inner}</RestrictionCriteria>"
    derived = f'<BaseContainer containerRef="Base">{of}</BaseContainer>'
    return layout_of(entry("B"), container(base, "Base"), derived)


def test_a_derived_container_has_its_entries_behind_those_of_the_base():
    layout = restricted(tagged("ComparisonList", comparison(), comparison("M", "On")))
    assert [part.path[-1] for part in layout.parts] == ["A", "M", "K", "S", "B"]
    assert [(r.reference.name, r.value, r.is_raw) for r in layout.required_values] == [
        ("A", "1", False), ("M", "On", False),
    ]  # fmt: skip
    assert [layout.fix_value(each) for each in layout.required_values] == [1, 3]
    assert [part.item.get("const") for part in layout.parts] == [1, 3, None, None, None]


RAW = ' useCalibratedValue="false"'


@pytest.mark.parametrize(
    ("text", "raw"),
    [
        (comparison(value="255"), 255),
        (comparison(value="0"), 0),
        (comparison(value=" 0xff "), 255),
        (comparison("S", "-128"), -128),
        (comparison("S", "-0x02"), -2),
        (comparison("M", "5"), 4),  # a label
        (comparison("M", "5", raw=RAW), 5),
        (comparison("K", "4", raw=RAW), 4),
    ],
)
def test_a_value_is_a_label_or_a_raw_number(text, raw):
    layout = restricted(text)
    (required,) = layout.required_values
    assert layout.fix_value(required) == raw


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (comparison(value="256"), "it depends on `A`, which is never 256"),
        (comparison(value="-1"), "it depends on `A`, which is never -1"),
        (comparison(value="On"), "it depends on `A`, which is never `On`"),
        (comparison("M", "On", raw=RAW), "it depends on `M`, which is never `On`"),
        (comparison("K", "4"), "it depends on the calibrated value of `K`"),
        (comparison("C"), "it depends on `C`, which it does not have"),
        (comparison("F"), "it depends on `F`, which is of the type float"),
        (comparison("D"), "it depends on `D`, of which only the raw bits are imported"),
    ],
)
def test_a_value_that_a_field_cannot_have_is_refused(text, why):
    base = entry("A") + entry("M") + entry("K") + entry("F") + entry("D")
    layout = restricted(text, base)
    (required,) = layout.required_values
    with pytest.raises(NotSupported) as caught:
        layout.fix_value(required)
    assert str(caught.value) == why


def test_a_value_contradicts_another_of_the_same_field():
    layout = restricted(tagged("ComparisonList", comparison(), comparison(value="2")))
    first, second = layout.required_values
    assert layout.fix_value(first) == 1 == layout.fix_value(first)
    with pytest.raises(NotSupported, match="it depends on `A`, which is both 1 and 2"):
        layout.fix_value(second)


def test_alternatives_distinguish_no_containers():
    with pytest.raises(NotSupported) as caught:
        restricted(tagged("ORedConditions", condition(), condition(value="2")))
    assert str(caught.value) == (
        "it depends on more than equalities that must all be true"
    )


def test_at_most_500_fields_state_their_position():
    def placed(count):
        return entry("A") * (count - 1) + entry("B", location(0))

    assert len(laid_out(placed(500))["fields"]) == 500
    assert failure(placed(501)) == "more than 500 fields say where they stand"


def test_a_message_begins_behind_its_header():
    message = laid_out(entry("A") + entry("B") + fixed(16, "0"), start=8)
    assert (message["length"], message["reserved"]) == (3, 2)
    assert [(f["name"], f["at"]) for f in message["fields"]] == [("B", 0)]
    assert laid_out(fixed(16, "0")) == {
        "name": "Main", "kind": "telemetry", "length": 2, "reserved": 2,
    }  # fmt: skip


def test_parts_of_variable_length_follow_the_fixed_ones():
    message = laid_out(entry("A") + fixed(8, "0") + entry("R") + entry("B"))
    assert message["length"] == 2 and "reserved" not in message
    assert [(f["name"], f["at"], f.get("after")) for f in message["fields"]] == [
        ("A", 0, None), ("R", 16, None), ("B", 16, "R"),
    ]  # fmt: skip
    assert failure(entry("N") + entry("R")) == (
        "`R`, whose size is not fixed, begins within a byte"
    )


# Two nibbles are a whole byte, but their array is none of whole bytes.
NIBBLES = entry(
    "N", "<RepeatEntry><Count><FixedValue>2</FixedValue></Count></RepeatEntry>"
)


@pytest.mark.parametrize("last", [entry("N"), entry("B", location(8)), NIBBLES])
def test_an_entry_behind_variable_length_has_whole_bytes_directly_behind(last):
    name = last.split('"')[1]
    why = failure(entry("A") + entry("R") + last)
    assert why == (
        f"`{name}` follows `R`, whose size is not fixed, and does not have whole bytes"
        " directly behind the entry in front of it"
    )


def test_an_array_has_the_dimensions_of_its_type_or_of_its_entry():
    assert rows(entry("Y") + entry("A"), "count") == [("Y", 0, 5), ("A", 40, None)]
    inner = (
        "<DimensionList><Dimension><StartingIndex><FixedValue>1</FixedValue>"
        "</StartingIndex><EndingIndex><FixedValue>2</FixedValue></EndingIndex>"
        "</Dimension></DimensionList>"
    )
    array = f'<ArrayParameterRefEntry parameterRef="Y">{inner}</ArrayParameterRefEntry>'
    assert rows(array + entry("A"), "count") == [("Y", 0, 2), ("A", 16, None)]


def command_layout(entries, arguments):
    """Return the layout of the container of a command with these arguments."""
    text = (
        '<SpaceSystem name="s"><CommandMetaData><ArgumentTypeSet>'
        + TYPES.replace("Parameter", "Argument")
        + "</ArgumentTypeSet><MetaCommandSet><MetaCommand name='Go'><ArgumentList>"
        + "".join(
            f'<Argument name="{name}" argumentTypeRef="{type_}"/>'
            for name, type_ in arguments.items()
        )
        + f"</ArgumentList><CommandContainer name='Go'><EntryList>{entries}</EntryList>"
        "</CommandContainer></MetaCommand></MetaCommandSet></CommandMetaData>"
        "</SpaceSystem>"
    )
    root = safe_xml.parse("a.xml", text.encode(), account=Account())
    to = Definitions("a.xml")
    names = XtceNames({"a.xml": root}, to)
    (command,) = names.all("command")
    listed = {e.get("name"): e for e in command.iterfind("ArgumentList/Argument")}
    layout = XtceLayout(names=names, types=XtceTypes(to, names), arguments=listed)
    layout.read(names.container_of(command))
    return layout


def argument(name, key="argumentRef", tag="ArgumentRefEntry"):
    return f'<{tag} {key}="{name}"/>'


def test_a_command_has_its_arguments_and_their_members():
    entries = (
        argument("A")
        + argument("P/y")
        + argument("a/b")
        # XTCE 1.1 refers to arrays of arguments like this.
        + argument("Y", "parameterRef", "ArrayArgumentRefEntry")
    )
    arguments = {"A": "byte", "P": "pair", "a/b": "nibble", "Y": "bytes"}
    layout = command_layout(entries, arguments)
    placed = [(part.path[-1], part.at, part.bits) for part in layout.parts]
    assert placed == [("A", 0, 8), ("P y", 8, 4), ("a/b", 12, 4), ("Y", 16, 40)]
    with pytest.raises(NotSupported, match="there is no argument `X`"):
        command_layout(argument("X"), arguments)


def test_a_message_has_at_most_65535_bytes():
    def length(size):
        return laid_out(entry("A") + fixed(8, "0") + entry("A", location(8 * size)))[
            "length"
        ]

    assert length(65535 - 3) == 65535
    with pytest.raises(NotSupported) as caught:
        length(65535 - 2)
    assert str(caught.value) == "its frames have more than 65,535 bytes"
