"""Text tables are complete in a pipe, and as wide as the terminal otherwise."""

from __future__ import annotations

import io
import subprocess
import sys

from icdgen.tables import Column, printable_text, render_table, width_of

COLUMNS = [
    Column("name"),
    Column("value", right=True, fixed=True),
    Column("empty"),
    Column("remark"),
]
ROWS = [
    ("alpha", "1", "", "a remark that is rather long and has many words"),
    ("b", "-20", "", ""),
]


def test_in_a_pipe_no_text_is_cut_and_no_line_ends_in_spaces():
    assert render_table(COLUMNS, ROWS) == (
        "name   value  remark\n"
        "-----  -----  -----------------------------------------------\n"
        "alpha      1  a remark that is rather long and has many words\n"
        "b        -20\n"
    )


def test_what_fits_looks_the_same_on_a_terminal():
    assert render_table(COLUMNS, ROWS, 120) == render_table(COLUMNS, ROWS)


def test_on_a_narrow_terminal_words_are_wrapped():
    text = render_table(COLUMNS, ROWS, 40)
    assert all(len(line) <= 40 and line == line.rstrip() for line in text.splitlines())
    assert " ".join(line[14:].strip() for line in text.splitlines()[1:-1]) == ROWS[0][3]


def test_nothing_to_show_is_no_text():
    assert render_table(COLUMNS, []) == ""
    assert render_table([], [(), ()]) == ""


def test_markup_and_control_characters_are_shown_not_obeyed():
    row = ("[bold]x[/bold]", "\x1b[31m1", "", "a\x07\u202eb " * 30)
    for width in (None, 60):
        text = render_table(COLUMNS, [row], width)
        assert "[bold]x" in text and "\\u{1b}[31m1" in text
        assert all(c.isprintable() for c in text.replace("\n", ""))
    assert printable_text("a\tb\nc\x00") == "a b c\\u{0}"


def test_wide_characters_keep_columns_aligned():
    lines = render_table(
        [Column("a"), Column("b")], [("日本", "x"), ("e\u0301", "y")]
    ).splitlines()
    assert lines[2:] == ["日本  x", "e\u0301     y"]


def test_a_pipe_and_a_file_have_no_width(tmp_path):
    assert width_of(io.StringIO()) is None
    with (tmp_path / "out").open("w") as file:
        assert width_of(file) is None


def test_a_pipe_never_pays_for_rich():
    script = "import sys; from icdgen.tables import *; render_table([Column('a')], [('b' * 999,)]); print('rich' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout == "False\n"
