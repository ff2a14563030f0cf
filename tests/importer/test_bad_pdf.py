"""PDFs that cannot be read, or only in part, give findings."""

from __future__ import annotations

from io import BytesIO

import pytest
from reportlab.lib.pagesizes import A4
from reportlab.lib.pdfencrypt import StandardEncryption
from reportlab.pdfgen.canvas import Canvas

from icdgen.diagnostics import Findings
from tests.importer.conftest import imported
from tests.importer.manuals import content
from tests.importer.manuals.layouts import LAYOUTS


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
            from PIL import Image
            from reportlab.lib.utils import ImageReader

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
