"""Import of a document: ICD trees and findings, without writing files.

The path of a manual and a profile go in. A `Result` with the tables, findings and
certainty comes out, and the tree of an ICD for each node. `commands/import_.py` writes
the files.
"""

from __future__ import annotations

import copy
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from icdgen.import_results.findings import CERTAIN, DOUBTFUL, LIKELY, ImportFinding
from icdgen.import_results.targets import Target
from icdgen.importer import assemble, profile, reading, repairs, sources
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.model import UNKNOWN, Survey
from icdgen.importer.rules import interpret
from icdgen.importer.rules.interpret import Interpretation

NOTHING = "IMP004"


@dataclass
class Result:
    """Result of an import."""

    document: Document
    tables: list[SourceTable]
    interpretation: Interpretation
    targets: list[Target] = field(default_factory=list)

    @property
    def survey(self) -> Survey:
        """Results of all tables."""
        return self.interpretation.survey

    @property
    def import_findings(self) -> list[ImportFinding]:
        """All findings in the order of the document."""
        return sorted(
            self.survey.import_findings,
            key=lambda t: (
                t.spot.page or 0,
                t.spot.line or 0,
                t.spot.order or 0,
                t.code,
            ),
        )

    @property
    def failed(self) -> bool:
        """Whether the ICD lacks something from the manual, or may be wrong."""
        return any(t.severity == "error" for t in self.survey.import_findings)

    def sureness(self) -> Counter[str]:
        """Count tables by certainty, without tables to which no rule applies."""
        # Several rules can read one table, each with a result.
        tables = {
            entry.table.number: entry.table
            for entry in self.survey.results
            if entry.what != UNKNOWN
        }
        return Counter(self.sure_of(table) for table in tables.values())

    def sure_of(self, table: SourceTable) -> str:
        """Return the certainty of the reading of a table."""
        about = [
            t
            for t in self.survey.import_findings
            if t.is_about_table(table.spot.order) and t.code != "IMP035"
        ]
        what = next(
            (entry.what for entry in self.survey.results if entry.table is table), ""
        )
        if what == UNKNOWN or any(
            t.severity == "error" or t.sure == DOUBTFUL for t in about
        ):
            return DOUBTFUL
        return LIKELY if any(t.severity == "warning" for t in about) else CERTAIN


def run(
    manual: Path, words: profile.Profile, progress: reading.Progress | None = None, jobs: int | None = None,
    prose: bool = False, pages: tuple[int, int] | None = None,
) -> tuple[Result, dict[str, dict[str, Any]]]:  # fmt: skip
    """Read a document by the rules of a profile and return the ICD trees by node name.

    Raises `Findings` for a file that cannot be read. A document in which no rule gives
    a message has no tree and the finding IMP004. ``pages``: the first and the last one
    to read of a PDF.
    """
    document, tables = sources.read(manual, words, progress, jobs, pages)
    return apply_rules(document, tables, words, prose)


def apply_rules(
    document: Document,
    tables: list[SourceTable],
    words: profile.Profile,
    prose: bool = False,
) -> tuple[Result, dict[str, dict[str, Any]]]:
    """Read the tables of a document by the rules of a profile.

    The tables themselves are not changed.
    """
    # The workbench applies further rules to the same tables, and repairs change their
    # cells.
    tables = copy.deepcopy(tables)
    notes = repairs.mend_tables(tables, words)
    interpretation = interpret.interpret(
        tables, words, [*document.import_findings, *notes]
    )
    trees = assemble.assemble(document, interpretation.survey, words, prose)
    if not trees:
        interpretation.survey.import_findings.append(_no_message(words, tables))
    return Result(document, tables, interpretation), trees


def _no_message(words: profile.Profile, tables: list[SourceTable]) -> ImportFinding:
    """Return the finding for a document in which no rule gives a message."""
    if not tables:
        what = "the document has no table"
        help = "tables are found by their rules, headings and captions; is this the right document?"
    elif words.rules:
        what = "no rule gives a message"
        help = "the other findings say why"
    else:
        what = "no rule gives a message"
        help = "write rules in a profile (--profile): --explore proposes them, --workbench serves a page to write them"
    return ImportFinding(NOTHING, what, help=help, severity="error", sure=DOUBTFUL)
