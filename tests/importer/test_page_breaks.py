"""Tables continue over page breaks with any engine, paper, rules, captions and
repetition of headings.
"""

from __future__ import annotations

import pytest

from tests.importer.compare import differences
from tests.importer.conftest import imported
from tests.importer.manuals import browser, content, freehand
from tests.importer.manuals.further import FURTHER
from tests.importer.test_layouts import TITLES


@pytest.mark.parametrize(
    ("layout", "skip"),
    [(name, (60, 20, 34, 60)[i % 4]) for i, name in enumerate(FURTHER)],
)
def test_tables_over_page_breaks_are_imported_completely(layout, skip, tmp_path):
    if FURTHER[layout].func is browser.draw and browser.program() is None:
        pytest.skip("Chromium is not at hand")
    manual = content.manual(content.shipped("cubeacp", most=12, skip=skip), TITLES)
    FURTHER[layout](manual, tmp_path / "manual.pdf")
    result, trees = imported(tmp_path / "manual.pdf")
    assert {t.code for t in result.import_findings if t.severity == "error"} <= {
        "IMP101"
    }
    assert [
        line
        for name, tree in manual.trees.items()
        for line in differences(tree, trees[name])
    ] == []


def test_captions_in_slanted_letters_are_distinguished_from_prose(tmp_path):
    manual = content.manual(content.shipped("cubeacp", most=12, skip=60), TITLES)
    freehand.draw(
        manual,
        tmp_path / "manual.pdf",
        freehand.FreehandLook(caption_style="", caption_slant=14),
    )
    _, trees = imported(tmp_path / "manual.pdf")
    assert differences(manual.trees["cubeacp"], trees.get("cubeacp", {})) == []
