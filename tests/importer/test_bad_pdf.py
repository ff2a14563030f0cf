"""PDFs that cannot be read, or only in part, give findings."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image
from reportlab.lib.pagesizes import A4
from reportlab.lib.pdfencrypt import StandardEncryption
from reportlab.lib.utils import ImageReader
from reportlab.pdfgen.canvas import Canvas

from icdgen.diagnostics import Findings
from icdgen.errors import UserError
from icdgen.importer import profile
from icdgen.importer.reading import pdf
from tests.importer.conftest import imported
from tests.importer.manuals import content
from tests.importer.manuals.layouts import LAYOUTS
from tests.limits import assert_limits


def drawn(
    pages: int = 1,
    text: str = "Nothing but prose.",
    encrypt=None,
    picture: bool = False,
) -> bytes:
    data = BytesIO()
    canvas = Canvas(data, pagesize=A4, encrypt=encrypt, invariant=1)
    for number in range(pages):
        if picture:
            canvas.drawImage(
                ImageReader(Image.new("L", (60, 80), 200)), 50, 50, 480, 700
            )
        if text:
            canvas.drawString(72, 700, f"{text} {number}")
        canvas.showPage()
    canvas.save()
    return data.getvalue()


@pytest.mark.parametrize(
    ("data", "message", "help"),
    [
        (drawn(), "the document has no table", ""),
        (
            drawn(encrypt=StandardEncryption("secret", canPrint=0)),
            "the PDF is encrypted",
            "remove the password",
        ),
        (
            drawn(text="", picture=True),
            "only pictures of pages: there is no text layer",
            "text recognition",
        ),
        (drawn(text=""), "pages without text", "text recognition"),
        (b"%PDF-1.4\n" + b"\x00garbage" * 40, "damaged", "download it again"),
        (b"%PDF-1.7\n", "", ""),
    ],
)
def test_an_unreadable_pdf_is_a_finding_with_a_remedy(tmp_path, data, message, help):
    path = tmp_path / "manual.pdf"
    path.write_bytes(data)
    with pytest.raises(Findings) as error:
        imported(path)
    finding = error.value.findings[0]
    assert message in finding.message
    assert help in finding.help
    assert finding.place.file == str(path)


@pytest.fixture
def spoiled(tmp_path, monkeypatch) -> Path:
    """A PDF of a readable page, a picture, a page with too much on it, and text."""
    monkeypatch.setattr(pdf, "MOST_CONTENTS", 2000)
    path = tmp_path / "spoiled.pdf"
    canvas = Canvas(str(path), pagesize=A4, invariant=1, pageCompression=0)
    canvas.drawString(72, 700, "Readable.")
    canvas.showPage()
    canvas.drawImage(ImageReader(Image.new("L", (60, 80), 200)), 50, 50, 480, 700)
    canvas.showPage()
    for row in range(100):
        canvas.drawString(72, row, "A drawing of many strokes.")
    canvas.showPage()
    canvas.drawString(72, 700, "Readable, and")
    canvas.drawString(72, 1700, "outside the page")
    canvas.save()
    return path


@pytest.mark.parametrize(
    ("only", "findings"),
    [
        (None, [("IMP011", 2), ("IMP010", 3), ("IMP013", 4)]),
        ((1, 1), []),
        ((3, 9), [("IMP010", 3), ("IMP013", 4)]),
    ],
)
def test_a_page_that_cannot_be_read_is_reported_with_its_number(
    spoiled, only, findings
):
    document = pdf.read(spoiled, profile.load(), jobs=1, only=only)
    assert [(f.code, f.spot.page) for f in document.import_findings] == findings


def test_a_document_without_a_readable_page_is_refused(spoiled):
    with pytest.raises(Findings) as error:
        pdf.read(spoiled, profile.load(), jobs=1, only=(3, 3))
    (finding,) = error.value.findings
    assert finding.code == "IMP003"
    assert "pages can be read (ValueError: its contents are more" in finding.message


def test_the_number_of_pages_is_limited(tmp_path, monkeypatch):
    monkeypatch.setattr(pdf, "MOST_PAGES", 3)
    path = tmp_path / "manual.pdf"

    def is_accepted(pages: int) -> bool:
        path.write_bytes(drawn(pages=pages))
        try:
            pdf.read(path, profile.load(), jobs=1)
        except Findings as error:
            assert f"the PDF has {pages} pages, more" in error.findings[0].message
            return False
        return True

    assert_limits(is_accepted, most=3)


def test_progress_is_reported_as_pages_and_captions(tmp_path):
    path = tmp_path / "manual.pdf"
    path.write_bytes(drawn(pages=3, text="Table 7:"))
    progress = []
    pdf.read(path, profile.load(), lambda *row: progress.append(row), jobs=1)
    assert progress == [(1, 3, 1), (2, 3, 2), (3, 3, 3)]


def test_a_range_of_pages_beyond_the_end_is_refused(tmp_path):
    path = tmp_path / "manual.pdf"
    path.write_bytes(drawn(pages=2))
    assert pdf.read(path, profile.load(), jobs=1, only=(2, 3)).pages == 1
    with pytest.raises(UserError, match="the manual has 2 pages: none from 3 to 4"):
        pdf.read(path, profile.load(), jobs=1, only=(3, 4))


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.99])
def test_a_truncated_pdf_is_a_finding_or_gives_findings(tmp_path, share):
    LAYOUTS["ruled"](
        content.manual(content.shipped("cubewheel"), {"cubewheel": "CubeWheel"}),
        tmp_path / "whole.pdf",
    )
    data = (tmp_path / "whole.pdf").read_bytes()
    (tmp_path / "part.pdf").write_bytes(data[: int(share * len(data))])
    try:
        result, _ = imported(tmp_path / "part.pdf")
    except Findings as error:
        assert error.findings
    else:
        assert result.import_findings or result.document.pages


def test_two_thousand_pages_are_read(tmp_path):
    path = tmp_path / "manual.pdf"
    path.write_bytes(drawn(pages=2000))
    with pytest.raises(Findings) as error:
        imported(path)
    assert "no table" in error.value.findings[0].message


def test_a_missing_file_is_a_finding(tmp_path):
    with pytest.raises(Findings) as error:
        imported(tmp_path / "none.pdf")
    assert "cannot read the file" in error.value.findings[0].message
