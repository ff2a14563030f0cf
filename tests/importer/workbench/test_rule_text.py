"""The workbench changes one rule of a profile; everything else keeps its text and its
comments.
"""

from __future__ import annotations

import pytest

from icdgen.diagnostics import Findings
from icdgen.importer import profile
from icdgen.importer.workbench import rule_text

PROFILE = """# Of the motor.
profile: 1
node: {byte_order: little}  # as the manual says
rules:
  # telemetry
  - rule: state
    tables: {head: Byte | Name}   # two columns
    columns: {Byte: byte, Name: name}

  # the rest
  - {what: ignore, tables: {head: Pin}}
types: {word: {type: uint, bits: 16}}  # two bytes
"""
NEW = {
    "tables": {"head": "A | B"},
    "columns": {"A": "byte", "B": r"^{name} \(x\)$"},
    "width": "unit",
}


def test_a_rule_is_added_after_all_rules():
    text = rule_text.with_rule(PROFILE, None, NEW)
    assert text.replace(rule_text.text_of_rule(NEW), "") == PROFILE
    assert rule_text.rules_of(text)[2] == NEW
    assert text.index("A | B") < text.index("types:")


@pytest.mark.parametrize("index", [0, 1])
def test_a_rule_is_replaced_and_comments_around_it_stay(index):
    text = rule_text.with_rule(PROFILE, index, NEW)
    assert rule_text.rules_of(text)[index] == NEW
    assert rule_text.rules_of(text)[1 - index] == rule_text.rules_of(PROFILE)[1 - index]
    for comment in (
        "# Of the motor.",
        "# as the manual says",
        "  # telemetry",
        "  # the rest",
        "# two bytes",
    ):
        assert comment in text


@pytest.mark.parametrize(
    "start",
    [
        PROFILE,
        "profile: 1\nrules: [{what: ignore, tables: {head: Pin}}, {what: ignore, tables: {head: Q}}]",
    ],
)
def test_a_rule_is_added_after_another(start):
    before = rule_text.rules_of(start)
    text = rule_text.with_rule(start, None, NEW, behind=0)
    assert rule_text.rules_of(text) == [before[0], NEW, before[1]]
    assert text.count("#") == start.count("#")


@pytest.mark.parametrize("blank", ["", "\n", "# both\n"])
def test_two_rules_in_the_text_of_one_are_refused(blank):
    text = blank + rule_text.text_of_rule(NEW)
    assert rule_text.parse_rule(text) == NEW
    with pytest.raises(Findings) as caught:
        rule_text.parse_rule(text + rule_text.text_of_rule(NEW))
    assert (
        caught.value.findings[0].message == "one rule only: the text has 2 list items"
    )


def test_rules_are_removed_down_to_none():
    text = rule_text.with_rule(rule_text.with_rule(PROFILE, 0, None), 0, None)
    assert rule_text.rules_of(text) == []
    assert rule_text.rules_of(rule_text.with_rule(text, None, NEW)) == [NEW]


@pytest.mark.parametrize(
    "start",
    [
        "profile: 1\n",
        rule_text.NEW,
        "profile: 1\nrules: [{what: ignore, tables: {head: Pin}}]",
    ],
)
def test_the_first_rule_finds_its_place(start):
    text = rule_text.with_rule(start, None, NEW)
    assert rule_text.rules_of(text)[-1] == NEW
    assert len(rule_text.rules_of(text)) == len(rule_text.rules_of(start)) + 1


def test_the_node_is_replaced_or_added():
    text = rule_text.with_node(PROFILE, {"byte_order": "big", "id_bits": 16})
    assert "node: {byte_order: big, id_bits: 16}\n" in text and "# telemetry" in text
    assert (
        rule_text.with_node("profile: 1\nrules: []\n", {"byte_order": "big"})
        == "profile: 1\nnode: {byte_order: big}\nrules: []\n"
    )


@pytest.mark.parametrize(
    "value",
    [
        "a: b",
        "- x",
        "it's",
        "#x",
        "yes",
        "~",
        "1",
        "0x20",
        "{id}",
        r"^\d+ \| {id}$",
        "[a]",
        'a"b',
        " x",
        "&a",
        "*",
        "!t",
        "%",
    ],
)
def test_every_text_comes_back_as_it_was(value, tmp_path):
    rule = {"tables": {"head": value}, "what": "ignore", "skip": value}
    (tmp_path / "p.yaml").write_text(
        rule_text.with_rule(rule_text.NEW, None, rule), encoding="utf-8"
    )
    assert rule_text.rules_of((tmp_path / "p.yaml").read_text(encoding="utf-8")) == [
        rule
    ]


def test_shipped_rules_survive_being_written(tmp_path):
    from tests.conftest import ROOT

    text = (ROOT / "icd" / "profiles" / "cubeadcs.yaml").read_text(encoding="utf-8")
    rewritten = text
    for index, rule in enumerate(rule_text.rules_of(text)):
        rewritten = rule_text.with_rule(rewritten, index, rule)
    assert rule_text.rules_of(rewritten) == rule_text.rules_of(text)
    (tmp_path / "p.yaml").write_text(rewritten, encoding="utf-8")
    assert len(profile.load(tmp_path / "p.yaml").rules) == len(rule_text.rules_of(text))


@pytest.mark.parametrize(
    "start",
    [
        "rules:\n- {what: ignore, tables: {head: Pin}}\n- what: list\n  skip: a\n",
        "rules:\n    - {what: ignore, tables: {head: Pin}}\n    - what: list\n      skip: a\n",
        "rules: [{what: ignore, tables: {head: Pin}}, {what: list, skip: a}]\n",
        "rules: [{what: ignore,\n  tables: {head: Pin}}, {what: list,\n skip: a}]\n",
        "rules:\n  [{what: ignore, tables: {head: Pin}},\n   {what: list, skip: a}\n  ]\n",
    ],
)
def test_rules_are_changed_whatever_their_indentation_and_brackets(start):
    first, second = rule_text.rules_of(start)
    head, tail = "# Of the motor.\nprofile: 1\n", "types: {}  # none\n"
    start = head + start + tail
    for change, rules in (
        ((None, NEW), [first, second, NEW]),
        ((None, NEW, 0), [first, NEW, second]),
        ((0, NEW), [NEW, second]),
        ((1, NEW), [first, NEW]),
        ((0, None), [second]),
        ((1, None), [first]),
    ):
        text = rule_text.with_rule(start, *change)
        assert rule_text.rules_of(text) == rules
        assert text.startswith(head) and text.endswith(tail)


@pytest.mark.parametrize("value", ["", " ~", " []", "\n  []", "  # none"])
def test_a_rule_is_added_to_an_empty_value(value):
    text = rule_text.with_rule(f"profile: 1\nrules:{value}\n# end\n", None, NEW)
    assert text == f"profile: 1\nrules:\n{rule_text.text_of_rule(NEW)}# end\n"
