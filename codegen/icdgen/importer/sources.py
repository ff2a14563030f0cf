"""Tables of every kind of source: documents, and folders of table files.

The result is the same for all of them: a `Document` and its `SourceTable` objects.
Structs and lines of bytes in the text of a document are tables as well.
"""

from __future__ import annotations

from pathlib import Path

from icdgen.importer import reading, source_tables, table_files
from icdgen.importer.document import Document, SourceTable
from icdgen.importer.profile import Profile
from icdgen.importer.reading import byte_lines, c_structs


def read(
    path: Path,
    profile: Profile,
    progress: reading.Progress | None = None,
    jobs: int | None = None,
    pages: tuple[int, int] | None = None,
) -> tuple[Document, list[SourceTable]]:
    """Return the document and its tables.

    Raises `Findings` for a file from which nothing can be read.
    """
    if table_files.is_folder_of_tables(path):
        tables = table_files.read_tables(path)
        return table_files.document_of(path), tables
    document = reading.read(path, profile, progress, jobs, pages)
    c_structs.in_document(document)
    byte_lines.make_tables(document)
    return document, source_tables.from_document(document)
