"""Where ``icdgen fmt`` puts lists and mappings: on one line, in rows, or in blocks."""

from __future__ import annotations

import pytest

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


def test_a_file_without_entries_is_an_empty_mapping():
    assert format_text("{}\n", "test.yaml") == "{}\n"
    assert format_text("# only\n{}\n", "test.yaml") == "{}\n# only\n"
