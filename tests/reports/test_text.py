"""The report for people: the error, the line, a caret under the right characters, and
the remedy.
"""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from icdgen.diagnostics import Finding, Fix, Place
from icdgen.reports import get
from icdgen.reports.excerpt import WIDTH, Lines, excerpt, printable
from tests.reports.findings import CORRECTED, ERROR, NOTE, TEXTS, TWICE, WARNING


def shown(line: int, column: int, length: int, text: str | None = None) -> list[str]:
    """Return excerpt and caret of a place."""
    texts = TEXTS if text is None else {"icd/demo.yaml": text}
    finding = Finding("ICD020", "wrong", Place("icd/demo.yaml", line, column, length))
    gutter = len(str(line)) + 3
    return [row[gutter:] for row in get("text")([finding], texts).splitlines()[2:4]]


def test_a_finding_as_it_is_printed():
    assert get("text")([ERROR], TEXTS) == (
        "icd/demo.yaml:2:7: error[ICD020]: `Voltage` is 100% wrong: it ends, alas\n"
        "  |\n"
        "2 | node: {name: demo}\n"
        "  |       ^^^^^^^^^^^^\n"
        "  = help: correct it\n"
        "\n"
        "1 error in 1 file\n"
    )


def test_the_corrected_line_follows_the_help():
    assert get("text")([CORRECTED], TEXTS).splitlines()[2:7] == [
        "2 | node: {name: demo}",
        "  |              ^^^^",
        "  = help: did you mean `demos`?",
        "2 | node: {name: demos}",
        "  |              ~~~~~",
    ]


def test_two_places_are_shown_in_the_order_of_the_file():
    assert get("text")([TWICE], TEXTS).splitlines()[1:7] == [
        "  |",
        "2 | node: {name: demo}",
        "  |              ---- the first of this name",
        "4 | 温度: {at: 0, bits: 温}",
        "  |              ^^^^",
        "  = help: rename one",
    ]


def test_the_place_in_another_file_is_named():
    other_place = Place("other.yaml", 11, 1, 4)
    finding = TWICE._replace(related=TWICE.related._replace(place=other_place))
    assert get("text")(
        [finding], TEXTS | {"other.yaml": "\n" * 10 + "name\n"}
    ).splitlines()[1:8] == [
        "   |",
        " 4 | 温度: {at: 0, bits: 温}",
        "   |              ^^^^",
        "   other.yaml:11:1",
        "11 | name",
        "   | ---- the first of this name",
        "   = help: rename one",
    ]


@pytest.mark.parametrize(
    ("line", "fixed", "rows"),
    [
        (
            9,
            10,
            [
                "   |",
                " 9 | nine",
                "   | ^^^^",
                "   = help: correct it",
                "10 | TEN",
                "   | ~~~",
            ],
        ),
        (
            10,
            9,
            [
                "   |",
                "10 | ten",
                "   | ^^^",
                "   = help: correct it",
                " 9 | NINE",
                "   | ~~~~",
            ],
        ),
    ],
)
def test_bars_are_aligned_if_line_numbers_have_different_lengths(line, fixed, rows):
    places = {9: Place("d.yaml", 9, 1, 4), 10: Place("d.yaml", 10, 1, 3)}
    fix = Fix(places[fixed], {9: "NINE", 10: "TEN"}[fixed])
    finding = Finding("ICD020", "wrong", places[line], "correct it", fix=fix)
    texts = {"d.yaml": "\n" * 8 + "nine\nten\n"}
    assert get("text")([finding], texts).splitlines()[1:7] == rows


def test_the_last_line_counts():
    assert get("text")([], TEXTS) == "no findings\n"
    assert get("text")([ERROR, ERROR, WARNING, NOTE], TEXTS).endswith(
        "\n2 errors, 1 warning, 1 note in 2 files\n"
    )


def test_without_the_text_there_is_no_excerpt():
    assert get("text")([NOTE], {}).splitlines() == [
        "a b/größe,1:2.yaml:7:3: note[ICD999]: no such rule",
        "  = help: two\\x0alines",
        "",
        "1 note in 1 file",
    ]


def test_colour_changes_nothing_but_colour():
    import re

    coloured = get("text")([ERROR, WARNING, NOTE], TEXTS, colour=True)
    assert "\x1b[1;31m^^^^^^^^^^^^\x1b[0m" in coloured
    assert re.sub("\x1b\\[[0-9;]*m", "", coloured) == get("text")(
        [ERROR, WARNING, NOTE], TEXTS
    )


def test_tabs_become_blanks_in_the_line_and_before_the_caret():
    assert shown(3, 2, 8) == ["    messages:", "    ^^^^^^^^"]


def test_wide_characters_take_two_columns():
    assert shown(4, 1, 2) == ["温度: {at: 0, bits: 温}", "^^^^"]
    assert shown(4, 19, 1) == ["温度: {at: 0, bits: 温}", " " * 20 + "^^"]


def test_combining_characters_take_no_column():
    assert shown(1, 4, 1, "e\u0301\u0300x") == ["e\u0301\u0300x", " ^"]


def test_of_a_line_of_ten_thousand_columns_a_window_is_shown():
    line, caret = shown(5, 9_001, 5)
    assert line.startswith("...x")
    assert line.endswith("y...")
    assert line[caret.index("^") :].startswith("errory")
    assert caret.count("^") == 5
    assert len(line) == WIDTH


@pytest.mark.parametrize(
    "column", [1, 2, 29, 30, 31, 99, 100, 101, 9_001, 10_004, 10_005, 10_006]
)
def test_the_caret_is_under_its_character_in_a_shortened_line(column):
    line, caret = shown(5, column, 1)
    line_text = TEXTS["icd/demo.yaml"].splitlines()[4]
    wanted = line_text[column - 1 : column + 4]
    assert line[len(caret) - 1 :].startswith(
        wanted[: max(1, len(line) - len(caret) - 3)].strip()
    )
    assert len(line) <= WIDTH


def test_a_place_past_the_end_of_its_line_or_file_does_no_harm():
    assert shown(6, 50, 3) == ["last", "    ^"]
    assert (
        get("text")(
            [Finding("ICD001", "wrong", Place("icd/demo.yaml", 99))], TEXTS
        ).count("\n")
        == 3
    )


def test_lines_end_where_yaml_ends_them():
    lines = Lines("\ufeffone\r\ntwo\rthree\x85four\u2028five\n")
    assert [lines[n] for n in range(1, 8)] == [
        "one",
        "two",
        "three",
        "four",
        "five",
        "",
        None,
    ]


def test_nothing_in_an_icd_can_act_upon_the_terminal():
    hostile = "\x1b[2J\x07\u202e\u2066\r\n\x00\x9b"
    finding = Finding("ICD020", hostile, Place(f"a{hostile}", 1, 1, 3), hostile)
    text = get("text")([finding], {f"a{hostile}": hostile * 5})
    assert not set(text) & set(hostile) - {"[", "2", "J", "\n"}
    assert printable(hostile) == "\\x1b[2J\\x07\\u202e\\u2066\\x0d\\x0a\\x00\\x9b"


def test_a_message_of_ten_thousand_characters_is_cut():
    assert len(get("text")([ERROR._replace(message="x" * 10_000)], TEXTS)) < 1_500


@given(
    st.text(st.characters(exclude_categories=("Cs",)), max_size=300),
    st.integers(1, 5),
    st.integers(1, 400),
    st.integers(1, 400),
)
def test_any_line_gives_an_excerpt_that_fits(text, line, column, length):
    excerpt_lines = excerpt(Lines(text), Place("demo.yaml", line, column, length))
    if excerpt_lines is not None:
        row, caret = excerpt_lines
        assert "\n" not in row
        assert len(row) <= WIDTH + 3
        assert caret.strip("^ ") == ""
        assert 1 <= caret.count("^") <= WIDTH
