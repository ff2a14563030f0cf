"""Networks change until `icdgen check` accepts them: names get identifiers, and content
that a rule rejects is reduced or left out with the reason.
"""

from __future__ import annotations

import pytest

from icdgen.definitions.model import Definitions, Network
from icdgen.definitions.settle import settle
from icdgen.diagnostics import Findings

HEAD = {"byte_order": "big", "bit_order": "msb0"}
RAW = "its raw value is imported, without formula, unit, limits and names"
WITHOUT = "the message is imported without it: its bits are reserved"


def uint(name, at=0, bits=8, **more):
    return {"at": at, "bits": bits, "name": name, "type": "uint", **more}


def enum_field(name, enum, at=0, bits=8, **more):
    return uint(name, at, bits, **more) | {"type": "enum", "enum": enum}


def message(name, id, *fields, length=1, kind="telemetry", **more):
    listed = {"fields": list(fields)} if fields else {}
    return {"name": name, "id": id, "kind": kind, "length": length, **more, **listed}


def enum(name, *members):
    listed = [{"value": value, "name": member} for value, member in members]
    return {"name": name, "members": listed}


def settled(*messages, head=HEAD, **more):
    """Return the changed network, the identifiers and the findings."""
    network = Network("probe", "Probe", dict(head), list(messages), **more)
    to = Definitions("a.x")
    identifiers = settle(network, to)
    return (
        network,
        identifiers,
        [
            (each.code, each.severity, each.message, each.help)
            for each in to.import_findings
        ],
    )


def names(items):
    return [item["name"] for item in items]


def test_a_network_that_passes_the_check_stays_as_it_is():
    network, identifiers, findings = settled(
        message("A", 1, uint("x", unit="V", min=1))
    )
    assert (identifiers, findings) == ([], [])
    assert network.messages == [message("A", 1, uint("x", unit="V", min=1))]


def test_names_that_are_no_identifiers_get_one():
    network, identifiers, findings = settled(
        message("class", 1, uint("int"), uint("2 x", 8), uint("...", 16), length=3),
        message("Class", 2, uint("class")),
        message("温度", 3, length=0),
        message("Größe 1", 7, uint("Größe"), uint("größe", 8), length=2),
    )
    assert findings == []
    # A reserved word has its kind behind it, a name with a digit in front its kind in
    # front. A name without words has its position or id.
    assert identifiers == [
        "message `class`: `class message`",
        "field `int`: `int field`",
        "field `2 x`: `field 2 x`",
        "field `...`: `field 16`",
        "message `Class`: `Class message 2`",
        "field `class`: `class field`",
        "message `温度`: `message 3`",
        "field `größe`: `grosse 8`",
    ]
    assert network.messages[0]["identifier"] == "class message"
    assert network.messages[2]["name"] == "温度"


def test_names_that_clash_get_their_value_position_or_id():
    members = [(0, "On"), (1, "ON"), (-2, "on")]
    network, identifiers, findings = settled(
        message(
            "Fan", 1, enum_field("x", "Fan"), uint("Y", 8), uint("y", 16), length=3
        ),
        message("fan", 2, kind="telecommand", length=0),
        message("FAN", 3, length=0),
        enums=[enum("Fan", *members)],
    )
    assert findings == []
    assert identifiers == [
        "value `ON`: `ON 1`",
        "value `on`: `on minus 2`",
        "message `Fan`: `Fan 1`",
        "field `y`: `y 16`",
        "message `fan`: `fan 2`",
        "message `FAN`: `FAN 3`",
    ]
    assert "identifier" not in network.enums[0] | network.messages[0]["fields"][1]
    _, identifiers, _ = settled(
        message("A", 1, enum_field("x", "Mode"), enum_field("y", "mode", 8), length=2),
        message("B", 2, uint("Level", unit="ticks per turn")),
        enums=[enum("Mode", (0, "On")), enum("mode", (1, "Off"))],
    )
    assert identifiers == ["enumeration `mode`: `mode values`"]


@pytest.mark.parametrize(
    ("field", "expected", "why"),
    [
        (
            uint("x", min=5, max=3, unit="V", formula="raw*2"),
            uint("x"),
            "`min: 5` and `max: 3` leave no value for `x` (ICD033)",
        ),
        (
            enum_field("x", "Wide", bits=2),
            uint("x", bits=2),
            "`B` = 300 of the enumeration `Wide` does not fit the 2 bits of the field "
            "`x` (ICD030)",
        ),
        (
            enum_field("x", "Signed", bits=2),
            uint("x", bits=2) | {"type": "int"},
            "`B` = 300 of the enumeration `Signed` does not fit the 2 bits of the field "
            "`x` (ICD030)",
        ),
    ],
)
def test_a_field_first_loses_its_meaning_and_keeps_its_raw_value(field, expected, why):
    network, _, findings = settled(
        message("A", 1, field),
        enums=[
            enum("Wide", (0, "A"), (300, "B")),
            enum("Signed", (-1, "A"), (300, "B")),
        ],
    )
    assert findings == [("IMP078", "error", f"message `A`, `x`: {why}", RAW)]
    assert network.messages == [message("A", 1, expected)]
    # An enumeration without a field is left out.
    assert network.enums == []


def test_a_field_that_its_raw_value_does_not_mend_is_left_out():
    x = uint("x", 8, min=1)
    network, _, findings = settled(message("A", 1, uint("y"), x))
    text = "`x` ends at bit 16, but `A` has 8 bits (1 byte) (ICD020)"
    assert findings == [
        ("IMP078", "error", f"message `A`, `x`: {text}", RAW),
        ("IMP091", "error", f"message `A`, `x` is left out: {text}", WITHOUT),
    ]
    assert network.messages == [message("A", 1, uint("y"))]


def test_an_array_is_left_out_with_its_meaning():
    array = uint("x", 0, 8, count=2, min=9, max=3)
    network, _, findings = settled(message("A", 1, array, uint("y", 16), length=3))
    assert [code for code, *_ in findings] == ["IMP091"]
    assert network.messages == [message("A", 1, uint("y", 16), length=3)]


@pytest.mark.parametrize(
    ("kept", "reserved"),
    [
        ([uint("a")], 3),
        ([uint("a", 0, 9)], 2),
        ([uint("a", 0, 8, count=3)], 1),
        ([uint("b", 16), uint("a")], 1),
        ([{"at": 8, "name": "s", "struct": "Two"}], 1),
        ([uint("a", 0, 25)], None),
    ],
)
def test_a_message_reserves_the_bytes_behind_its_last_field(kept, reserved):
    two = {"name": "Two", "length": 2, "fields": [uint("a"), uint("b", 8)]}
    x = uint("x", 24, 4, count=2, min=9, max=3)
    faulty = message("A", 1, *kept, x, length=4)
    network, _, findings = settled(faulty, structs=[two])
    assert [code for code, *_ in findings] == ["IMP091"]
    (result,) = network.messages
    assert result.get("reserved") == reserved and result["fields"] == kept
    # A struct that no message uses is left out.
    assert names(network.structs) == (["Two"] if "struct" in kept[0] else [])


def test_a_message_without_a_usable_field_is_left_out_with_its_seed():
    protocol = {
        "link": {
            "framing": {"by": "slip"},
            "header": [{"bits": 8, "role": "id"}],
        }
    }
    network, _, findings = settled(
        message("A", 1, uint("x", bits=16)),
        message("B", 2, uint("x")),
        protocol=protocol,
        seeds={"A": 1, "B": 2},
    )
    text = "`x` ends at bit 16, but `A` has 8 bits (1 byte) (ICD020)"
    assert findings == [("IMP070", "error", f"message `A` is not imported: {text}", "")]
    assert names(network.messages) == ["B"] and network.seeds == {"B": 2}
    assert network.protocol is protocol


def test_a_member_that_is_not_supported_loses_its_name():
    network, _, findings = settled(
        message("A", 1, enum_field("x", "M")),
        enums=[enum("M", (0, "On"), (0.5, "Odd"))],
    )
    why = "`value` must be a whole number, not the number 0.5 (ICD010)"
    text = f"enumeration `M`: the name `Odd` of 0.5 is left out: {why}"
    help = "its value stays a number"
    assert findings == [("IMP078", "error", text, help)]
    assert network.enums == [enum("M", (0, "On"))]
    assert network.messages[0]["fields"] == [enum_field("x", "M")]


@pytest.mark.parametrize(
    ("members", "why"),
    [
        ([(0.5, "Odd")], "no name of it can be imported"),
        ([], "`members` is empty (ICD010)"),
    ],
)
def test_an_enumeration_without_names_becomes_numbers(members, why):
    network, _, findings = settled(
        message("A", 1, enum_field("x", "M"), enum_field("y", "N", 8), length=2),
        message("B", 2, enum_field("x", "M")),
        enums=[enum("M", *members), enum("N", (0, "On"))],
    )
    text = f"enumeration `M` is left out: {why}"
    assert findings[-1] == ("IMP078", "error", text, "its fields are numbers")
    first, second = network.messages
    assert first["fields"] == [uint("x"), enum_field("y", "N", 8)]
    assert second["fields"] == [uint("x")]
    assert names(network.enums) == ["N"]


def test_a_struct_that_is_not_supported_takes_its_fields_along():
    inner = {"name": "Inner", "length": 1, "fields": [uint("a")]}
    outer = {"name": "Outer", "length": 1}
    outer["fields"] = [{"at": 0, "name": "i", "struct": "Inner"}]
    wide = {"name": "Wide", "length": 1, "fields": [uint("a", bits=16)]}
    network, _, findings = settled(
        message(
            "A", 1, {"at": 0, "name": "w", "struct": "Wide"}, uint("y", 8), length=2
        ),
        message("B", 2, {"at": 0, "name": "o", "struct": "Outer"}),
        structs=[inner, wide, outer, dict(inner, name="Unused")],
    )
    text = "`a` ends at bit 16, but `Wide` has 8 bits (1 byte) (ICD020)"
    gone = "message `A`, `w` is left out: there is no struct `Wide` (ICD140)"
    help = "so are the fields that have it"
    assert findings == [
        ("IMP078", "error", f"struct `Wide` is left out: {text}", help),
        ("IMP091", "error", gone, WITHOUT),
    ]
    assert names(network.structs) == ["Inner", "Outer"]
    assert [names(each["fields"]) for each in network.messages] == [["y"], ["o"]]


def test_a_field_of_a_struct_is_named_with_its_struct():
    struct = {"name": "S", "length": 1, "fields": [uint("a", min=5, max=3)]}
    network, _, findings = settled(
        message("A", 1, {"at": 0, "name": "s", "struct": "S"}), structs=[struct]
    )
    why = "`min: 5` and `max: 3` leave no value for `a` (ICD033)"
    assert findings == [("IMP078", "error", f"struct `S`, `a`: {why}", RAW)]
    assert network.structs[0]["fields"] == [uint("a")]


def test_a_header_that_is_not_supported_is_left_out_with_all_seeds():
    network, identifiers, ((code, severity, text, help),) = settled(
        message("class", 1, uint("x")),
        protocol={"link": {"framing": {"by": "nothing"}}},
        seeds={"class": 1},
    )
    why = "`by` cannot be the text 'nothing'"
    assert (code, severity) == ("IMP070", "error")
    assert text == f"the header is not imported: {why}"
    assert help.startswith("correct `by`")
    assert (network.protocol, network.seeds) == (None, {})
    # The next rounds mend everything else.
    assert identifiers == ["message `class`: `class message`"]


def test_an_error_of_the_node_itself_is_raised():
    with pytest.raises(Findings) as caught:
        settled(message("A", 1, uint("x")), head={**HEAD, "byte_order": "odd"})
    (finding,) = caught.value.findings
    assert (finding.code, finding.place.file) == ("IMP005", "a.x")
    text = "what it defines makes no ICD: `byte_order` cannot be the text 'odd'"
    assert finding.message == text
    assert finding.help == "correct `byte_order`: one of little, big"


def test_reasons_do_not_name_lines_of_the_temporary_file():
    network, _, findings = settled(
        message("A", 1, uint("x"), uint("y", 4), enum_field("z", "M", 16), length=3),
        enums=[enum("M", (0, "On"), (0, "Off")), enum("M", (0, "On"))],
    )
    assert [text for _, _, text, _ in findings] == [
        "enumeration `M`: the name `Off` of 0 is left out: `On` already has the value 0 "
        "(ICD053)",
        "enumeration `M` is left out: there is already an enumeration named `M` (ICD052)",
        "message `A`, `y` is left out: `y` overlaps `x` in bits 4 to 7 (ICD021)",
    ]
    assert names(network.messages[0]["fields"]) == ["x", "z"]
