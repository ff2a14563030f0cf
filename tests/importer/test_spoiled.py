"""An unreadable number or heading, in each layout of `wild.py`, is a finding on its
page.
"""

from __future__ import annotations

import pdfplumber
import pytest

from icdgen.importer import profile, run
from icdgen.importer.pages.extract import PageContents, Word, extract
from icdgen.importer.reading import pdf
from tests.importer.compare import differences
from tests.importer.manuals import browser, office
from tests.importer.manuals.typeset import TYPESET
from tests.importer.manuals.wild import UNSEEN, WILD

LAYOUTS = WILD | UNSEEN | TYPESET | office.OFFICE
BY_BROWSER = ("prose", "ranges", "frames", "sheet")
BY_TYPST = ("article", "two columns")
HEADS = {
    "Offset",
    "Size",
    "Bits",
    "Type",
    "Unit",
    "Scale",
    "Field",
    "Name",
    "Byte",
    "Position",
}


def drawn(layout: str, path):
    if layout in BY_BROWSER and browser.program() is None:
        pytest.skip("Chromium is not at hand")
    if layout in office.OFFICE and office.program() is None:
        pytest.skip("LibreOffice is not at hand")
    if layout in BY_TYPST:
        pytest.importorskip("typst")
    LAYOUTS[layout].draw(path)
    return path


def spoilt(page: PageContents, index: int) -> PageContents:
    words = list(page.words)
    word = words[index]
    words[index] = word._replace(text=f"{word.text[0]}?{word.text[1:]}")
    return PageContents(
        page.number, page.width, page.height, words, page.across, page.down, page.fills
    )


def matters(
    word: Word, result: run.Result, page: PageContents, names: set[str]
) -> bool:
    """Return whether a word is a number or heading in a table, or the byte number of a
    line. Any name that the page contains is correct.
    """
    boxes = [
        box
        for table in result.document.tables
        for box in table.boxes
        if box.page == page.number
    ]
    inside = any(
        b.x0 - 1 <= word.x0 <= b.x1 + 1 and b.top - 1 <= word.middle <= b.bottom + 1
        for b in boxes
    )
    inside = inside or word.text.startswith("Byte")
    return (
        inside
        and word.text not in names
        and (word.text in HEADS or any(c.isdigit() for c in word.text))
    )


@pytest.mark.parametrize("layout", LAYOUTS)
def test_an_unreadable_cell_that_changes_the_icd_is_a_finding_on_its_page(
    layout, tmp_path, monkeypatch
):
    path = drawn(layout, tmp_path / "motor.pdf")
    (tmp_path / "rules.yaml").write_text(LAYOUTS[layout].profile, encoding="utf-8")
    words, wanted = (
        profile.load(tmp_path / "rules.yaml"),
        {"messages": LAYOUTS[layout].messages},
    )
    names = {
        part
        for message in wanted["messages"]
        for f in message["fields"]
        for part in (message["name"], f["name"])
    }
    with pdfplumber.open(path) as file:
        pages = [extract(page) for page in file.pages]

    def imported(pages: list[PageContents]) -> tuple[run.Result, dict]:
        monkeypatch.setattr(pdf, "_pages", lambda path, wanted, jobs: iter(pages))
        result, trees = run.run(path, words, jobs=1)
        return result, next(iter(trees.values()), {})

    unspoiled, tree = imported(pages)
    assert differences(wanted, tree, tables=False) == []
    before = {(t.code, t.message) for t in unspoiled.import_findings}
    tried, silent = 0, []
    for number, page in enumerate(pages):
        for index, word in enumerate(page.words):
            if not matters(word, unspoiled, page, names):
                continue
            tried += 1
            result, tree = imported(
                [*pages[:number], spoilt(page, index), *pages[number + 1 :]]
            )
            reported = [
                t
                for t in result.import_findings
                if (t.severity != "note" or t.code == "IMP032")
                and t.spot.page == page.number
            ]
            if differences(wanted, tree, tables=False) and all(
                (t.code, t.message) in before for t in reported
            ):
                silent.append(word.text)
    assert tried > 5
    assert silent == []
