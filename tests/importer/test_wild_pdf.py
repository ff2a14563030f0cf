"""Documents in the style of sensor and modem vendors give their ICD by short rules."""

from __future__ import annotations

import pytest
from reportlab.lib import colors
from reportlab.lib.styles import getSampleStyleSheet
from reportlab.platypus import Paragraph, SimpleDocTemplate, Table

from icdgen.importer import profile, run
from tests.importer.compare import differences
from tests.importer.manuals import browser, office
from tests.importer.manuals.typeset import TYPESET
from tests.importer.manuals.wild import MESSAGES, PROSE, UNSEEN, WILD, rule


@pytest.mark.parametrize("layout", [*WILD, *UNSEEN, *TYPESET, *office.OFFICE])
def test_a_vendor_style_document_gives_its_icd(layout, tmp_path):
    wild = (WILD | UNSEEN | TYPESET | office.OFFICE)[layout]
    if browser.program() is None and layout in ("prose", "ranges", "frames", "sheet"):
        pytest.skip("Chromium is not at hand")
    if office.program() is None and layout in office.OFFICE:
        pytest.skip("LibreOffice is not at hand")
    if layout in ("article", "two columns"):
        pytest.importorskip("typst")
    wild.draw(tmp_path / "motor.pdf")
    (tmp_path / "rules.yaml").write_text(wild.profile, encoding="utf-8")
    result, trees = run.run(
        tmp_path / "motor.pdf", profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    assert (
        differences(
            {"messages": wild.messages}, next(iter(trees.values())), tables=False
        )
        == []
    )
    assert [t.message for t in result.import_findings if t.severity == "error"] == []


@pytest.mark.parametrize(
    "caption", ["{name} (0x{id:02X})", "Table {number}: {name} (0x{id:02X})"]
)
def test_prose_between_a_caption_and_its_table_does_not_separate_them(
    tmp_path, caption
):
    style = getSampleStyleSheet()
    body = style["BodyText"]
    story: list = [Paragraph("Telemetry", style["Heading1"]), Paragraph(PROSE, body)]
    for number, message in enumerate(MESSAGES, 1):
        rows = [["Offset (bits)", "Length (bits)", "Name", "Data Type", "Unit"]]
        rows += [
            [
                str(f["at"]),
                str(f["bits"]),
                f["name"],
                f["type"].upper(),
                f.get("unit", "-"),
            ]
            for f in message["fields"]
        ]
        text = caption.format(number=number, name=message["name"], id=message["id"])
        story += [
            Paragraph(text, body.clone("caption", fontName="Helvetica-Oblique")),
            Paragraph(f"{PROSE} {PROSE}", body),
        ]
        story += [
            Paragraph("The lowest byte comes first.", body),
            Table(rows, style=[("GRID", (0, 0), (-1, -1), 0.5, colors.black)]),
        ]
    SimpleDocTemplate(str(tmp_path / "motor.pdf")).build(story)
    rules = rule(
        "Offset (bits) | Length (bits)", r"{}: '{{message}} \({{id}}\)$'".format("caption" if "Table" in caption else "before"),
        "Offset (bits): bit, Length (bits): bits, Name: name, Data Type: type, Unit: unit",
    )  # fmt: skip
    (tmp_path / "rules.yaml").write_text(rules, encoding="utf-8")
    _, trees = run.run(
        tmp_path / "motor.pdf", profile.load(tmp_path / "rules.yaml"), jobs=1
    )
    plain = [
        m
        | {
            "fields": [
                {k: v for k, v in f.items() if k != "formula"} for f in m["fields"]
            ]
        }
        for m in MESSAGES
    ]
    assert (
        differences({"messages": plain}, next(iter(trees.values())), tables=False) == []
    )
