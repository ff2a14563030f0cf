"""Proposal of rules for each kind of table of a document."""

from __future__ import annotations

import json

import yaml

from icdgen.importer.document import SourceTable
from icdgen.importer.rules import explore
from icdgen.importer.rules.cells import find_columns
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rows import read_rows
from tests.importer.rules.small import column, rule, table

HEAD = """\
# Give each column a role or a pattern (docs/reference/import-rules.md),
# or put its heading under `ignore`.
profile: 1
node: {}  # state the orders of the document, such as {byte_order: big, bit_order: lsb0}
rules:
"""


def tables(*sources: SourceTable) -> list[SourceTable]:
    for number, source in enumerate(sources, 1):
        source.number = number
    return list(sources)


def on_page(source: SourceTable, page: int) -> SourceTable:
    source.rows[0].page = page
    return source


def test_each_kind_of_table_has_a_skeleton_of_a_rule_with_samples():
    first = table(
        "State", "Byte||~Name", "0|a|x", "1|a|x>2", "0|b|", "2|c|y", "3|d|z",
        caption="Basic  state", headings=["4 Motor", "4.2 State"], before=["a", "b: c"],
    )  # fmt: skip
    other = table("Byte||~Name", "9|9|9")
    last = table("Num|Pin|No: 1", "1|2")
    found = tables(on_page(last, 9), on_page(first, 5), on_page(other, 3))
    assert explore.report(found, "pump.pdf") == (
        "# pump.pdf: 3 tables of 2 kinds, a rule for each. "
        "A table without a rule is not imported.\n"
        + HEAD
        + r"""
  # 2 tables: 2, 3, pages 3 to 5
  #   caption: Basic state
  #   heading: 4.2 State
  #   before: b: c
  - tables: {head: Byte | * | ~^\~Name$}
    what: message
    message: {heading: '^{message} {id}$', kind: telemetry}
    columns:
      Byte:   # 0 | 1 | 2
      2:   # a | b | c
      "~^\\~Name$":   # x | y | z

  # 1 table: 1, page 9
  - tables: {head: "Num | Pin | No: 1"}
    what: message
    message: {heading: '^{message} {id}$', kind: telemetry}
    columns:
      Num:   # 1
      Pin:   # 2
      "No: 1":   #
"""
    )


def test_at_most_twelve_numbers_of_tables_are_listed():
    def line(count: int) -> str:
        found = tables(*(table("a|b") for _ in range(count)))
        return explore.report(found, "pump.txt").splitlines()[7]

    numbers = ", ".join(map(str, range(1, 13)))
    assert line(1) == "  # 1 table: 1"
    assert line(12) == f"  # 12 tables: {numbers}"
    assert line(13) == f"  # 13 tables: {numbers} ..."


def test_the_keys_of_columns_are_those_that_rules_find():
    source = table("Byte|Byte|Name>2|*|a + b|Why?", "1|2|3|4|5|6|7")
    text = explore.report(tables(source), "pump.txt")
    columns = yaml.safe_load(text)["rules"][0]["columns"]
    titles, _ = read_rows(rule(head="Byte | Byte"), source, Notes())
    assert titles == ["Byte", "Byte.2", "Name", "Name.2", "*", "a + b", "Why?"]
    for key, title in zip(columns, titles, strict=True):
        assert find_columns(column(key), titles) == [title]
    assert "      Name.2:   # 4\n" in text


def test_the_kinds_of_tables_in_json():
    first = table("Größe|b", caption="A", label=12)
    second = table("größe|B", headings=["4 Motor"])
    other = table("c|d")
    found = tables(other, on_page(first, 5), on_page(second, 3))
    text = explore.as_json(found, "pump.pdf")
    assert json.loads(text) == {
        "document": "pump.pdf",
        "kinds": [
            {"headings": ["Größe", "b"], "count": 2, "tables": [2, 3], "pages": [3, 5],
             "names": ["Table 12: A", "4 Motor"]},
            {"headings": ["c", "d"], "count": 1, "tables": [1], "pages": [],
             "names": [""]},
        ],
    }  # fmt: skip
    assert "Größe" in text
