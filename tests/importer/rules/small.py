"""Small rules and tables for tests of single functions of the rules."""

from __future__ import annotations

import re
from typing import Any

from icdgen.diagnostics import Place
from icdgen.importer.document import SourceCell, SourceRow, SourceTable
from icdgen.importer.rules.language import Pattern, compile_pattern
from icdgen.importer.rules.rule import ColumnRule, TableRule

RULES = "rules.yaml"


def table(*rows: str, **keys: Any) -> SourceTable:
    """Return a table with the number 7 of rows whose cells are separated by `|`.

    A cell that ends with `>2` spans two columns, one that ends with `v2` two rows.
    """
    result = []
    for number, row in enumerate(rows, 1):
        cells = []
        for text in row.split("|"):
            match = re.fullmatch(r"(.*?)(?:>([0-9]))?(?:v([0-9]))?", text, re.S)
            assert match is not None
            spans = int(match[2] or 1), int(match[3] or 1)
            cells.append(SourceCell(match[1], *spans))
        result.append(SourceRow(cells, line=number))
    return SourceTable(number=7, rows=result, **keys)


def pattern(text: str, line: int = 1) -> Pattern:
    return compile_pattern(text, Place(RULES, line))


def column(key: str, *patterns: str, line: int = 3) -> ColumnRule:
    compiled = tuple(pattern(text, line + 1) for text in patterns)
    return ColumnRule(key, compiled, Place(RULES, line))


def rule(name: str = "state", **keys: Any) -> TableRule:
    """Return a rule. Texts of patterns are compiled."""
    for key in ("skip", "stop"):
        if key in keys:
            keys[key] = re.compile(keys[key], re.I)
    for key in ("keep", "conditions"):
        if key in keys:
            keys[key] = {k: re.compile(v, re.I) for k, v in keys[key].items()}
    return TableRule(name, Place(RULES, 2), **keys)
