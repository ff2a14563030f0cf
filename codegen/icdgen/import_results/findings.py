"""Findings of an import, with their places in the source.

An `ImportFinding` is about the source and has a certainty. A `Finding` of
`diagnostics`, in contrast, is about an ICD.
"""

from __future__ import annotations

from icdgen.diagnostics import Place
from icdgen.frozen import NamedTuple

CERTAIN, LIKELY, DOUBTFUL = "certain", "likely", "doubtful"


class SourcePlace(NamedTuple):
    """Place in the source of an import: page of a PDF, line of a text, number of a
    table.
    """

    page: int | None = None
    line: int | None = None
    table: int | None = None
    # Index of the table in the document, as table numbers may be missing or repeated.
    order: int | None = None
    file: str = ""  # if several files are one source

    @property
    def place(self) -> str:
        """Place such as ``page 12`` or ``types.xml, line 3``; empty for the whole
        document.
        """
        within = ""
        if self.page is not None:
            within = f"page {self.page}"
        elif self.line is not None:
            within = f"line {self.line}"
        return ", ".join(filter(None, (self.file, within)))


class ImportFinding(NamedTuple):
    """Finding of an import.

    ``sure`` is the certainty of the result that it is about.
    """

    code: str
    message: str
    spot: SourcePlace = SourcePlace()
    help: str = ""
    severity: str = "warning"  # "error" | "warning" | "note"
    sure: str = LIKELY
    place: Place | None = None  # place of the import rule
    also: tuple[SourcePlace, ...] = ()  # further places with the same cause

    def is_about_table(self, order: int | None) -> bool:
        """Return whether the finding is about a table, by its number from 0.

        Places with the same cause count as well.
        """
        return self.spot.order == order or any(
            spot.order == order for spot in self.also
        )
