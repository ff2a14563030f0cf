"""Results of one rule for one table: fields or values of a message, enumeration, lookup
table or set of bits.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.import_results.findings import SourcePlace
from icdgen.importer.document import SourceTable
from icdgen.importer.rules.fields import FieldDraft
from icdgen.importer.rules.language import KINDS, whole_number
from icdgen.importer.rules.notes import Notes
from icdgen.importer.rules.rule import TableRule


@dataclass
class TablePart:
    """Fields or values of one message, enumeration, lookup table, index entry or set of
    bits in one table.
    """

    rule: TableRule
    table: SourceTable
    given: dict[str, str]  # roles of the message
    # Roles of the message that cells of the table give.
    stated_in_rows: dict[str, str] = field(default_factory=dict)
    drafts: list[FieldDraft] = field(default_factory=list)
    # Values with members, or with points.
    pairs: list[tuple[int, str]] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)  # descriptions of the members

    @property
    def name(self) -> str:
        """Name of the message."""
        return self.given.get("message", "")

    @property
    def where(self) -> str:
        """Title of the part for a finding."""
        return (
            f"{self.table.title}, message `{self.name}`"
            if self.name
            else self.table.title
        )

    def number(self, role: str) -> int | None:
        """Return the number of an id or a length, or None."""
        text = self.given.get(role, "")
        return whole_number(text, self.rule.base) if text else None


def known_kind(
    text: str, where: str, spot: SourcePlace, rule: TableRule, notes: Notes
) -> str:
    """Return the kind of a message; empty, with a finding, if the word of the document
    is not translated.
    """
    if text in KINDS:
        return text
    if text:
        notes.error(
            "IMP031",
            f"{where}: its kind `{text[:40]}` is none of {', '.join(KINDS)}",
            spot,
            "translate the words of the document: `map: {kind: {TC: telecommand, TM: telemetry}}`",
            rule.place,
            example=text,
        )
    return ""
