"""A manual as a whole: trees and findings out. Nothing is written here."""

from __future__ import annotations

import copy
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from icdgen.import_results.targets import Target
from icdgen.importer import assemble, profile, reading, repairs, sources
from icdgen.importer.document import CERTAIN, DOUBTFUL, LIKELY, Document, Table, Trouble
from icdgen.importer.rules import interpret
from icdgen.importer.rules.interpret import Interpretation
from icdgen.importer.source_tables import SourceTable
from icdgen.importer.understand import survey
from icdgen.importer.understand.survey import Survey

NOTHING = "IMP004"


@dataclass
class Result:
    """Everything that an import found."""

    document: Document
    survey: Survey
    targets: list[Target] = field(default_factory=list)
    tables: list[SourceTable] = field(default_factory=list)
    interpretation: Interpretation | None = None  # where the profile has rules

    @property
    def troubles(self) -> list[Trouble]:
        """All findings in the order of the manual."""
        return sorted(
            self.survey.troubles, key=lambda t: (t.spot.page or 0, t.spot.line or 0, t.spot.order or 0, t.code)
        )

    @property
    def failed(self) -> bool:
        """Whether something that the manual has is missing from the ICD, or may be wrong in it."""
        return any(t.severity == "error" for t in self.survey.troubles)

    def sureness(self) -> Counter[str]:
        """How many tables were read how surely; those that were not understood are not counted."""
        return Counter(self.sure_of(one.table) for one in self.survey.found if one.what != survey.UNKNOWN)

    def sure_of(self, table: Table) -> str:
        """How sure the reading of a table is."""
        about = [t for t in self.survey.troubles if t.spot.order == table.order and t.code != "IMP035"]
        what = next((one.what for one in self.survey.found if one.table is table), "")
        if what == survey.UNKNOWN or table.doubts or any(t.severity == "error" or t.sure == DOUBTFUL for t in about):
            return DOUBTFUL
        return LIKELY if any(t.severity == "warning" or t.code in ("IMP020", "IMP021") for t in about) else CERTAIN


def run(
    manual: Path, words: profile.Profile, progress: reading.Progress | None = None, jobs: int | None = None,
    prose: bool = False, pages: tuple[int, int] | None = None,
) -> tuple[Result, dict[str, dict[str, Any]]]:  # fmt: skip
    """Reads a manual. Raises `Findings` for a file that cannot be read; one that holds nothing to import gives no tree
    and the finding IMP004. ``pages``: the first and the last one to read of a PDF."""
    document, tables = sources.read(manual, words, progress, jobs, pages)
    if words.has_rules or document.needs_rules:
        return apply_rules(document, tables, words, prose)
    repairs.mend(document, words)
    found = survey.survey(document, words)
    trees = assemble.assemble(document, found, words, prose)
    if not trees:
        found.troubles.append(_nothing(document, found))
    return Result(document, found, tables=tables), trees


def apply_rules(
    document: Document, tables: list[SourceTable], words: profile.Profile, prose: bool = False
) -> tuple[Result, dict[str, dict[str, Any]]]:
    """Read the tables of a document by the rules of a profile. The tables themselves are not changed."""
    tables = copy.deepcopy(tables)
    notes = repairs.mend_tables(tables, words)
    interpretation = interpret.interpret(tables, words, [*document.troubles, *notes])
    trees = assemble.assemble(document, interpretation.survey, words, prose)
    if not trees:
        interpretation.survey.troubles.append(_nothing_by_rules(words))
    return Result(document, interpretation.survey, tables=tables, interpretation=interpretation), trees


def _nothing_by_rules(words: profile.Profile) -> Trouble:
    help = (
        "the other findings say why" if words.rules else "write rules in a profile (--profile): --explore proposes them"
    )
    return Trouble(NOTHING, "no rule gives a message", help=help, severity="error", sure=DOUBTFUL)


def _nothing(document: Document, found: Survey) -> Trouble:
    """That nothing was found, with the headings that were seen, or that nothing of what was found can be held."""
    if any(one.thing is not None for one in found.found):
        return Trouble(NOTHING, "tables were found, but no message and no enumeration can be represented in an ICD",
                       help="the other errors say why", severity="error", sure=DOUBTFUL)  # fmt: skip
    message = "no message and no enumeration was found"
    seen = Counter(" | ".join(cells) for table in document.tables if len(cells := _first_cells(table)) > 1)
    if seen:
        shown = ", ".join(f"`{text[:80]}`" + (f" ({n} times)" if n > 1 else "") for text, n in seen.most_common(5))
        message += f"; tables begin with {shown}"
        help = "give their headings their roles in a profile (--profile): --explore proposes one"
    elif document.tables:
        help = f"its {len(document.tables)} tables have one column; is this the right document?"
    else:
        help = "icdgen finds tables by their rules, their headings and their captions; is this the right document?"
    return Trouble(NOTHING, message, help=help, severity="error", sure=DOUBTFUL)


def _first_cells(table: Table) -> list[str]:
    rows = [table.header.titles] if table.header else [row.cells for row in table.all_rows]
    return next(([c for c in cells if c] for cells in rows if any(cells)), [])
