"""Names that a user may type for a node, a message or a field."""

from __future__ import annotations

from dataclasses import replace

import pytest

from icdgen.icd.model import Message
from icdgen.loading import load
from icdgen.values.errors import Ambiguous, NotFound
from icdgen.values.find import (
    find_array,
    find_field,
    find_frame,
    find_message,
    find_named,
    find_node,
    find_sharing,
    is_part,
    only_node,
)
from tests.icd.files import write


@pytest.mark.parametrize(
    "key",
    [
        "Set Speed",
        "set speed",
        " SET SPEED ",
        "set_speed",
        "SetSpeed",
        "set-speed",
        "SET_SPEED",
        "17",
        "0x11",
        "0X11",
        " 17 ",
    ],
)
def test_a_message_by_name_identifier_or_id(icd, key):
    assert find_message(icd, "top", key).name == "Set Speed"


@pytest.mark.parametrize("key", ["20", "0x14", "Everything", "everything"])
def test_a_configuration_message_by_either_id(icd, key):
    assert find_message(icd, "top", key).name == "Everything"


def test_messages_of_included_nodes_are_found(icd):
    assert find_message(icd, "TOP", "130").node == "base"


def test_a_name_that_is_a_number_wins_over_the_id(icd):
    assert find_message(icd, "top", "42").id == 21


def test_an_id_of_both_directions_needs_the_kind(icd):
    with pytest.raises(
        Ambiguous,
        match=r"`Everything` \(configuration 20/150\), `Everything Else` \(telecommand 150\)",
    ):
        find_message(icd, "top", "150")
    assert find_message(icd, "top", "150", "telemetry").name == "Everything"
    assert find_message(icd, "top", "150", "telecommand").name == "Everything Else"
    assert find_message(icd, "top", "150", "configuration").name == "Everything"
    with pytest.raises(NotFound, match="top has no telemetry `20`") as caught:
        find_message(icd, "top", "20", "telemetry")
    assert caught.value.help == "`Everything` is configuration 20/150"


@pytest.mark.parametrize(
    ("node", "key", "words", "help"),
    [
        ("tip", "1", "there is no node `tip`", "did you mean `top`?"),
        ("xyz", "1", "there is no node `xyz`", "nodes: base, top"),
        (
            "top",
            "Set Sped",
            "top has no message `Set Sped`",
            "did you mean `Set Speed`?",
        ),
        (
            "base",
            "Set Speed",
            "base has no message `Set Speed`",
            "it is a message of top",
        ),
        (
            "top",
            "300",
            "top has no message `300`",
            "`icdgen show top` lists what there is",
        ),
        ("top", "", "top has no message ``", "`icdgen show top` lists what there is"),
        (
            "top",
            "?" * 10_000,
            "top has no message",
            "`icdgen show top` lists what there is",
        ),
    ],
)
def test_an_unknown_name_gets_suggestions(icd, node, key, words, help):
    with pytest.raises(NotFound) as caught:
        find_message(icd, node, key)
    assert words in str(caught.value)
    assert caught.value.help == help


@pytest.mark.parametrize(
    ("message", "key", "name"),
    [
        ("Set Speed", "x", "Commanded X speed"),
        ("Set Speed", "y speed", "Commanded Y speed"),
        ("Set Speed", "commanded_x_speed", "Commanded X speed"),
        ("Set Speed", "magic", "Magic Number"),
        ("Set Speed", "time", "Timeout"),
        ("Everything", "Wide", "Wide"),
        ("Everything", "angle", "Wide angle"),
        ("Everything", "derivative_gain", "BDot gain"),
        ("Everything", "bdot", "BDot gain"),
        ("Everything", "key = code", "Key = Code"),
    ],
)
def test_a_field_by_any_words_that_no_other_has(icd, message, key, name):
    message_ = find_message(icd, "top", message)
    assert (
        find_field(
            message_, icd.longest_frame(message_), key, find_node(icd, "top").vocabulary
        ).name
        == name
    )


def test_words_of_several_fields_are_refused(icd):
    message = find_message(icd, "top", "Set Speed")
    with pytest.raises(
        Ambiguous,
        match="`speed` fits several fields: `Commanded X speed`, `Commanded Y speed`",
    ):
        find_field(message, icd.longest_frame(message), "speed")
    with pytest.raises(NotFound) as caught:
        find_field(message, icd.longest_frame(message), "z")
    assert (
        caught.value.help
        == "fields: Commanded X speed, Commanded Y speed, Magic Number, Timeout"
    )
    with pytest.raises(NotFound) as caught:
        find_field(find_message(icd, "top", "42"), (), "z")
    assert caught.value.help == "it has no fields at all"
    for odd in ("", "?", "="):
        with pytest.raises(NotFound):
            find_field(message, icd.longest_frame(message), odd)


@pytest.mark.parametrize(
    ("words", "node", "others"),
    [
        (["top", "a", "b"], "top", ["a", "b"]),
        ([" BASE ", "a"], "base", ["a"]),
        (["a", "top"], "top", ["a", "top"]),
        ([], "top", []),
    ],
)
def test_the_only_node_that_no_other_includes_may_be_omitted(icd, words, node, others):
    result, others_left = find_named(icd, words)
    assert (result.name, others_left) == (node, others)
    assert only_node(icd) is find_node(icd, "top")
    assert [is_part(icd, each) for each in icd.nodes] == [True, False]


def test_with_several_nodes_the_name_is_needed(icd):
    base, top = icd.nodes
    two = replace(icd, nodes=(base, top, replace(top, name="second")))
    assert only_node(two) is None
    assert find_named(two, ["second"])[0].name == "second"
    with pytest.raises(NotFound, match="there is no node `tpo`") as caught:
        find_named(two, ["tpo", "1"])
    assert caught.value.help == "did you mean `top`?"
    with pytest.raises(NotFound, match="it is not said which node is meant") as caught:
        find_named(two, [])
    assert caught.value.help == "nodes: top, second", "without the included one"


def test_words_are_a_node_a_message_and_assignments(icd):
    for words in (["top", "17", "x=1", "y=2"], ["17", "x=1", "y=2"]):
        node, message, assignments = find_frame(icd, words)
        assert (node.name, message) == ("top", "17")
        assert assignments == ["x=1", "y=2"]
    assert find_frame(icd, ["17"])[2] == []
    with pytest.raises(NotFound, match="no message of top is named") as caught:
        find_frame(icd, ["top"])
    assert caught.value.help == "`icdgen show top` lists what there is"


NAMES = """\
structs:
  - name: Satellite
    length: 3
    fields:
      - {at: 0, bits: 8, name: GNSS, type: uint, aliases: [system]}
      - {at: 8, bits: 8, count: 2, name: Angles, identifier: az_el, type: uint}
messages:
  - name: Status
    id: 130
    kind: telemetry
    length: 27
    fields:
      - {at: 0, bits: 8, name: Mode, identifier: op_mode, type: uint, aliases: [State]}
      - {at: 8, bits: 8, count: 3, name: Gains, type: uint}
      - {at: 32, count: 2, struct: Satellite, name: Satellites}
      - {at: 80, struct: Satellite, name: Own, aliases: [Self]}
      - {at: 104, bits: 8, name: Modem, type: uint}
      - {at: 112, bits: 8, name: State, identifier: st, type: uint}
  - name: Other
    id: 300
    kind: telemetry
    length: 1
    aliases: [Spare status]
  - {name: 01 2c, id: 7, kind: telemetry, length: 1}
"""


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    loaded = load([write(tmp_path_factory.mktemp("names"), NAMES)], check=False)
    assert loaded.findings == []
    return loaded.icd


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("mode", "Mode"),
        ("mod", None),
        ("op mode", "Mode"),
        ("State", "State"),
        ("st", "State"),
        ("gains[1]", "Gains[1]"),
        ("gains 1", "Gains[1]"),
        ("gains[-1]", None),
        ("gains", None),
        ("satellites[1].gnss", "Satellites[1].GNSS"),
        ("satellites[1].system", "Satellites[1].GNSS"),
        ("satellites[1].az_el[0]", "Satellites[1].Angles[0]"),
        ("own gnss", "Own.GNSS"),
        ("own.system", "Own.GNSS"),
        ("system", "Own.GNSS"),
        ("own.az_el[1]", "Own.Angles[1]"),
        ("modem", "Modem"),
        ("mode m", "Modem"),
    ],
)
def test_a_field_is_found_by_name_identifier_alias_and_index(names, key, name):
    message = find_message(names, "demo", "status")
    fields = names.longest_frame(message)
    try:
        result = find_field(message, fields, key).name
    except (NotFound, Ambiguous):
        result = None
    assert result == name


@pytest.mark.parametrize(
    ("key", "elements"),
    [
        ("gains", ["Gains[0]", "Gains[1]", "Gains[2]"]),
        ("satellites[1].angles", [f"Satellites[1].Angles[{i}]" for i in range(2)]),
        ("satellites[0].az_el", [f"Satellites[0].Angles[{i}]" for i in range(2)]),
        ("own.az_el", ["Own.Angles[0]", "Own.Angles[1]"]),
        ("mode", []),
        ("gains[0]", []),
        ("angles", []),
    ],
)
def test_an_array_has_the_elements_of_its_name(names, key, elements):
    fields = names.longest_frame(find_message(names, "demo", "status"))
    assert [field.name for field in find_array(fields, key)] == elements


@pytest.mark.parametrize(
    ("key", "name"),
    [
        ("300", "Other"),
        ("0x12C", "Other"),
        ("0x012c", "Other"),
        ("01/2C", "01 2c"),
        ("01 2C", "01 2c"),
        ("00 00 01 2c", "Other"),
        ("00 00 00 01 2c", None),
        ("07", "01 2c"),
        ("00 07", "01 2c"),
        ("0b111", None),
        ("spare STATUS", "Other"),
        ("٣٠٠", None),
    ],
)
def test_an_id_is_a_number_or_its_bytes(names, key, name):
    try:
        result = find_message(names, "demo", key).name
    except NotFound:
        result = None
    assert result == name


def test_up_to_20_fields_are_listed_and_a_similar_alias_has_its_name(names):
    message = find_message(names, "demo", "status")
    fields = names.longest_frame(message)

    def help_of(key: str, count: int) -> str:
        with pytest.raises(NotFound) as caught:
            find_field(message, fields[:1] * count, key)
        return caught.value.help

    assert help_of("?", 20) == "fields: " + ", ".join(["Mode"] * 20)
    assert help_of("?", 21) == "it has 21 fields; `icdgen show` lists them"
    assert help_of("Stata", 1) == "did you mean `Mode`?"


def test_messages_that_share_an_id_are_those_of_one_direction(icd):
    def sharing(icd, key, kind=None):
        return [message.name for message in find_sharing(icd, "demo", key, kind)]

    def named(name: str, id: int, kind: str) -> Message:
        return replace(find_message(icd, "top", "17"), name=name, id=id, kind=kind)

    messages = (
        named("A", 1, "telecommand"),
        named("B", 1, "telemetry"),
        named("C", 1, "telemetry"),
        named("D", 2, "telecommand"),
        named("E", 2, "telecommand"),
        named("F", 2, "telemetry"),
    )
    node = replace(icd.nodes[0], name="demo", messages=messages)
    demo = replace(icd, nodes=(node,))
    assert sharing(demo, "1") == sharing(demo, "0x01", "telemetry") == ["B", "C"]
    assert sharing(demo, "2") == sharing(demo, "2", "telecommand") == ["D", "E"]
    assert sharing(demo, "1", "telecommand") == sharing(demo, "2", "telemetry") == []
    assert sharing(demo, "3") == sharing(demo, "A") == []
