"""Reading of files as documents, with one table model behind all kinds.

`read` recognizes the kind of a file by its first bytes and its suffix. The modules of
this package read one kind each; `pages` analyses the pages of a PDF.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.errors import UserError
from icdgen.importer.document import Document
from icdgen.importer.profile import Profile

MAX_BYTES = 300_000_000
# Pages done, pages altogether, captions seen.
Progress = Callable[[int, int, int], None]


def read(
    path: Path, profile: Profile, progress: Progress | None = None, jobs: int | None = None,
    pages: tuple[int, int] | None = None,
) -> Document:  # fmt: skip
    """Return the document in ``path``.

    Raise `Findings` if nothing can be read, and `UserError` for pages that do not
    exist.
    """
    name = str(path)
    try:
        with open(path, "rb") as file:
            start = file.read(2048)
            size = file.seek(0, 2)
    except OSError as error:
        raise _refused(
            name, f"cannot read the file: {error.strerror}", "check the path"
        ) from None
    if not start:
        raise _refused(
            name, "the file is empty", "name a PDF, or a text with tab-separated tables"
        )
    if size > MAX_BYTES:
        raise _refused(
            name,
            f"the file has more than the {MAX_BYTES:,} bytes allowed",
            "cut it into parts",
        )
    # PDF 32000-1, 7.5.2 puts the header into the first line. Acrobat also accepts it
    # elsewhere in the first 1,024 bytes.
    if b"%PDF-" in start[:1024]:
        from icdgen.importer.reading import pdf

        return pdf.read(path, profile, progress, jobs, pages)
    kind = _kind(path, start)
    if pages is not None:
        raise UserError(f"{name} has no pages", "leave --pages out")
    if kind == "c":
        from icdgen.importer.reading import c_structs

        return c_structs.read_header(path)
    if kind in ("csv", "xlsx"):
        from icdgen.importer.reading import spreadsheet

        return (
            spreadsheet.read_csv(path) if kind == "csv" else spreadsheet.read_xlsx(path)
        )
    if kind:
        from icdgen.importer.reading import markup

        readers = {
            "docx": markup.read_docx,
            "html": markup.read_html,
            "markdown": markup.read_markdown,
        }
        return readers[kind](path, profile)
    # Other ZIP archives, and documents of Office before 2007 (OLE).
    if b"\0" in start or start[:4] in (b"PK\x03\x04", b"\xd0\xcf\x11\xe0"):
        raise _refused(
            name,
            "icdgen does not read this kind of document",
            "export it as PDF, .docx, .xlsx, CSV or HTML first",
        )
    from icdgen.importer.reading import text

    return text.read(path, profile)


def _kind(path: Path, start: bytes) -> str:
    """Return the kind of a document other than PDF or text, by its first bytes and its
    suffix.
    """
    suffix = path.suffix.casefold()
    # Office documents are ZIP archives: only their suffix tells them apart here.
    if start[:4] == b"PK\x03\x04":
        return {".xlsx": "xlsx", ".xlsm": "xlsx", ".docx": "docx"}.get(suffix, "")
    if suffix in (".html", ".htm", ".xhtml") or start.lstrip()[:15].lower().startswith(
        (b"<!doctype html", b"<html")
    ):
        return "html"
    return {
        ".csv": "csv",
        ".md": "markdown",
        ".markdown": "markdown",
        ".h": "c",
        ".c": "c",
    }.get(suffix, "")


def _refused(name: str, message: str, help: str) -> Findings:
    return Findings([Finding("IMP002", message, Place(name), help)])
