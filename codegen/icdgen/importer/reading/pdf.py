"""Reading of a PDF as a document.

Worker processes extract the pages (`pages/extract.py`), because that takes most of the
time. `pages/flow.py` and `pages/tables.py` then assemble them in this process.
"""

from __future__ import annotations

import contextlib
import logging
import os
import signal
import zlib
from collections.abc import Callable, Iterator
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from icdgen.diagnostics import Finding, Findings, Place
from icdgen.errors import UserError
from icdgen.import_results.findings import ImportFinding, SourcePlace
from icdgen.importer.document import Document
from icdgen.importer.pages import flow, tables
from icdgen.importer.pages.extract import PageContents, extract
from icdgen.importer.profile import Profile

FEW = 12  # pages; below this, starting processes costs more than it saves
MOST_PAGES = 5000
# Bytes of a page: a table has some ten thousand; drawings with more would take minutes.
MOST_CONTENTS = 6_000_000


def read(
    path: Path, profile: Profile, progress: Callable[[int, int, int], None] | None = None, jobs: int | None = None,
    only: tuple[int, int] | None = None,
) -> Document:  # fmt: skip
    """Return the document of a PDF, or of a range of its pages.

    Raise `Findings` if nothing can be read.
    """
    name = str(path)
    count, title = _open(path, name)
    wanted = range(count)
    if only is not None:
        wanted = range(only[0] - 1, min(only[1], count))
        if not wanted:
            raise UserError(
                f"the manual has {count} pages: none from {only[0]} to {only[1]}",
                "choose other --pages",
            )
    document = Document(name, pages=len(wanted), title=title)
    count = len(wanted)
    pages = []
    seen = 0
    for page in _pages(path, wanted, jobs):
        pages.append(page)
        if progress:
            seen += _captions(page, profile)
            progress(len(pages), count, seen)
    _look_over(pages, document, name)
    items = flow.items(pages, profile)
    document.blocks = tables.TableBuilder(
        profile, _known(pages), is_part=only is not None
    ).build_tables(items)
    return document


def _open(path: Path, name: str) -> tuple[int, str]:
    """Return the number of pages and the title."""
    try:
        import pdfplumber
        from pdfminer.pdfdocument import PDFEncryptionError, PDFPasswordIncorrect
        from pdfplumber.utils.exceptions import PdfminerException
    except ImportError:
        raise UserError(
            "reading a PDF needs pdfplumber", "pip install 'icdgen[import]'"
        ) from None
    logging.getLogger("pdfminer").setLevel(logging.CRITICAL)
    try:
        with pdfplumber.open(path) as file:
            count = len(file.pages)
            title = (file.metadata or {}).get("Title")
    except (
        Exception
    ) as error:  # pdfminer raises whatever a broken file makes it stumble over
        cause = (
            error.args[0]
            if isinstance(error, PdfminerException) and error.args
            else error
        )
        if isinstance(cause, (PDFPasswordIncorrect, PDFEncryptionError)):
            help = "remove the password first, for instance with `qpdf --decrypt`"
            raise _refused(name, "the PDF is encrypted", help) from None
        raise _refused(
            name, f"the PDF is damaged ({type(cause).__name__}: {cause})" if str(cause) else "the PDF is damaged",
            "download it again, or repair it, for instance with `qpdf` or `mutool clean`",
        ) from None  # fmt: skip
    if count == 0:
        raise _refused(
            name, "the PDF has no pages", "it may be truncated: download it again"
        )
    if count > MOST_PAGES:
        raise _refused(
            name,
            f"the PDF has {count:,} pages, more than the {MOST_PAGES:,} allowed",
            "cut it into parts",
        )
    return count, title if isinstance(title, str) else ""


def _refused(name: str, message: str, help: str) -> Findings:
    return Findings([Finding("IMP003", message, Place(name), help)])


def _pages(path: Path, wanted: range, jobs: int | None) -> Iterator[PageContents]:
    count = len(wanted)
    # macOS and Windows lack `sched_getaffinity`.
    available = (
        len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else os.cpu_count() or 1
    )
    jobs = min(jobs or available, 8)
    if jobs <= 1 or count < FEW:
        # In this process, an interrupt must still end the import.
        _start_worker(path, ignore=False)
        try:
            for number in wanted:
                yield _work(number)
        finally:
            _end_worker()
        return
    with get_context().Pool(jobs, _start_worker, (path, True)) as pool:
        # `imap` returns the pages in their order, which tables across pages need.
        yield from pool.imap(
            _work, wanted, chunksize=max(1, min(8, count // (4 * jobs)))
        )


_open_file: Any = None


def _start_worker(path: Path, ignore: bool) -> None:
    """Open the file once in a process. Worker processes ignore interrupts, which the
    parent handles.
    """
    global _open_file
    import pdfplumber

    if ignore:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    logging.getLogger("pdfminer").setLevel(logging.CRITICAL)
    _open_file = pdfplumber.open(path)


def _end_worker() -> None:
    global _open_file
    if _open_file is not None:
        _open_file.close()
    _open_file = None


def _work(number: int) -> PageContents:
    assert _open_file is not None
    page = _open_file.pages[number]
    try:
        _weigh(page)
        return extract(page)
    except Exception as error:  # one broken page must not cost the others
        # The size of A4 in points.
        return PageContents(
            number + 1, 595.0, 842.0, failed=f"{type(error).__name__}: {error}"[:200]
        )
    finally:
        page.close()


def _weigh(page: Any) -> None:
    """Raise `ValueError` for a page whose contents unpack to more than any page of text
    and tables needs.
    """
    from pdfminer.pdftypes import stream_value

    left = MOST_CONTENTS
    for stream in page.page_obj.contents:
        raw = stream_value(stream).rawdata or b""
        unpacked = len(raw)
        # Unpacked as far as the limit and no further: some kilobytes can unpack to
        # gigabytes. Contents that are not compressed fail here, and have their raw
        # size.
        # To zlib, a limit of 0 is no limit; `left` is at least 0 here.
        with contextlib.suppress(zlib.error):
            unpacked = max(
                unpacked, len(zlib.decompressobj().decompress(raw, left + 1))
            )
        left -= unpacked
        if left < 0:
            raise ValueError(f"its contents are more than {MOST_CONTENTS:,} bytes")


def _look_over(pages: list[PageContents], document: Document, name: str) -> None:
    """Report pages without text and with unreadable characters.

    Raises `Findings` if the document has no text.
    """
    words = sum(len(page.words) for page in pages)
    if not words:
        images = sum(page.images for page in pages)
        failed = [page for page in pages if page.failed]
        if failed:
            text = f"none of the {len(pages)} pages can be read ({failed[0].failed})"
            raise _refused(name, text, "the file is damaged: download it again")
        what = "pictures of pages" if images else "pages without text"
        help = "run it through a text recognition first, for instance `ocrmypdf`, and check its figures twice"
        raise _refused(name, f"the PDF holds only {what}: there is no text layer", help)
    for page in pages:
        document.import_findings += [
            import_finding._replace(spot=SourcePlace(page.number))
            for import_finding in _of_page(page)
        ]


def _of_page(page: PageContents) -> Iterator[ImportFinding]:
    """Report the parts of a page that cannot be read."""
    if page.failed:
        help = "its content is missing from the ICD"
        yield ImportFinding(
            "IMP010",
            f"the page cannot be read ({page.failed})",
            help=help,
            severity="error",
        )
    elif not page.words and page.images:
        help = "look whether it shows a table: it is missing from the ICD"
        yield ImportFinding("IMP011", "the page is a picture without text", help=help)
    if page.unseen:
        what = f"{page.unseen} words stand outside the visible page; they were left out"
        yield ImportFinding(
            "IMP013", what, help="look whether the page is cut off", severity="note"
        )
    if page.turned:
        what = f"{page.turned} words are rotated; they were left out"
        help = "check whether a table or its labels are rotated"
        yield ImportFinding("IMP014", what, help=help, severity="note")
    if page.unmapped:
        what = f"{page.unmapped} characters of the page cannot be read: the PDF does not map their glyphs to characters"
        yield ImportFinding("IMP012", what, help="compare what was read with the page")


def _captions(page: PageContents, profile: Profile) -> int:
    """Return about how many tables begin on the page, for the display of progress."""
    heads = {word.rstrip(".") for word in profile.data["captions"]}
    pairs = pairwise(word.text for word in page.words)
    return sum(
        a.rstrip(".") in heads and b[:1].isdigit() and b[-1:] in ":.–-"
        for a, b in pairs
    )


def _known(pages: list[PageContents]) -> frozenset[str]:
    """Return all words of the document that are not broken at the end of a line."""
    return frozenset(
        word.text.strip(".,;:()[]") for page in pages for word in page.words
    )
