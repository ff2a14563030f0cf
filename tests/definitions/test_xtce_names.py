"""References of XTCE name the nearest element, bases follow commands, and names come
from the aliases that icdgen wrote.
"""

from __future__ import annotations

from itertools import product

import pytest

from icdgen.definitions import safe_xml
from icdgen.definitions.accounting import Account
from icdgen.definitions.model import Definitions, NotSupported
from icdgen.definitions.xtce_names import XtceNames, alias, ancillary_data, name_of

TOGETHER = (
    "if it is in another file, import both together: icdgen import FILE FILE, or the"
    " folder of both"
)


def system(name, inner):
    return f'<SpaceSystem name="{name}">{inner}</SpaceSystem>'


def telemetry(inner):
    return f"<TelemetryMetaData>{inner}</TelemetryMetaData>"


def parameters(*names):
    inner = "".join(f'<Parameter name="{name}"/>' for name in names)
    return telemetry(f"<ParameterSet>{inner}</ParameterSet>")


def commands(inner):
    return (
        f"<CommandMetaData><MetaCommandSet>{inner}</MetaCommandSet></CommandMetaData>"
    )


def names_of(**files):
    """Return the names of files, and the definitions with their findings."""
    to = Definitions("a")
    roots = {
        file: safe_xml.parse(file, text.encode(), account=Account())
        for file, text in files.items()
    }
    return XtceNames(roots, to), to


def failure(call, *arguments):
    with pytest.raises(NotSupported) as caught:
        call(*arguments)
    return str(caught.value), caught.value.help


def test_all_elements_of_a_kind_come_in_the_order_of_systems_and_files():
    types = '<ParameterTypeSet><IntegerParameterType name="T"/></ParameterTypeSet>'
    first = system(
        "s",
        parameters("A")
        + system("t", parameters("B") + system("u", parameters("C")))
        + system("v", parameters("D"))
        + telemetry(types),
    )
    names, to = names_of(a=first, b=system("w", parameters("A")))
    # The own elements of a system come first.
    listed = [(e.get("name"), names.system(e)) for e in names.all("parameter")]
    assert listed == [
        ("A", "/s"), ("B", "/s/t"), ("C", "/s/t/u"), ("D", "/s/v"), ("A", "/w"),
    ]  # fmt: skip
    (type_,) = names.all("parameter type")
    assert type_.get("name") == "T" and names.all("command") == []
    assert to.import_findings == []


@pytest.mark.parametrize(
    ("meta", "group", "tag", "kind"),
    [
        (meta, *row)
        for meta, row in product(
            ("TelemetryMetaData", "CommandMetaData"),
            (
                ("ParameterTypeSet", "FloatParameterType", "parameter type"),
                ("ArgumentTypeSet", "FloatArgumentType", "argument type"),
                ("ParameterSet", "Parameter", "parameter"),
                ("ContainerSet", "SequenceContainer", "container"),
                ("CommandContainerSet", "SequenceContainer", "container"),
                ("MetaCommandSet", "MetaCommand", "command"),
            ),
        )
    ],
)
def test_both_halves_of_a_system_share_their_names(meta, group, tag, kind):
    inner = f'<{meta}><{group}><{tag} name="X"/></{group}></{meta}>'
    names, _ = names_of(a=system("s", parameters("P") + inner))
    (seen_from, *_) = names.all("parameter")
    assert names.find_element(kind, "X", seen_from).tag == tag


def test_other_sets_and_sections_define_no_names():
    names, _ = names_of(
        a=system("s", telemetry("<StreamSet><CustomStream name='X'/></StreamSet>")
        + "<ServiceSet><Service name='X'/></ServiceSet>"
        + "<Other><ParameterSet><Parameter name='X'/></ParameterSet></Other>")
    )  # fmt: skip
    kinds = ("parameter", "container", "command", "parameter type", "argument type")
    assert [names.all(kind) for kind in kinds] == [[]] * 5


NESTED = system(
    "s",
    parameters("A", "B")
    + system("t", parameters("B", "C") + system("u", parameters("C", "Here")))
    + system("v", parameters("D")),
)


@pytest.mark.parametrize(
    ("reference", "place"),
    [
        ("C", "/s/t/u"),
        ("B", "/s/t"),
        ("A", "/s"),
        ("/s/B", "/s"),
        ("../C", "/s/t"),
        ("../../v/D", "/s/v"),
        ("v/D", "/s/v"),
        ("t/B", "/s/t"),
        ("s/A", None),
        ("./C", "/s/t/u"),
        ("D", None),
        ("/A", None),
        ("/t/B", None),
        ("/s/t/A", None),
    ],
)
def test_a_reference_is_searched_from_its_system_outwards(reference, place):
    names, _ = names_of(a=NESTED)
    (here,) = (e for e in names.all("parameter") if e.get("name") == "Here")
    if place is None:
        text, help = failure(names.find_element, "parameter", reference, here)
        assert text == f"there is no parameter `{reference}`"
        assert help == (TOGETHER if "/" in reference else "")
        return
    found = names.find_element("parameter", reference, here)
    assert (names.system(found), found.get("name")) == (
        place,
        reference.rpartition("/")[2],
    )
    assert names.parameter(reference, here) == (found, ())


@pytest.mark.parametrize(
    ("reference", "place", "path"),
    [
        ("A/x", "/s", ("x",)),
        ("A/x/y", "/s", ("x", "y")),
        ("v/D/x", "/s/v", ("x",)),
        ("/s/t/B/x", "/s/t", ("x",)),
        ("t/B", "/s/t", ()),
    ],
)
def test_a_reference_of_a_parameter_may_lead_to_a_member(reference, place, path):
    names, _ = names_of(a=NESTED)
    here = names.all("parameter")[0]
    element, members = names.parameter(reference, here)
    assert (names.system(element), members) == (place, path)


def test_a_reference_of_a_parameter_that_does_not_exist_is_reported():
    names, _ = names_of(a=NESTED)
    here = names.all("parameter")[0]
    assert failure(names.parameter, "X", here) == ("there is no parameter `X`", "")
    assert failure(names.parameter, "X/y", here) == (
        "there is no parameter `X/y`",
        TOGETHER,
    )


@pytest.mark.parametrize(
    ("tag", "kind"),
    [
        ("Parameter", "parameter type"),
        ("ArrayParameterType", "parameter type"),
        ("Argument", "argument type"),
        ("ArrayArgumentType", "argument type"),
    ],
)
def test_the_type_of_an_argument_is_an_argument_type(tag, kind):
    sets = (
        '<ParameterTypeSet><IntegerParameterType name="T"/></ParameterTypeSet>'
        '<ArgumentTypeSet><IntegerArgumentType name="T"/></ArgumentTypeSet>'
        f'<ParameterSet><{tag} name="P"/></ParameterSet>'
    )
    names, _ = names_of(a=system("s", telemetry(sets)))
    (element,) = names.all("parameter")
    assert names.type_of("T", element) is names.all(kind)[0]


def test_arguments_are_searched_in_the_system_of_their_command():
    types = '<ArgumentTypeSet><IntegerArgumentType name="T"/></ArgumentTypeSet>'
    argument = '<ArgumentList><Argument name="A"/></ArgumentList>'
    inner = commands(f'<MetaCommand name="C">{argument}</MetaCommand>')
    names, _ = names_of(a=system("s", telemetry(types) + system("t", inner)))
    (command,) = names.all("command")
    argument = command.find("ArgumentList/Argument")
    assert names.system(argument) == "/s/t"
    assert names.type_of("T", argument).get("name") == "T"


def test_a_name_that_two_files_define_is_reported_once_for_each():
    first = system("s", parameters("A", "B") + commands('<MetaCommand name="C"/>'))
    second = system("s", parameters("A", "E")
                    + "\n" + commands('\n<MetaCommand name="C"/>'))  # fmt: skip
    names, to = names_of(**{"x/a": first, "y/b": second})
    rows = [(f.code, f.severity, f.message, f.help, f.spot.file, f.spot.line)
            for f in to.import_findings]  # fmt: skip
    assert rows == [
        (
            "IMP076", "warning", "the parameter `/s/A` is in `a` and in `b`",
            "the first one is taken", "y/b", 1,
        ),
        (
            "IMP076", "error", "the command `/s/C` is in `a` and in `b`",
            "the first one is taken", "y/b", 3,
        ),
    ]  # fmt: skip
    (command,) = names.all("command")
    assert names.place(command) == (1, "x/a")


def test_a_container_that_two_files_define_is_an_error_and_one_in_a_file_none():
    text = system(
        "s",
        telemetry(
            '<ContainerSet><SequenceContainer name="C"/><SequenceContainer name="C"/>'
            "</ContainerSet>"
        ),
    )
    _, to = names_of(a=text)
    assert to.import_findings == []
    _, to = names_of(a=text, b=text)
    assert [finding.severity for finding in to.import_findings] == ["error", "error"]


COMMANDS = system(
    "s",
    telemetry('<ContainerSet><SequenceContainer name="Packet"/>'
              '<SequenceContainer name="Own"/></ContainerSet>')
    + commands(
        '<MetaCommand name="Base"><CommandContainer name="Own"/></MetaCommand>'
        '<MetaCommand name="Middle"><BaseMetaCommand metaCommandRef="Base"/>'
        "</MetaCommand>"
        '<MetaCommand name="Leaf"><BaseMetaCommand metaCommandRef="Middle"/>'
        '<CommandContainer name="LeafBox"/></MetaCommand>'
        '<MetaCommand name="Named"><CommandContainer name="NamedBox">'
        '<BaseContainer containerRef="Own"/></CommandContainer></MetaCommand>'
        '<MetaCommand name="Framed"><CommandContainer name="FramedBox">'
        '<BaseContainer containerRef="Packet"/></CommandContainer></MetaCommand>'
        '<MetaCommand name="None"/>'
        '<MetaCommand name="Lost"><BaseMetaCommand metaCommandRef="Gone"/>'
        '<CommandContainer name="LostBox"/></MetaCommand>'
        '<MetaCommand name="First"><BaseMetaCommand metaCommandRef="Second"/>'
        "</MetaCommand>"
        '<MetaCommand name="Second"><BaseMetaCommand metaCommandRef="First"/>'
        "</MetaCommand>"
    ),
)  # fmt: skip


@pytest.fixture
def by_name():
    names, _ = names_of(a=COMMANDS)
    return names, {e.get("name"): e for e in names.all("command")}


def test_a_command_has_the_container_of_its_nearest_base(by_name):
    names, command = by_name
    chain = names.commands(command["Leaf"])
    assert [e.get("name") for e in chain] == ["Leaf", "Middle", "Base"]
    container = {
        name: None
        if (e := names.container_of(command[name])) is None
        else e.get("name")
        for name in ("Leaf", "Middle", "Base", "None")
    }
    assert container == {
        "Leaf": "LeafBox",
        "Middle": "Own",
        "Base": "Own",
        "None": None,
    }


def test_a_command_container_without_a_base_continues_that_of_the_base_command(by_name):
    names, command = by_name

    def base(name):
        return names.base_of(command[name].find("CommandContainer"))

    own = command["Base"].find("CommandContainer")
    assert base("Leaf") is own
    # Command containers are preferred to containers of telemetry.
    assert base("Named") is own
    assert base("Framed").get("name") == "Packet"
    assert base("Base") is None
    assert failure(base, "Lost") == ("there is no command `Gone`", "")
    telemetry_container = names.all("container")[0]
    assert names.base_of(telemetry_container) is None
    assert names.container("Own", telemetry_container).tag == "SequenceContainer"


def test_commands_that_are_based_on_each_other_are_refused(by_name):
    names, command = by_name
    text = "commands are based on each other in a circle"
    assert failure(names.commands, command["First"]) == (text, "")
    assert failure(names.container_of, command["Second"]) == (text, "")


def element(inner, name="Short"):
    return safe_xml.parse("a", f'<Parameter name="{name}">{inner}</Parameter>'.encode())


def test_the_name_of_an_element_is_its_first_alias_of_an_icd():
    def aliases(*pairs):
        rows = "".join(f'<Alias nameSpace="{s}" alias="{a}"/>' for s, a in pairs)
        return element(f"<AliasSet>{rows}</AliasSet>")

    both = aliases(("Other", "x"), ("ICD", " "), ("ICD", "Fan  Speed"), ("ICD", "y"))
    assert (alias(both), name_of(both)) == ("Fan Speed", "Fan Speed")
    other = aliases(("Other", "x"), ("icd", "y"))
    assert (alias(other), name_of(other)) == ("", "Short")
    long = aliases(("ICD", "x" * 201))
    assert len(alias(long)) == 200


def test_ancillary_data_are_those_that_icdgen_wrote():
    data = element(
        "<AncillaryDataSet>"
        '<AncillaryData name="ICD group"> a\n b </AncillaryData>'
        '<AncillaryData name="ICD special 255">broken</AncillaryData>'
        '<AncillaryData name="ICD view"/>'
        '<AncillaryData name="Other">x</AncillaryData>'
        '<AncillaryData name="ICDx">x</AncillaryData>'
        "</AncillaryDataSet>"
    )
    assert ancillary_data(data) == {"group": "a b", "special 255": "broken", "view": ""}
