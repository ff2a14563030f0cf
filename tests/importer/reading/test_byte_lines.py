"""Lines that describe bytes become tables; other blocks keep their places."""

from __future__ import annotations

import pytest

from icdgen.importer.document import Document, Heading, SourceTable, TextBlock
from icdgen.importer.reading.byte_lines import make_tables


def shown(*texts: str) -> list:
    """Return the texts, and the rows of tables."""
    blocks = [TextBlock(text, 3, 10 + index) for index, text in enumerate(texts)]
    document = Document("manual.pdf", blocks)
    make_tables(document)
    return [
        [(row.shown, row.page, row.line) for row in block.rows]
        if isinstance(block, SourceTable)
        else block.text
        for block in document.blocks
    ]


HEAD = "Byte | Name"


def test_each_run_of_lines_becomes_a_table_at_its_place():
    assert shown(
        "Frame", "Byte 0: Mode", "bytes 1-2 = rate: 10 mV", "Text", "OCTET[3]: Load"
    ) == [
        "Frame",
        [(HEAD, 3, 11), ("0 | Mode", 3, 11), ("1-2 | rate: 10 mV", 3, 12)],
        "Text",
        [(HEAD, 3, 14), ("3 | Load", 3, 14)],
    ]


@pytest.mark.parametrize(
    ("line", "row"),
    [
        ("Byte0~Byte1: voltage", "0-1 | voltage"),
        ("Byte 0 to 1: x", "0-1 | x"),
        ("Bytes [4..7] : x", "4-7 | x"),
        ("octets 12=x = y", "12 | x = y"),
        ("byte5:x", "5 | x"),
        ("Byte 0123456789012: x", "0123456789012 | x"),
        ("Byte 0, 1 in words of: x", None),
        ("Byte 0:", None),
        ("Byte 0: ", None),
        ("Byte: x", None),
        ("The byte 0: x", None),
        ("Byte 0 has x", None),
        ("Bit 0: x", None),
    ],
)
def test_a_line_has_the_numbers_of_its_bytes_and_a_text(line, row):
    assert shown(line) == [[(HEAD, 3, 10), (row, 3, 10)] if row else line]


@pytest.mark.parametrize(("between", "is_line"), [(12, True), (13, False)])
def test_at_most_12_characters_are_between_the_number_and_the_sign(between, is_line):
    assert isinstance(shown(f"Byte 0{'.' * between}: x")[0], list) == is_line


def test_headings_and_tables_between_lines_separate_tables():
    line = TextBlock("Byte 0: x")
    table, heading = SourceTable(), Heading("", "Byte 0: x")
    document = Document("manual.pdf", [line, table, heading, line, line])
    make_tables(document)
    first, *between, last = document.blocks
    assert between == [table, heading] and between[0] is table
    assert [len(block.rows) for block in (first, last)] == [2, 3]
