"""Selection of the rule for a table, with the reasons why other rules do not apply.

The first rule that fits reads a table. So do rules before it that have the key `also`.
`--explain` and the workbench show the reasons.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from itertools import pairwise, zip_longest

from icdgen.importer.document import SourceTable
from icdgen.importer.rules.language import normalised
from icdgen.importer.rules.rule import TableRule

# rows in which the headings are looked for: titles and notes stand above them
SEARCHED = 6
NO_HEAD = "none"


@dataclass
class Choice:
    """The rules that apply to a table, and the reason why each rule before does not."""

    table: SourceTable
    rules: list[TableRule] = field(default_factory=list)
    reasons: list[tuple[TableRule, str]] = field(default_factory=list)


def texts_of_rows(table: SourceTable, transpose: bool) -> list[list[str]]:
    """Return the texts of the cells of each row.

    If the headings are on the left, return the texts of each column.
    """
    if not transpose:
        return [
            [normalised(slot.text) for slot in row if slot.is_origin]
            for row in table.grid()
        ]
    rows = [[normalised(slot.text) for slot in row] for row in table.grid()]
    width = max(map(len, rows), default=0)
    # Rows can have fewer cells than the widest one.
    padded = [row + [""] * (width - len(row)) for row in rows]
    return [list(column) for column in zip(*padded, strict=True)]


def heading_rows(rule: TableRule, texts: list[list[str]]) -> range | None:
    """Return the indices of the heading rows, or None if no row matches.

    The range is empty for a rule without headings. Some sources print headings in two
    lines as two rows. Such rows are joined if no single row matches.
    """
    if rule.head in ("", NO_HEAD):
        return range(0)
    wanted = titles_wanted(rule)
    for index, row in enumerate(texts[:SEARCHED]):
        if _first_difference(wanted, row) is None:
            return range(index, index + rule.head_rows)
    if rule.head_rows > 1 or rule.transpose:
        return None
    for index, pair in enumerate(pairwise(texts[:SEARCHED])):
        joined = [
            " ".join(filter(None, cells)) for cells in zip_longest(*pair, fillvalue="")
        ]
        if _first_difference(wanted, joined) is None:
            return range(index, index + 2)
    return None


def titles_wanted(rule: TableRule) -> list[str]:
    """Return the cells of `head`."""
    return [normalised(title) for title in re.split(r"\s\|\s", rule.head)]


def _first_difference(wanted: list[str], row: list[str]) -> int | None:
    for index, title in enumerate(wanted):
        cell = row[index] if index < len(row) else ""
        fits = title == "*" or (
            re.search(title[1:], cell, re.I) is not None
            if title.startswith("~")
            else title.casefold() == cell.casefold()
        )
        if not fits or index >= len(row):
            return index
    return None


def why_not(rule: TableRule, table: SourceTable) -> str:
    """Why a rule does not apply to a table, its `nth` aside; empty if it does."""
    if rule.pages is not None and not (
        table.page is not None and rule.pages[0] <= table.page <= rule.pages[1]
    ):
        return (
            f"the table stands on page {table.page}"
            if table.page is not None
            else "the source has no pages"
        )
    for source, pattern in rule.conditions.items():
        texts = {
            "caption": [table.caption],
            "heading": table.headings,
            "before": table.before,
            "sheet": [table.sheet],
        }[source]
        if not any(pattern.search(normalised(text)) for text in texts):
            shown = (
                f": `{normalised(texts[-1])[:50]}`"
                if texts and texts[-1]
                else "; there is none"
            )
            return f"`{source}` does not match{shown}"
    texts_by_row = texts_of_rows(table, rule.transpose)
    if heading_rows(rule, texts_by_row) is not None:
        return ""
    wanted = titles_wanted(rule)
    nearest = max(
        texts_by_row[:SEARCHED], key=lambda row: _agreement(wanted, row), default=[]
    )
    index = _first_difference(wanted, nearest) or 0
    cell = nearest[index] if index < len(nearest) else ""
    return f"the headings differ: `{wanted[index]}` is wanted as cell {index + 1}, the table has `{cell[:40]}`"


def _agreement(wanted: list[str], row: list[str]) -> int:
    return sum(
        _first_difference([title], [cell]) is None
        for title, cell in zip(wanted, row, strict=False)
    )


def choose(rules: list[TableRule], tables: list[SourceTable]) -> list[Choice]:
    """Decide for each table: the first rule that fits, and rules before it that leave
    the table to others (`also`).
    """
    choices = []
    seen: Counter[str] = Counter()
    for table in tables:
        choice = Choice(table)
        for rule in rules:
            reason = why_not(rule, table)
            # `nth` counts the tables that fulfil all other conditions.
            if not reason and rule.nth is not None:
                seen[rule.name] += 1
                if seen[rule.name] != rule.nth:
                    reason = f"it is number {seen[rule.name]} of the tables that fit, `nth` is {rule.nth}"
            if reason:
                choice.reasons.append((rule, reason))
                continue
            choice.rules.append(rule)
            if not rule.also:
                break
        choices.append(choice)
    return choices
