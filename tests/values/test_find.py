"""Names that a user may type for a node, a message or a field."""

from __future__ import annotations

import pytest

from icdgen.values.errors import Ambiguous, NotFound
from icdgen.values.find import find_field, find_message, find_node


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
