"""Parts of tables as rules read them, for tests of what is made of them."""

from __future__ import annotations

from typing import Any

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.descriptions import Described
from icdgen.importer.document import SourceTable
from icdgen.importer.rules.bit_order import ORDERS
from icdgen.importer.rules.cells import Roles
from icdgen.importer.rules.fields import FieldDraft
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.parts import TablePart
from icdgen.importer.rules.rows import DataRow
from icdgen.importer.rules.rule import TableRule
from tests.importer.rules.small import rule, table

LITTLE, BIG_MSB, BIG_LSB, LITTLE_MSB = ORDERS
RULE = rule()
RULES_OF = {
    what: rule(what, what=what)
    for what in ("enumeration", "lookup", "bits", "registers", "index")
}


def draft(
    name: str = "Mode", at: int = 0, bits: int = 8, kind: str = "uint", **keys: Any
) -> FieldDraft:
    """Return a field at line 5; ``roles`` and ``described`` are given as mappings."""
    roles = Roles(keys.pop("roles", {}), DataRow({}, table("x").rows[0]))
    described = Described(**keys.pop("described", {}))
    spot = SourcePlace(line=5)
    return FieldDraft(name, at, bits, kind, described, spot, roles, **keys)


def part(
    *drafts: FieldDraft, number: int = 7, own: TableRule = RULE, pairs=(), **given: str
) -> TablePart:
    """Return a part of a table with roles of its message."""
    source = SourceTable(number=number)
    return TablePart(own, source, given, drafts=list(drafts), pairs=list(pairs))


def shown(notes: Notes) -> list[tuple[str, str, str]]:
    return [(f.code, f.severity, f.message) for f in notes.import_findings]
