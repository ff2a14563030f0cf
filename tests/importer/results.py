"""Results of an import made of tables and findings, for tests of its reports."""

from __future__ import annotations

from collections.abc import Sequence

from icdgen.import_results.findings import ImportFinding
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.model import Survey, TableResult
from icdgen.importer.rules.interpret import Interpretation
from icdgen.importer.run import Result


def result_of(
    *entries: tuple[SourceTable, str],
    findings: Sequence[ImportFinding] = (),
    file: str = "pump.txt",
    pages: int | None = None,
) -> Result:
    """Return the result of tables, each with what it was read as."""
    tables = list({id(table): table for table, _ in entries}.values())
    results = [TableResult(table, what, None) for table, what in entries]
    survey = Survey(results, list(findings))
    document = Document(file, list(tables), pages=pages)
    return Result(document, tables, Interpretation([], [], survey, {}, []))
