"""Comments of the tree of the formatter, in the order of the file."""

from __future__ import annotations

from icdgen.icd.fmt.commented import NOTHING, Branch, Child, ScalarText
from icdgen.icd.fmt.emit import branch, node


def test_comments_are_listed_in_the_order_of_the_file_without_blank_lines():
    leaf = Child(ScalarText("b", "b"), ScalarText(1, "1"), ["# 3", ""], ["# 4"])
    inner = Branch(True, False, 2, [leaf], ["", "# 5"])
    outer = Branch(False, False, 0, [Child(NOTHING, inner, ["# 1", "# 2"], ["# 6"])], ["# 7"])  # fmt: skip
    assert outer.comments() == [f"# {number}" for number in range(1, 8)]
    assert outer.commented() and inner.commented()
    assert not Branch(True, False, 0, [Child(NOTHING, before=[""])], [""]).commented()
    for lists in ({"before": ["# a"]}, {"trailing": ["# a"]}):
        assert Branch(True, False, 0, [Child(NOTHING, **lists)]).comments() == ["# a"]


def test_children_do_not_share_their_lists_of_comments():
    first, second = Child(NOTHING), Child(NOTHING)
    first.before.append("# a")
    assert (second.before, second.trailing, first.value) == ([], [], NOTHING)


def test_plain_values_become_nodes_with_their_spelling():
    tree = branch({"a": [1, None], "": True, "b": {}})
    assert [child.key for child in tree.children] == [
        ScalarText("a", "a"),
        ScalarText("", ""),
        ScalarText("b", "b"),
    ]
    items, flag, empty = (child.value for child in tree.children)
    assert (tree.mapping, items.mapping, empty.mapping) == (True, False, True)
    assert [child.key for child in items.children] == [NOTHING, NOTHING]
    assert [child.value for child in items.children] == [ScalarText(1, "1"), ScalarText(None, "null")]  # fmt: skip
    assert flag == ScalarText(True, "true")
    assert (node(False), node(0), node("x"), node(0.5)) == (
        ScalarText(False, "false"),
        ScalarText(0, "0"),
        ScalarText("x", "x"),
        ScalarText(0.5, "0.5"),
    )
