"""Hostile PDFs give a clear finding in limited time and memory."""

from __future__ import annotations

import resource
import subprocess
import sys
import zlib
from collections.abc import Callable

import pytest

LIMIT = 60  # seconds of processor time; each takes a few
MEMORY = 2_000_000_000  # bytes


def objects(*bodies: bytes, root: int = 1, xref: bool = True) -> bytes:
    """Return a PDF of these objects, numbered from 1."""
    data, places = b"%PDF-1.7\n", []
    for number, body in enumerate(bodies, 1):
        places.append(len(data))
        data += b"%d 0 obj\n%s\nendobj\n" % (number, body)
    start = len(data)
    if xref:
        data += b"xref\n0 %d\n0000000000 65535 f \n" % (len(bodies) + 1)
        data += b"".join(b"%010d 00000 n \n" % place for place in places)
    data += b"trailer\n<< /Size %d /Root %d 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (
        len(bodies) + 1,
        root,
        start,
    )
    return data


CATALOG = b"<< /Type /Catalog /Pages 2 0 R >>"
FONT = b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"


def stream(data: bytes, squeezed: bool = False) -> bytes:
    body = zlib.compress(data, 9) if squeezed else data
    return b"<< /Length %d%s >>\nstream\n%s\nendstream" % (
        len(body),
        b" /Filter /FlateDecode" if squeezed else b"",
        body,
    )


def page(contents: bytes, box: bytes = b"[0 0 595 842]") -> list[bytes]:
    return [CATALOG, b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
            b"<< /Type /Page /Parent 2 0 R /MediaBox %s /Contents 4 0 R /Resources << /Font << /F 5 0 R >> >> >>" % box,
            contents, FONT]  # fmt: skip


def text(words: str) -> bytes:
    return stream(f"BT /F 12 Tf 72 700 Td ({words}) Tj ET".encode())


# Made when they are used: one of them is compressed from 500 MB.
HOSTILE: dict[str, Callable[[], bytes]] = {
    "a tree of pages that holds itself": lambda: objects(
        CATALOG, b"<< /Type /Pages /Kids [2 0 R 2 0 R] /Count 9 >>"
    ),
    "pages that hold each other": lambda: objects(
        CATALOG,
        b"<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        b"<< /Type /Pages /Kids [2 0 R] /Parent 2 0 R /Count 1 >>",
    ),
    "no table of objects": lambda: objects(*page(text("prose")), xref=False),
    "a table of objects that lies": lambda: objects(*page(text("prose"))).replace(
        b"0000000015", b"0000000099"
    ),
    "a root that is not there": lambda: objects(*page(text("prose")), root=77),
    "contents that are half a gigabyte": lambda: objects(
        *page(stream(b" " * 500_000_000, squeezed=True))
    ),
    "a page as large as a country": lambda: objects(
        *page(text("prose"), b"[0 0 1e9 1e9]")
    ),
    "a page without size": lambda: objects(*page(text("prose"), b"[0 0 0 0]")),
    "more rules than any table": lambda: objects(
        *page(stream(b"0 0 m 9 9 l S\n" * 30_000, squeezed=True))
    ),
    "a drawing of ten megabytes": lambda: objects(
        *page(stream(b"0 0 m 9 9 l S\n" * 700_000, squeezed=True))
    ),
    "ten thousand pages": lambda: objects(
        CATALOG,
        b"<< /Type /Pages /Count 10000 /Kids [%s] >>"
        % b" ".join(b"%d 0 R" % n for n in range(3, 10_003)),
        *[b"<< /Type /Page /Parent 2 0 R /MediaBox [0 0 595 842] >>"] * 10_000,
    ),
    "operators without operands": lambda: objects(
        *page(stream(b"Tj TJ Tf Td cm q Q Q Q BT ET re l m " * 500))
    ),
    "a font that is its own parent": lambda: objects(
        *page(text("prose"))[:-1],
        b"<< /Type /Font /Subtype /Type0 /DescendantFonts [5 0 R] >>",
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_pdf_is_a_finding_in_bounded_time_and_memory(name, tmp_path):
    (tmp_path / "hostile.pdf").write_bytes(HOSTILE[name]())

    def bounded() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))

    command = [
        sys.executable,
        "-m",
        "icdgen",
        "import",
        "hostile.pdf",
        "--jobs",
        "1",
        "--report",
        "report.html",
    ]
    run = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, preexec_fn=bounded
    )
    assert run.returncode == 1, (run.returncode, run.stderr[-2000:])
    assert "Traceback" not in run.stderr
    assert "error[IMP00" in run.stdout + run.stderr
    assert not (tmp_path / "icd").exists()
