"""Trees of the formatter: look-ups, and entries that move."""

from __future__ import annotations

from icdgen.icd.fmt import trees
from icdgen.icd.fmt.commented import Branch, ScalarText
from icdgen.icd.fmt.kinds import kind_of_root
from icdgen.icd.fmt.read import read_commented
from icdgen.icd.fmt.write import write_canonical
from icdgen.icd.source import parse

TEXT = """\
zz:
  a: 1  # one
  # before
  b: {name: x, at: 3}
  c: [{name: p}, 7, {name: [z]}, {name: x, at: 4}, {name: p, at: 5}]
"""


def tree(text: str = TEXT) -> Branch:
    return read_commented(text, parse(text.encode(), "test.yaml"))


def written(root: Branch) -> str:
    return write_canonical(root, kind_of_root("icd"))


def test_look_ups_of_absent_keys_and_other_values_find_nothing():
    root = tree()
    section = trees.value_of(root, "zz")
    assert [
        entry.key.value for entry in trees.entries_of(section) if entry.key.value
    ] == []
    assert trees.entry_of(section, "a").trailing == ["# one"]
    assert trees.value_of(section, "a").spelling == "1"
    items = trees.items_of(trees.value_of(section, "c"))
    assert len(items) == 5
    for other in (None, 7, ScalarText("a", "a"), trees.value_of(section, "c")):
        assert trees.entries_of(other) == []
        assert trees.entry_of(other, "a") is None
        assert trees.value_of(other, "a") is None
    assert trees.items_of(section) == [] and trees.items_of(None) == []
    assert trees.entry_of(section, "d") is None


def test_an_item_is_the_first_with_the_name():
    section = trees.value_of(tree(), "zz")
    rows = trees.value_of(section, "c")
    first, *_, last, again = (item.value for item in trees.items_of(rows))
    assert trees.item_named(rows, trees.word("p")) is first
    assert trees.item_named(rows, trees.word("x")) is last
    assert again is not first
    assert trees.item_named(rows, trees.word("z")) is None
    assert trees.item_named(rows, "p") is None
    assert trees.item_named(section, trees.word("p")) is None


def test_all_branches_are_in_the_order_of_the_file():
    root = tree()
    section = trees.value_of(root, "zz")
    b, c = (trees.value_of(section, key) for key in "bc")
    rows = [item.value for item in trees.items_of(c) if isinstance(item.value, Branch)]
    inner = trees.value_of(rows[1], "name")
    expected = [root, section, b, c, rows[0], rows[1], inner, *rows[2:]]
    assert [*map(id, trees.branches(root))] == [*map(id, expected)]


def test_a_part_is_added_unless_the_key_has_another_value():
    section = trees.value_of(tree(), "zz")
    assert trees.part_of(section, "b") is trees.value_of(section, "b")
    assert trees.part_of(section, "a") is None
    assert trees.part_of(section, "c") is None
    added = trees.part_of(section, "d")
    assert added is trees.value_of(section, "d") and added.children == []
    assert [entry.key.spelling for entry in section.children] == ["a", "b", "c", "d"]


def test_entries_move_in_the_order_of_the_keys_with_their_comments():
    root = tree()
    section = trees.value_of(root, "zz")
    target = trees.part_of(root, "new")
    trees.move(section, {"b": "second", "x": "x", "a": "first"}, target)
    assert written(root) == (
        "zz:\n"
        "  c:\n"
        "    - {name: p}\n"
        "    - 7\n"
        "    - {name: [z]}\n"
        "    - {name: x, at: 4}\n"
        "    - {name: p, at: 5}\n"
        "\n"
        "new:\n"
        "  # before\n"
        "  second: {name: x, at: 3}\n"
        "  first: 1  # one\n"
    )


def test_new_values_are_written_in_flow_style():
    root = tree("zz: 1\n")
    values = {"text": trees.word("on"), "number": trees.number(-5)}
    values["list"] = trees.sequence(trees.word("a b"), trees.number(0))
    root.children[0].value = trees.mapping(values)
    assert written(root) == 'zz: {text: "on", number: -5, list: [a b, 0]}\n'
    assert trees.mapping({}).flow and not trees.mapping({}, False).flow
