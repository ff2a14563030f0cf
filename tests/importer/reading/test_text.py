"""Lines of a text become tables, captions, headings and paragraphs."""

from __future__ import annotations

import pytest

from icdgen.importer import profile
from icdgen.importer.document import Heading, SourceTable, TextBlock
from icdgen.importer.reading.text import read

WORDS = profile.load()


@pytest.fixture
def document(tmp_path):
    def read_text(text: str):
        path = tmp_path / "manual.txt"
        path.write_bytes(text.encode())
        return read(path, WORDS)

    return read_text


@pytest.fixture
def shown(document):
    """Return rows of tables with their lines, and other blocks."""

    def show(text: str) -> list:
        return [
            (block.label, block.caption, [(row.shown, row.line) for row in block.rows])
            if isinstance(block, SourceTable)
            else block
            for block in document(text).blocks
        ]

    return show


def test_blocks_have_their_kinds_and_lines(shown):
    text = (
        "4.2. Motor  State\n\nSome\u00a0text.\nTable 4-12: Motor (continued)\n\n"
        "A\tB\n:--\t---:\n 0 \tx\n\n1\ty\nmore text\n"
    )
    assert shown(text) == [
        Heading("4.2", "Motor State", line=1),
        TextBlock("Some text.", line=3),
        (4000012, "Motor", [("A | B", 6), ("0 | x", 8), ("1 | y", 10)]),
        TextBlock("more text", line=11),
    ]


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_each_line_end_ends_a_line(shown, end):
    assert shown(f"a{end}{end}b{end}") == [
        TextBlock("a", line=1),
        TextBlock("b", line=3),
    ]


@pytest.mark.parametrize(
    ("line", "is_heading"),
    [
        ("4 Motor", True),
        ("4. Motor", True),
        ("4.2.1 M", True),
        ("4 motor", False),
        ("4Motor", False),
        ("A.2 Motor", False),
        ("4 M" + "m" * 116, True),
        ("4 M" + "m" * 117, False),
    ],
)
def test_a_short_line_with_a_number_and_a_capital_is_a_heading(shown, line, is_heading):
    (block,) = shown(line)
    assert isinstance(block, Heading) == is_heading


@pytest.mark.parametrize(
    ("line", "caption"),
    [
        ("Table 3: Motor", "Motor"),
        ("TABLE 3 - Motor, continued", "Motor"),
        ("Table 3", ""),
        ("Table 3 shows the motor", None),
        ("See Table 3: Motor", None),
    ],
)
def test_a_caption_has_a_mark_behind_its_number_or_no_title(shown, line, caption):
    *texts, (label, title, _) = shown(f"{line}\nA\tB\n")
    assert (label, title) == ((None, "") if caption is None else (3, caption))
    assert texts == ([TextBlock(line, line=1)] if caption is None else [])


def test_code_blocks_are_no_part_of_the_text(shown):
    text = "a\n  ```c\nTable 1\nb\tc\n```\nd\n```\ne"
    assert shown(text) == [TextBlock("a", line=1), TextBlock("d", line=6)]


def test_a_message_table_begins_behind_the_one_before_it(shown):
    rows = "ID\t3\tLength (bytes)\t4\n0\ta\n"
    tables = shown(rows + rows)
    head = "ID | 3 | Length (bytes) | 4"
    assert tables == [
        (None, "", [(head, 1), ("0 | a", 2)]),
        (None, "", [(head, 3), ("0 | a", 4)]),
    ]


def test_form_feeds_count_pages_and_do_not_end_a_table(document):
    result = document("x\nA\tB\n\f0\ty\n\f\f\nz")
    text, table, last = result.blocks
    assert [(row.page, row.line) for row in table.rows] == [(None, 2), (2, 3)]
    assert (text.page, last.page, result.pages) == (None, 4, 4)
    assert document("x").pages is None
