"""Tables of a document: numbers, texts around them, runs of labels and groups."""

from __future__ import annotations

from icdgen.importer.document import (
    Document,
    Heading,
    PageBox,
    SourceTable,
    TextBlock,
)
from icdgen.importer.source_tables import (
    count_runs,
    from_document,
    group_by_headings,
    texts_in_and_around,
)
from tests.importer.rules.small import table


def test_tables_have_numbers_the_chain_of_headings_and_the_texts_above_them():
    blocks = [
        TextBlock("intro"),
        Heading("4", "Motor"),
        Heading("4.1", "Limits"),
        Heading("4.2", "State"),
        TextBlock("above"),
        table("a", boxes=[PageBox(1, 0.04, 1.25, 2.06, 3.14159), PageBox(2, 0, 0, 1, 1)]),
        table("", ""),
        TextBlock("between"),
        table("|b"),
        Heading("5", "Pump"),
        table("c"),
        TextBlock("end"),
        Heading("6", "Index"),
    ]  # fmt: skip
    tables = from_document(Document("pump.txt", blocks))
    assert [(t.number, t.headings, t.before, t.after) for t in tables] == [
        (1, ["4 Motor", "4.2 State"],
         ["intro", "4 Motor", "4.1 Limits", "4.2 State", "above"], []),
        (2, ["4 Motor", "4.2 State"], ["between"], []),
        (3, ["5 Pump"], ["5 Pump"], ["end", "6 Index"]),
    ]  # fmt: skip
    assert [cell.text for t in tables for row in t.rows for cell in row.cells] == [
        "a", "", "b", "c"
    ]  # fmt: skip
    assert tables[0].boxes == [PageBox(1, 0.0, 1.2, 2.1, 3.1), PageBox(2, 0, 0, 1, 1)]
    assert from_document(Document("pump.txt", [TextBlock("prose")])) == []


def test_a_run_of_labels_ends_where_a_label_does_not_ascend():
    labels = [None, 1, 2, None, 2, 3, 1, None, 0, 5]
    tables = [SourceTable(label=label) for label in labels]
    count_runs(tables)
    assert [source.run for source in tables] == [1, 1, 1, 1, 2, 2, 3, 3, 4, 4]


def test_the_largest_group_of_equal_headings_is_first_then_the_first_table():
    rows = ["a|b", "c|d", "e|f", "C | D", "E|F", "g|h"]
    tables = [table(row) for row in rows]
    for number, source in enumerate(tables, 1):
        source.number = number
    groups = group_by_headings(tables)
    numbers = [[source.number for source in group] for group in groups]
    assert numbers == [[2, 4], [3, 5], [1], [6]]


def test_texts_in_and_around_a_table_are_complete():
    keys = {"headings": ["4 Motor", "4.2 State"], "before": ["b", "c"], "after": ["d"]}
    source = table("e|f", "g", caption="a", **keys)
    assert list(texts_in_and_around(source)) == [
        "a", "4 Motor", "4.2 State", "b", "c", "d", "e", "f", "g"
    ]  # fmt: skip
