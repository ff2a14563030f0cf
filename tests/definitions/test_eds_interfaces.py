"""Interfaces of components carry containers: with direction, number and the type that
replaces a generic one.
"""

from __future__ import annotations

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.eds_interfaces import Interfaces, Sending
from icdgen.definitions.eds_sheets import Sheets
from icdgen.definitions.model import Definitions
from tests.limits import assert_limits

TC, TM = "telecommand", "telemetry"


def container(name, base="", entries="", more=""):
    base = f'baseType="{base}"' if base else ""
    return (
        f'<ContainerDataType name="{name}" {base} {more}>{entries}</ContainerDataType>'
    )


def argument(type_, mode="", name="Command"):
    mode = f'mode="{mode}"' if mode else ""
    return (
        f'<CommandSet><{name}><Argument type="{type_}" {mode}/></{name}></CommandSet>'
    )


def declared(name, *parts, bases=()):
    listed = "".join(f'<Interface type="{base}"/>' for base in bases)
    return (
        f'<Interface name="{name}"><BaseInterfaceSet>{listed}</BaseInterfaceSet>'
        f"{''.join(parts)}</Interface>"
    )


def mapped(**types):
    listed = "".join(
        f'<GenericTypeMap name="{name}" type="{type_}"/>'
        for name, type_ in types.items()
    )
    return f"<GenericTypeMapSet>{listed}</GenericTypeMapSet>"


def used(name, type_, inner=""):
    return f'<Interface name="{name}" type="{type_}">{inner}</Interface>'


def component(required="", provided="", implementation="", name="C"):
    return (
        f'<Component name="{name}"><RequiredInterfaceSet>{required}'
        f"</RequiredInterfaceSet><ProvidedInterfaceSet>{provided}"
        f"</ProvidedInterfaceSet><Implementation>{implementation}</Implementation>"
        "</Component>"
    )


def numbers(*maps, **values):
    """Return the implementation with variables, and parameters of interfaces."""
    variables = "".join(
        f'<Variable name="{name}" initialValue="{value}"/>'
        for name, value in values.items()
    )
    listed = "".join(
        f'<ParameterMap interface="{interface}" parameter="{parameter}" '
        f'variableRef="{variable}"/>'
        for interface, parameter, variable in maps
    )
    return (
        f"<VariableSet>{variables}</VariableSet>"
        f"<ParameterMapSet>{listed}</ParameterMapSet>"
    )


def sheets(types, interfaces="", components="", others=""):
    own = (
        f'<Package name="p"><DataTypeSet>{types}</DataTypeSet><DeclaredInterfaceSet>'
        f"{interfaces}</DeclaredInterfaceSet><ComponentSet>{components}</ComponentSet>"
        "</Package>"
    )
    root = safe_xml.parse(
        "a.xml", f"<PackageFile>{own}</PackageFile>".encode(), account=Account()
    )
    other = safe_xml.parse(
        "b.xml", f"<PackageFile>{others}</PackageFile>".encode(), account=Account()
    )
    return Sheets(root, [("b.xml", other)], Definitions("a.xml"))


def sent(*arguments, **more):
    """Return containers that are sent with direction, number and interface, and names
    of the others.
    """
    sendings, unsent = Interfaces(sheets(*arguments, **more)).sent()
    return [
        (each.container.get("name"), each.kind, each.number, each.interface)
        for each in sendings
    ], [each.get("name") for each in unsent]


@pytest.mark.parametrize(
    ("mode", "required", "provided"),
    [
        ("", TM, TC), ("in", TM, TC), ("IN", TM, TC), ("out", TC, TM),
        ("inout", None, None),
    ],
)  # fmt: skip
def test_an_argument_has_the_direction_of_its_mode_and_interface(
    mode, required, provided
):
    types = container("A") + container("B") + '<IntegerDataType name="byte"/>'
    interfaces = declared("X", argument("A", mode), argument("byte")) + declared(
        "Y", argument("B", mode)
    )
    rows, unsent = sent(types, interfaces, component(used("x", "X"), used("y", "Y")))
    assert rows == [("A", required, None, ""), ("B", provided, None, "")]
    assert unsent == []


def test_a_container_in_both_directions_has_none():
    interfaces = declared("X", argument("A"), argument("A", "out"))
    rows, _ = sent(container("A"), interfaces, component(used("x", "X")))
    assert rows == [("A", None, None, "")]


def test_containers_come_in_the_order_of_the_file_and_others_are_returned():
    entries = '<EntryList><Entry name="e" type="Part"/></EntryList>'
    trailer = '<TrailerEntryList><Entry name="e" type="End"/></TrailerEntryList>'
    array = '<ArrayDataType name="many" dataTypeRef="Element"/>'
    types = (
        container("B", entries=entries + trailer) + container("A") + container("Part")
        + container("End") + container("Element") + array + container("Unsent")
        + container("Abstract", more='abstract="true"') + container("Other")
    )  # fmt: skip
    interfaces = declared("X", argument("A"), argument("B"), argument("byte"))
    rows, unsent = sent(types, interfaces, component(used("x", "X")))
    assert [name for name, *_ in rows] == ["B", "A"]
    assert unsent == ["Unsent", "Other"]
    # Without an interface, all of them are messages.
    rows, unsent = sent(types)
    assert rows == [(name, None, None, "") for name in ("B", "A", "Unsent", "Other")]
    assert unsent == []


def test_containers_that_contain_each_other_are_not_hidden():
    def containing(name, of):
        return container(
            name, entries=f'<EntryList><Entry name="e" type="{of}"/></EntryList>'
        )

    types = containing("A", "B") + containing("B", "A") + containing("C", "A")
    types += containing("D", "E") + container("E")
    assert [name for name, *_ in sent(types)[0]] == ["A", "B", "C", "D"]


def test_the_most_derived_containers_of_the_file_are_sent():
    base = '<Package name="q"><DataTypeSet>{}</DataTypeSet></Package>'
    others = base.format(container("Base") + container("Foreign", "Base"))
    types = (
        container("A", "q/Base") + container("A1", "A") + container("A2", "A")
        + container("A2x", "A2", more='abstract="1"') + container("B", "q/Base")
    )  # fmt: skip
    interfaces = declared("X", argument("q/Base"))
    rows, unsent = sent(types, interfaces, component(used("x", "X")), others)
    assert [name for name, *_ in rows] == ["A1", "B"] and unsent == []


def test_a_generic_type_is_that_of_the_nearest_interface():
    types = "".join(container(name) for name in "ABCD")
    interfaces = declared("Base", argument("T"), argument("U", "out"))
    interfaces += declared("X", mapped(T="C", U="D"), bases=["Base"])
    rows, unsent = sent(types, interfaces, component(used("x", "X", mapped(T="A"))))
    # The map of the base interface counts where no nearer one does.
    assert rows == [("A", TM, None, ""), ("D", TC, None, "")]
    assert unsent == ["B", "C"]


def test_a_generic_type_is_none_of_equal_name():
    types = container("A") + container("B")
    interfaces = declared("X", argument("A"))
    rows, unsent = sent(types, interfaces, component(used("x", "X", mapped(A="B"))))
    assert (rows, unsent) == ([("B", TM, None, "")], ["A"])


def test_a_mapped_type_without_an_argument_has_no_direction():
    rows, _ = sent(
        container("A"), declared("X"), component(used("x", "X", mapped(T="A")))
    )
    assert rows == [("A", None, None, "")]


def test_numbers_are_those_of_the_interface_and_an_id_has_precedence():
    types = container("A") + container("B") + container("C")
    interfaces = "".join(declared(f"I{name}", argument(name)) for name in "ABC")
    implementation = numbers(
        ("a", "Priority", "one"), ("a", "TopicId", "zero"), ("a", "Rate", "two"),
        ("b", "Rate", "two"), ("b", "Size", "one"), ("c", "Id", "negative"),
        zero=0, one=1, two=2, negative=-1,
    )  # fmt: skip
    use = "".join(used(name.lower(), f"I{name}") for name in "ABC")
    index = sheets(types, interfaces, component(use, implementation=implementation))
    sendings, _ = Interfaces(index).sent()
    assert [(each.number, each.parameter) for each in sendings] == [
        (0, "TopicId"), (2, "Rate"), (None, ""),
    ]  # fmt: skip


def test_a_container_with_several_numbers_has_a_message_of_each_mapped_one():
    implementation = numbers(("a", "Id", "one"), ("b", "Id", "two"), one=1, two=2)
    interfaces = declared("X", argument("T")) + declared("Y", argument("A"))
    components = component(
        used("a", "X", mapped(T="A")) + used("b", "X", mapped(T="A")),
        implementation=implementation,
    )
    rows, _ = sent(container("A"), interfaces, components)
    assert rows == [("A", TM, 1, "a"), ("A", TM, 2, "b")]
    # An interface that maps the type has precedence.
    mixed = component(
        used("b", "Y") + used("a", "X", mapped(T="A")), implementation=implementation
    )
    assert sent(container("A"), interfaces, mixed)[0] == [("A", TM, 1, "")]
    # Without a map only the first one counts.
    components = component(
        used("a", "Y") + used("b", "Y"), implementation=implementation
    )
    rows, _ = sent(container("A"), interfaces, components)
    assert rows == [("A", TM, 1, "")]


def test_an_interface_has_at_most_20_declarations():
    def is_carried(count):
        interfaces = "".join(
            declared(f"I{number}", bases=[f"I{number + 1}"])
            for number in range(1, count)
        ) + declared(f"I{count}", argument("A"))
        types = container("A") + container("B")
        interfaces += declared("Other", argument("B"))
        components = component(used("b", "Other") + used("a", "I1"))
        return [name for name, *_ in sent(types, interfaces, components)[0]] == [
            "A",
            "B",
        ]

    assert_limits(is_carried, most=20)
    # Interfaces that are based on each other end as well.
    loop = declared("X", argument("A"), bases=["Y"]) + declared("Y", bases=["X", "?"])
    assert sent(container("A"), loop, component(used("x", "X")))[0] == [
        ("A", TM, None, "")
    ]


BASES = {"TELECOMMAND_BASE": 0x1000, "TELEMETRY_BASE": 0x2000,
         "GLOBAL_CMD_BASE": 0x3000, "GLOBAL_TLM_BASE": 0x4000}  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "number", "parameter", "apid"),
    [
        (None, 5, "Id", None), (TM, None, "", None), (TM, 0, "Id", 0),
        (TM, 0x7FF, "Id", 0x7FF), (TM, 0x1801, "Id", 1), (TC, 0xFFF, "TOPICID", None),
        (TC, 0x7FF, "TopicId", 0x7FF), (TC, 0x800, "TopicId", None),
        (TC, 0x1000, "TopicId", 0), (TC, 0x10FF, "topicid", 0xFF),
        (TC, 0x1100, "TopicId", None), (TC, 0x2FFF, "TopicId", None),
        (TC, 0x3000, "TopicId", 0x60), (TC, 0x3061, "TopicId", 0x01),
        (TM, 0x2001, "TopicId", 1), (TM, 0x1001, "TopicId", None),
        (TM, 0x3FFF, "TopicId", None), (TM, 0x4001, "TopicId", 0x61),
    ],
)  # fmt: skip
def test_a_number_is_an_application_process_or_a_topic(kind, number, parameter, apid):
    defines = "".join(
        f'<Define name="{name}_TOPICID" value="{value}"/>'
        for name, value in BASES.items()
    )
    index = sheets("", others=f'<Package name="CFE_MISSION">{defines}</Package>')
    sending = Sending(index.root, kind, number, parameter)
    assert sending.apid(index) == apid
