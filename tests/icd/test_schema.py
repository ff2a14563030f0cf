"""Violations of the schema: messages, places, help, and mappings that are left out."""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Lines
from icdgen.icd import schema, source
from tests.icd.files import HEAD

PING = "name: Ping, id: 1, kind: telecommand, length: 0"


def check(text: str, document: str = "icd"):
    tree = source.parse(text.encode(), "demo.yaml")
    return tree, *schema.check(tree, document, {"demo.yaml": text})


def rows(text: str, document: str = "icd") -> list[tuple[str, str]]:
    """Return the marked texts and the messages of the violations."""
    _, findings, _ = check(text, document)
    assert all(finding.code == "ICD010" and finding.help for finding in findings)
    lines = Lines(text)
    return [(lines.marked(each.place), each.message) for each in findings]


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        (PING, []),
        (PING.replace("id: 1", "id: {}"), [("{", "`id` must be a whole number or a list, not a mapping")]),
        (PING.replace("length: 0", "length: -1"), [("-1", "`length` must be at least 0, not -1")]),
        (PING.replace("length: 0", "length: 70000"), [("70000", "`length` must be at most 65535, not 70000")]),
        (PING.replace("length: 0", "length: 1.5"), [("1.5", "`length` must be a whole number, not the number 1.5")]),
        (PING.replace("name: Ping", 'name: ""'), [('""', "`name` is empty")]),
        (PING + ", summary: []", [("[", "`summary` must be text, not a list")]),
        (PING + ", summary: true", [("true", "`summary` must be text, not the boolean true")]),
        (PING + ", summary: ", [("}", "`summary` must be text, not empty")]),
        (PING.replace(", length: 0", ""), [("{", "`length` is missing from this entry of `messages`")]),
        (PING + ", fields: [{at: 0}]",
         [("{", f"`{key}` is missing from this entry of `fields`") for key in ("name", "type", "bits")]),
        (PING + ", aliases: []", [("[", "`aliases` is empty")]),
        (PING + ", fields: [{at: 0, bits: 8, name: A, type: int, points: [[0, 0]]}]",
         [("[", "`points` has fewer than 2 entries")]),
        (PING + ", fields: [7]", [("7", "this entry of `fields` must be a mapping, not the number 7")]),
    ],
)  # fmt: skip
def test_a_violation_is_named_at_its_place(keys, expected):
    found = rows(f"{HEAD}messages: [{{{keys}}}]\n")
    assert found == expected


def test_a_mapping_with_a_violation_is_left_out_and_its_neighbours_are_not():
    text = (
        f"{HEAD}messages:\n  - {{{PING}}}\n  - {{{PING}, sumary: A}}\n"
        f"  - {{{PING}, fields: [{{at: 0, bits: x, name: A, type: uint}}]}}\n"
        f"  - {{{PING}, source: 7}}\n  - {{{PING}, source: {{tabel: 7}}}}\n"
        f"  - {{{PING}, summary: {{a: 1}}}}\n"
    )
    tree, findings, broken = check(text)
    messages = tree["messages"]
    assert broken == {
        id(messages[1]),
        id(messages[2]["fields"][0]),
        id(messages[3]),
        id(messages[4]["source"]),
        id(messages[5]),
    }
    assert [finding.place.line for finding in findings] == [5, 6, 7, 8, 9]


def test_each_unknown_key_has_a_finding_at_the_key():
    text = f"{HEAD}messages:\n  - {{{PING}, sumary: A, zzz: 1, b c: }}\n"
    _, findings, _ = check(text)
    assert sorted(
        (each.place.column, each.message, each.fix and each.fix.text)
        for each in findings
    ) == [
        (55, "unknown key `sumary`", "summary"),
        (66, "unknown key `zzz`", None),
        (74, "unknown key `b c`", None),
    ]
    helps = {each.message: each.help for each in findings}
    assert helps["unknown key `zzz`"].startswith("known keys: name, ")
    rest = "if it is the rest of a text with a comma, put that in quotes; known keys: "
    assert helps["unknown key `b c`"].startswith(rest)


def test_an_unknown_key_is_shortened_to_60_characters():
    found = rows(f"{HEAD}{'k' * 61}: 1\n{'l' * 60}: 1\n")
    assert [message for _, message in found] == [
        f"unknown key `{'k' * 60}`",
        f"unknown key `{'l' * 60}`",
    ]


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (True, "the boolean true"),
        (False, "the boolean false"),
        ({}, "a mapping"),
        ([], "a list"),
        (None, "empty"),
        ("", "the text ''"),
        ("x" * 40, f"the text '{'x' * 40}'"),
        ("x" * 41, f"the text '{'x' * 37}...'"),
        (0, "the number 0"),
        (10**40, f"the number 1{'0' * 36}..."),
        (1.5, "the number 1.5"),
    ],
)
def test_values_are_described_in_words_of_at_most_40_characters(value, words):
    assert schema._describe(value) == words


@pytest.mark.parametrize(
    ("help", "values", "expected"),
    [
        ("", [], ""),
        ("h", [], "h"),
        ("", ["a"], "it can be a"),
        ("h", ["x", "y"], "h; it can be x, y"),
        ("one of x, y", ["x", "y"], "one of x, y"),
        ("one of x", ["x", "y"], "one of x; it can be x, y"),
        ("h", [True, "none"], "h; it can be true, none"),
    ],
)
def test_allowed_values_are_listed_unless_the_help_has_them_all(help, values, expected):
    rule = {"enum": values} if values else {}
    assert schema._with_values(help, rule) == expected


def test_the_place_of_a_path_is_that_of_the_value_with_the_mappings_around_it():
    text = f"{HEAD}messages:\n  - {{{PING}, fields: [{{at: 0, name: A}}]}}\n"
    tree = source.parse(text.encode(), "demo.yaml")
    message = tree["messages"][0]
    field = message["fields"][0]
    for path, holder, owner, column in (
        ([], tree, tree, 1),
        (["messages"], tree, tree, 3),
        (["messages", 0], tree, message, 5),
        (["messages", 0, "name"], message, message, 12),
        (["messages", 0, "fields", 0], message, field, 64),
        (["messages", 0, "fields", 0, "at"], field, field, 69),
    ):
        found = schema.locate(tree, path)
        assert (found[0] is holder, found[1] is owner, found[2].column) == (True, True, column), path  # fmt: skip


def test_sub_schemas_are_found_through_references():
    message = schema.definition("message")
    assert schema.subschema_of_key(message, "no such key") == {}
    assert schema.subschema_of_key({"$ref": "#/$defs/message"}, "length")
    assert schema.name_of_reference({"$ref": "#/$defs/message"}) == "message"
    assert schema.description_of({"description": "A"}) == "A"
    assert schema.description_of({}) == ""
    described = {"$ref": "#/$defs/protocol", "description": "Own."}
    assert schema.description_of(described) == "Own."
    assert schema.protocol_schema() == schema.definition("protocol")
    with pytest.raises(KeyError):
        schema.definition("none")
