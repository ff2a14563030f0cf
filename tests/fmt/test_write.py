"""Where ``icdgen fmt`` puts lists and mappings: on one line, in rows, or in blocks."""

from __future__ import annotations

import pytest

from icdgen.icd import schema
from icdgen.icd.fmt import format_text
from icdgen.icd.fmt.rows import aligned
from tests.limits import assert_limits

WIDTH = 120  # longest line that is not a row of a table
HEAD = "icdgen: 1\n"


def formatted(text: str) -> list[str]:
    """Return the lines behind the first."""
    first, *lines = format_text(HEAD + text, "test.yaml").splitlines()
    assert first == HEAD.strip()
    return lines


def test_a_mapping_on_one_line_ends_in_the_last_column():
    def is_one_line(length: int) -> bool:
        value = "x" * (length - len("zz: {a: 1, b: }"))
        return len(formatted(f"zz: {{a: 1, b: {value}}}\n")) == 1

    assert_limits(is_one_line, most=WIDTH)


def test_a_list_on_one_line_ends_in_the_last_column():
    def is_one_line(length: int) -> bool:
        value = "x" * (length - 3 * 32 - len("zz: []"))
        return len(formatted(f"zz: [{('x' * 30 + ', ') * 3}{value}]\n")) == 1

    assert_limits(is_one_line, most=WIDTH)


def test_a_mapping_that_the_schema_does_not_define_has_few_entries_on_a_line():
    def is_one_line(entries: int) -> bool:
        text = ", ".join(f"k{n}: {n}" for n in range(entries))
        return len(formatted(f"zz: {{{text}}}\n")) == 1

    assert [is_one_line(entries) for entries in (1, 5, 6, 7)] == [True] * 3 + [False]


def test_a_list_of_short_items_is_wrapped_and_one_of_long_items_is_not():
    """The first line has the key; each later one begins below the first item."""

    def is_wrapped(length: int) -> bool:
        return formatted(f"zz: [{', '.join(['x' * length] * 5)}]\n")[0] != "zz:"

    assert_limits(is_wrapped, most=40)
    lines = formatted(f"zz: [{', '.join(['x' * 41] * 3)}]\n")
    assert lines == ["zz:", *["  - " + "x" * 41] * 3]


@pytest.mark.parametrize("key", ["z", "zzzz", "a long key"])
def test_each_line_of_a_wrapped_list_is_as_long_as_the_width_permits(key):
    items = ["x" * (1 + n * 7 % 20) for n in range(60)]
    lines = formatted(f"{key}: [{', '.join(items)}]\n")
    column = len(key) + 3
    expected, line = [], f"{key}: ["
    for n, item in enumerate(items):
        cell = item + (", " if n < len(items) - 1 else "]")
        if len(line + cell.rstrip()) > WIDTH:
            expected.append(line.rstrip())
            line = " " * column
        line += cell
    assert lines == [*expected, line]


def test_a_wrapped_line_ends_in_the_last_column():
    """The comma counts."""
    items = ", ".join(["x" * 36] * 3 + ["y" * 20])
    for key, length in (("zzzz", WIDTH), ("zzzzz", WIDTH + 1 - 38)):
        assert len(formatted(f"{key}: [{items}]\n")[0]) == length


def test_rows_of_an_unknown_table_are_longer_than_other_lines():
    def is_row(length: int) -> bool:
        value = "x" * (length - len("  - {a: 1, b: }"))
        return "  - {" in formatted(f"zz: [{{a: 1, b: {value}}}]\n")[-1]

    assert_limits(is_row, most=160)


def test_a_field_is_a_row_at_any_length():
    summary = "word " * 100 + "end"
    field = f"{{at: 0, bits: 8, name: A, summary: {summary}}}"
    lines = formatted(f"messages: [{{name: M, fields: [{field}]}}]\n")
    assert lines == ["messages:", "  - name: M", "    fields:", f"      - {field}"]


def test_a_long_key_has_a_mark_because_readers_look_for_the_colon_only_so_far():
    for length, is_marked in ((999, False), (1000, False), (1001, True)):
        key = "k" * length
        lines = formatted(f"? {key}\n: 1\nzz: {{a: {{? {key} : 1}}}}\n")
        assert lines[:2] == [f"? {key}", ": 1"] if is_marked else [f"{key}: 1"]
        assert sum(line.lstrip().startswith("? ") for line in lines) == 2 * is_marked


@pytest.mark.parametrize("length", [1000, 1001])
def test_a_long_key_in_a_row_has_a_mark_too(length):
    key = "k" * length
    cell = f"{key}: 1" if length == 1000 else f"? {key} : 1"
    lines = formatted(f"messages: [{{fields: [{{? {key} : 1}}]}}]\n")
    assert lines[-1] == f"      - {{{cell}}}"


def test_a_mapping_that_the_schema_defines_has_any_number_of_entries_on_a_line():
    keys = [*schema.definition("struct")["properties"]]
    struct = f"{{{', '.join(f'{key}: 1' for key in keys)}}}"
    assert len(keys) > 6
    lines = formatted(f"structs: [{struct}, {{name: A, fields: [{{at: 0}}]}}]\n")
    assert lines[1] == f"  - {struct}"


def test_cells_wider_than_a_column_may_be_do_not_widen_it():
    def is_aligned(width: int) -> bool:
        wide, narrow = aligned([{"a": "x" * width, "b": "1"}, {"a": "x", "b": "2"}])
        assert wide == "{" + "x" * width + ", 1}"
        return len(narrow) == len(wide)

    assert_limits(is_aligned, most=40)


def test_a_column_that_only_some_rows_have_ends_the_alignment():
    rows = [
        {"a": "a: 1", "b": "b: 1", "c": "c: 1"},
        {"a": "a: 22", "c": "c: 1", "d": "d: 1"},
    ]
    assert aligned(rows) == ["{a: 1,  b: 1, c: 1}", "{a: 22, c: 1, d: 1}"]


def test_sections_have_a_blank_line_between_them():
    """Not before the first section, and not between single lines."""
    text = """\
missing:
  - {kind: telemetry, id: 1, name: A, why: B}
vocabulary: [OBC]
messages:
  - {name: A}
  - {name: B}
node: {name: demo, title: Demo}
zz: 1
"""
    assert formatted(text) == [
        "node:",
        "  name: demo",
        "  title: Demo",
        "vocabulary: [OBC]",
        "",
        "messages:",
        "  - name: A",
        "",
        "  - name: B",
        "",
        "missing:",
        "  - {kind: telemetry, id: 1, name: A, why: B}",
        "",
        "zz: 1",
    ]


@pytest.mark.parametrize("length", [WIDTH, WIDTH + 1])
def test_an_entry_that_does_not_fit_a_line_is_a_section(length):
    """Of a mapping, and of a list of items that are too long to be wrapped."""
    for value in ("{{a: 1, b: {}}}", f"[{{}}, {'x' * 41}]"):
        filler = "x" * (length - len("zz: " + value.format("")))
        lines = formatted(f"node: {{name: a}}\nzz: {value.format(filler)}\n")
        is_section = length > WIDTH
        assert lines[:2] == ["node:", "  name: a"]
        assert lines[2] == ("" if is_section else f"zz: {value.format(filler)}")
        assert len(lines) == (6 if is_section else 3)


def test_comments_inside_of_a_line_move_above_it():
    text = """\
zz: 1 # behind
messages:
  - name: M # name
    fields:
      - {at: 0, # at
         bits: 8, name: A} # row
      # below
"""
    assert [line for line in formatted(text) if line] == [
        "messages:",
        "  - name: M  # name",
        "    fields:",
        "      # at",
        "      - {at: 0, bits: 8, name: A}  # row",
        "      # below",
        "zz: 1  # behind",
    ]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("zz: # x\n  1 # y\n", ["# x", "zz: 1  # y"]),
        ("zz: # x\n  {a: 1} # y\n", ["# x", "zz: {a: 1}  # y"]),
        ("zz: # x\n  |\n  text\n", ["zz: |  # x", "  text"]),
        ("zz:\n  - # x\n    a # y\n", ["zz:", "  # x", "  - a  # y"]),
        (
            "zz:\n  - {a: 1} # v\n  # x\n  - # y\n    {a: 22} # z\n",
            ["zz:", "  - {a: 1}  # v", "  # x", "  # y", "  - {a: 22}  # z"],
        ),
        (
            "messages: [{fields: [7, {at: 0, # x\n  bits: 8} # y\n  ]}]\n",
            [
                "messages:",
                "  - fields:",
                "      - 7",
                "      # x",
                "      - {at: 0, bits: 8}  # y",
            ],
        ),
        (
            "zz:\n  - {a: 1, # x\n    b: 2} # y\n",
            ["zz:", "  # y", "  - a: 1  # x", "    b: 2"],
        ),
        (
            "zz: # a\n  - b: # c\n      d: | # e\n        text\n    # f\n  - # g\n"
            "    h: # i\n      j: 1\n",
            [
                "zz:  # a",
                "  - b:  # c",
                "      d: |  # e",
                "        text",
                "    # f",
                "  # g",
                "  - h: {j: 1}  # i",
            ],
        ),
    ],
)
def test_the_last_comment_of_a_line_stays_on_it_and_others_are_above(text, lines):
    assert [line for line in formatted(text) if line] == lines


def test_comments_of_the_first_entry_of_an_item_are_above_the_item():
    text = "zz:\n  - # x\n\n    # y\n    a: {b: {c: 1}} # z\n    # v\n    d: 1 # w\n"
    assert formatted(text) == [
        "zz:",
        "  # x",
        "",
        "  # y",
        "  - a:  # z",
        "      b: {c: 1}",
        "    # v",
        "    d: 1  # w",
    ]


def test_comments_of_the_entry_that_becomes_the_first_are_above_the_item():
    text = "messages:\n  - id: 1\n    # x\n\n    # y\n    name: A  # z\n"
    assert formatted(text) == [
        "messages:",
        "  # x",
        "",
        "  # y",
        "  - name: A  # z",
        "    id: 1",
    ]


@pytest.mark.parametrize(
    ("value", "lines"),
    [
        ("{a: [1, 2]}", ["zz: {a: [1, 2]}"]),
        ("{a: [[1], 2]}", ["zz:", "  a: [[1], 2]"]),
        ("{a: {b: 1}}", ["zz:", "  a: {b: 1}"]),
        ("[[1, 2], [3]]", ["zz: [[1, 2], [3]]"]),
        ("[[[1], 2], [3]]", ["zz: [[[1], 2], [3]]"]),
        ("[[1], {a: 1}]", ["zz:", "  - [1]", "  - {a: 1}"]),
        ("[{a: [1]}, {a: [22]}]", ["zz:", "  - {a: [1]}", "  - {a: [22]}"]),
        ("[{a: [1]}, {a: [[1]]}]", ["zz:", "  - {a: [1]}", "  - a: [[1]]"]),
        ("[{a: 1}, {a: {b: 1}}]", ["zz:", "  - {a: 1}", "  - a: {b: 1}"]),
    ],
)
def test_lists_in_lists_and_mappings_are_on_one_line_to_a_depth(value, lines):
    assert formatted(f"zz: {value}\n") == lines


def test_the_comment_of_a_wrapped_list_is_behind_it():
    items = ", ".join(["x" * 36] * 4)
    first, last = formatted(f"zz: [{items}] # x\n")
    assert "#" not in first and last.endswith("x]  # x")


def test_a_list_with_an_empty_mapping_is_no_table():
    assert formatted("zz: [{a: 1, b: [2]}, {}]\n") == [
        "zz:",
        "  - {a: 1, b: [2]}",
        "  - {}",
    ]


def test_a_file_without_entries_is_an_empty_mapping():
    assert format_text("{}\n", "test.yaml") == "{}\n"
    assert format_text("# only\n{}\n", "test.yaml") == "{}\n# only\n"
