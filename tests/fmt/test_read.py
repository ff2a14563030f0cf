"""Comments of a text, and the element of the tree to which each belongs."""

from __future__ import annotations

import pytest

from icdgen.icd.fmt import format_text
from icdgen.icd.fmt.read import comments, read_commented
from icdgen.icd.source import parse


def root_of(text: str):
    return read_commented(text, parse(text.encode(), "test.yaml"))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a: 1", []),
        ("# x\na: 1 # y  \n# z", ["# x", "# y", "# z"]),
        ("a: x#y\nb: x #y", ["#y"]),
        ("a: 'x # y' # z\n", ["# z"]),
        ('a: "# x" #\n', ["#"]),
        ("a: | # x\n  # text\n  text\n# y\n", ["# x", "# y"]),
        ("a: > # x\n  # text\nb: 1 # y\n", ["# x", "# y"]),
        ("a: |\n  text # text\n", []),
        ("a: [1,# x\n  2, # y\n  # z\n  ]# w\n", ["# x", "# y", "# z", "# w"]),
        ("a: {b: 1# x\n}", []),
        ("a: {b: 1}# x\nc: [1]# y\n", ["# x", "# y"]),
        ("a: ## x # y\n  1", ["## x # y"]),
        ("\ufeff# x\na: 1", ["# x"]),
        ("a: 1 # x\r\nb: 2 # y\r\n", ["# x", "# y"]),
        ("a: 1 # x\x85b: 2 # y\u2028c: 3 # z", ["# x", "# y", "# z"]),
        ("- a\n-  # x\n  b\n", ["# x"]),
    ],
)
def test_all_comments_of_a_text_are_listed(text, expected):
    assert comments(text) == expected


def places(text: str) -> dict[str, list[str]]:
    """Return where the comments of a flat mapping are."""
    root = root_of(text)
    result = {"header": root.header, "tail": root.tail}
    for child in root.children:
        result[f"before {child.key.spelling}"] = child.before
        result[f"behind {child.key.spelling}"] = child.trailing
    return {place: lines for place, lines in result.items() if lines}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("# x\na: 1\n", {"before a": ["# x"]}),
        ("# x\n\na: 1\n", {"header": ["# x"]}),
        ("# x\n# y\n\n# z\na: 1\n", {"header": ["# x", "# y"], "before a": ["# z"]}),
        ("# x\n\n\n# y\n\n# z\na: 1\n", {"header": ["# x", "", "# y"], "before a": ["# z"]}),
        ("# x\n\n# y\n\na: 1\n", {"header": ["# x", "", "# y"]}),
        ("# yaml-language-server: s\na: 1\n", {"header": ["# yaml-language-server: s"]}),
        (
            "# x\n# yaml-language-server: s\n# y\na: 1\n",
            {"header": ["# yaml-language-server: s"], "before a": ["# x", "# y"]},
        ),
        (
            "# x\n\n# yaml-language-server: s\n# y\na: 1\n",
            {"header": ["# yaml-language-server: s", "# x"], "before a": ["# y"]},
        ),
        (
            "# x\n\n# yaml-language-server: s\n\n# y\n\na: 1\n",
            {"header": ["# yaml-language-server: s", "# x", "", "# y"]},
        ),
        ("a: 1 # x\nb: 2\n", {"behind a": ["# x"]}),
        ("a: 1\n# x\nb: 2\n", {"before b": ["# x"]}),
        ("a: 1 # x\n# y\nb: 2 # z\n", {"behind a": ["# x"], "before b": ["# y"], "behind b": ["# z"]}),
        ("a: 1\n# x\n\n\n# y\nb: 2\n", {"before b": ["# x", "", "# y"]}),
        ("a: 1\n\n# x\nb: 2\n", {"before b": ["# x"]}),
        ("a: # x\n  1\n", {"behind a": ["# x"]}),
        ("a:\n  # x\n  1\n", {"before a": ["# x"]}),
        ("a:\n  # x\n  [1, {b: 2}]\n", {"before a": ["# x"]}),
        ("a: | # x\n  text\nb: 2\n", {"behind a": ["# x"]}),
        ("a: |\n  text\n# x\nb: 2\n", {"before b": ["# x"]}),
        ("a: [1] # x\nb: 2\n", {"behind a": ["# x"]}),
        ("a: 1\n# x\n", {"tail": ["# x"]}),
        ("a: 1\n# x\n\n# y\n", {"tail": ["# x", "", "# y"]}),
        ("# x\n{}\n# y\n", {"tail": ["# x", "# y"]}),
    ],
)  # fmt: skip
def test_a_comment_belongs_to_the_line_that_it_is_next_to(text, expected):
    assert places(text) == expected


@pytest.mark.parametrize(
    ("indent", "owner"),
    [(0, "zz"), (1, "zz"), (2, "a"), (3, "a"), (4, "b"), (5, "b"), (6, "c"), (9, "c")],
)
def test_the_column_decides_to_which_mapping_a_comment_behind_it_belongs(indent, owner):
    text = f"root:\n  a:\n    b:\n      c: 1\n{' ' * indent}# x\nzz: 1\n"
    root = root_of(text)
    outer = root.children[0].value
    a = outer.children[0].value
    b = a.children[0].value
    tails = {"a": outer.tail, "b": a.tail, "c": b.tail, "zz": root.children[1].before}
    assert {key: lines for key, lines in tails.items() if lines} == {owner: ["# x"]}


def test_a_comment_does_not_return_to_an_inner_mapping():
    """A comment that follows one further to the left belongs to the same mapping."""
    text = "root:\n  a:\n    b: 1\n  # x\n    # y\nzz: 1\n"
    outer = root_of(text).children[0].value
    assert outer.tail == ["# x", "# y"]
    assert outer.children[0].value.tail == []
    text = "root:\n  a:\n    b: 1\n    # y\n  # x\n# z\nzz: 1\n"
    root = root_of(text)
    outer = root.children[0].value
    assert (outer.children[0].value.tail, outer.tail) == (["# y"], ["# x"])
    assert root.children[1].before == ["# z"]


def test_comments_in_brackets_are_of_the_item_or_the_end():
    root = root_of("a: [ # x\n  1, # y\n  # z\n  2 # v\n  # w\n]\n")
    branch = root.children[0].value
    one, two = branch.children
    assert (one.before, one.trailing) == (["# x"], ["# y"])
    assert (two.before, two.trailing) == (["# z"], ["# v"])
    assert branch.tail == ["# w"]


def test_items_have_the_comments_of_their_lines():
    text = "a:\n  # x\n  - 1  # y\n  # z\n  - b: 2  # v\n    # w\n  # u\n"
    root = root_of(text)
    branch = root.children[0].value
    one, two = branch.children
    assert (one.before, one.trailing) == (["# x"], ["# y"])
    assert two.before == ["# z"]
    assert two.value.children[0].trailing == ["# v"]
    assert (two.value.tail, branch.tail) == (["# w"], ["# u"])


def test_scalars_have_value_and_spelling():
    root = root_of("a: 0x1F\nb: '0x1F'\n1: true\n\"on\": [~, 1.50]\n")
    scalars = [child.value for child in root.children[:3]]
    assert [(s.value, s.spelling) for s in scalars] == [
        (31, "0x1F"),
        ("0x1F", "0x1F"),
        (True, "true"),
    ]
    keys = [(child.key.value, child.key.spelling) for child in root.children]
    assert keys == [(None, "a"), (None, "b"), (None, "1"), ("on", "on")]
    items = [child.value for child in root.children[3].value.children]
    assert [(s.value, s.spelling) for s in items] == [(None, "~"), (1.5, "1.50")]


def test_the_header_is_in_front_of_the_file_with_a_blank_line():
    """The line for editors has none behind it."""
    assert format_text("# x\n\nicdgen: 1\n", "t") == "# x\n\nicdgen: 1\n"
    assert format_text("# x\nicdgen: 1\n", "t") == "# x\nicdgen: 1\n"
    line = "# yaml-language-server: $schema=x"
    assert format_text(f"{line}\n\n\nicdgen: 1\n", "t") == f"{line}\nicdgen: 1\n"
    both = format_text(f"# x\n\n{line}\nicdgen: 1\n", "t")
    assert both == f"{line}\n# x\n\nicdgen: 1\n"
