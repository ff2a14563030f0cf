"""Any change to the text of a page gives neither a traceback nor a field that the page
does not show.
"""

from __future__ import annotations

import random
import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from icdgen.diagnostics import Findings
from icdgen.importer import html, profile, run
from icdgen.importer.pages.extract import PageContents, Word
from icdgen.importer.reading import pdf
from icdgen.importer.rules import explore
from tests.importer.manuals.wild import WILD
from tests.importer.test_text import ENUM, LIST, LISTED, MESSAGE, PUMP

RULES = (
    LISTED
    + """  - rule: bytes
    tables: {head: Offset | Size | Name}
    message: {heading: '^[.0-9]+ {message} [(]{id}[)]$', kind: telemetry}
    columns: {Offset: byte, Size: bytes, Name: name, Type: type, Unit: ['^{scale}(?: {unit:[^ ]+})?$', unit]}
  - rule: map
    tables: {head: Addr | Name | R/W | 7}
    what: registers
    message: {length: 1}
    columns: {Addr: id, Name: message, R/W: kind, "*": name}
    melt: '^{bit}$'
    map: {kind: {R/W: configuration}}
    each: {type: uint}
"""
)
TEXT = LIST + MESSAGE + ENUM + (
    "\n5 Telemetry\n\n5.1 Motor State (0x21)\n\nOffset\tSize\tName\tType\tUnit\n0\t1\tMode\tU8\t-\n"
    "1\t2\tSpeed\tU16\t10 rpm\n3\t4\tTime\tU32\tms\n"
    "\nAddr\tName\tR/W\t7\t6\t5\t4\t3\t2\t1\t0\n0x40\tCTRL\tR/W\trate\t\t\tmode\t\t-\tboot\ten\n"
)  # fmt: skip


def shown_numbers(text: str) -> set[int]:
    """Return every number of the page, and the numbers that arrays, ranges and units of
    bytes give.
    """
    numbers = {int(n) for n in re.findall("[0-9]+", text)} | {
        int(n, 16) for n in re.findall("0x([0-9A-Fa-f]+)", text)
    }
    return numbers | {8 * n for n in numbers}


def _is_shown(word: str, squeezed: str) -> bool:
    """Return whether the page shows a word, or two adjacent words of which one was
    moved.
    """
    return word in squeezed or any(
        word[:i] in squeezed and word[i:] in squeezed for i in range(1, len(word))
    )


def check(trees: dict, text: str) -> None:
    """Check that the ICD contains only names, factors, units and widths of the text."""
    squeezed = re.sub(r"\s+", "", text)
    numbers = shown_numbers(text)
    widths = {8, 16, 32, 64, 1}
    for tree in trees.values():
        for message in tree.get("messages", ()):
            for field in message.get("fields", ()):
                for factor in re.findall(
                    r"[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?", field.get("formula", "")
                ):
                    assert factor in text or factor.removeprefix("0") in text, field
                assert all(
                    _is_shown(word, squeezed)
                    for word in re.findall("[A-Za-z]+", field["name"])
                ), field
                assert all(
                    word in squeezed for word in field.get("unit", "").split()
                ), field
                spans = (
                    {b - a + 1 for a in numbers for b in numbers if b >= a}
                    if len(numbers) < 60
                    else numbers
                )
                assert field["bits"] in numbers | widths | spans | {
                    8 * s for s in spans
                }, field


@settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=list(HealthCheck),
    derandomize=True,
)
@given(data=st.data())
def test_shuffled_cut_and_dropped_cells_of_a_text_are_read_or_reported(
    data, tmp_path_factory
):
    rows = [line.split("\t") for line in TEXT.split("\n")]
    for _ in range(data.draw(st.integers(1, 12))):
        row = data.draw(st.integers(0, len(rows) - 1))
        cell = data.draw(st.integers(0, len(rows[row]) - 1)) if rows[row] else 0
        what = data.draw(
            st.sampled_from(("drop", "cut", "swap", "move", "torn", "gone", "twice"))
        )
        if not rows[row]:
            continue
        if what == "drop":
            rows[row].pop(cell)
        elif what == "cut":
            rows[row][cell] = rows[row][cell][: data.draw(st.integers(0, 8))]
        elif what == "swap":
            rows[row].insert(0, rows[row].pop(cell))
        elif what == "move":
            rows.insert(data.draw(st.integers(0, len(rows))), rows.pop(row))
        elif what == "torn":
            rows[row : row + 1] = [rows[row][:cell], rows[row][cell:]]
        elif what == "gone":
            rows[row] = [""]
        else:
            rows.insert(row, list(rows[row]))
    text = "\n".join("\t".join(row) for row in rows)
    path = tmp_path_factory.mktemp("text") / "manual.txt"
    path.write_text(text, encoding="utf-8")
    rules = path.with_name("rules.yaml")
    rules.write_text(
        PUMP.read_text(encoding="utf-8").replace("phrases:", f"{RULES}phrases:"),
        encoding="utf-8",
    )
    result, trees = run.run(path, profile.load(rules), jobs=1)
    check(trees, text)
    explore.report(result.tables, "manual.txt")
    html.report(result)


@pytest.mark.parametrize("layout", ["sections", "registers"])
def test_shuffled_and_dropped_words_of_pages_are_read_or_reported(
    layout, tmp_path, monkeypatch
):
    WILD[layout].draw(tmp_path / "motor.pdf")
    (tmp_path / "rules.yaml").write_text(WILD[layout].profile, encoding="utf-8")
    words = profile.load(tmp_path / "rules.yaml")
    pages = [pdf.extract(page) for page in _pages(tmp_path / "motor.pdf")]
    for seed in range(25):
        chance = random.Random(seed)
        spoiled = [_spoiled(page, chance) for page in pages]
        monkeypatch.setattr(
            pdf, "_pages", lambda path, wanted, jobs, pages=spoiled: iter(pages)
        )
        try:
            _, trees = run.run(tmp_path / "motor.pdf", words, jobs=1)
        except Findings:
            continue
        check(trees, " ".join(word.text for page in spoiled for word in page.words))


def _pages(path):
    import pdfplumber

    with pdfplumber.open(path) as file:
        yield from file.pages


def _spoiled(page: PageContents, chance: random.Random) -> PageContents:
    words = []
    for word in page.words:
        what = chance.random()
        if what < 0.03:
            continue
        if what < 0.06:
            word = Word(word.text[: chance.randint(1, 3)], *word[1:])
        elif what < 0.09:
            shift = chance.uniform(-60, 60)
            word = word._replace(x0=word.x0 + shift, x1=word.x1 + shift)
        elif what < 0.12:
            shift = chance.uniform(-30, 900)
            word = word._replace(top=word.top + shift, bottom=word.bottom + shift)
        words.append(word)
    chance.shuffle(words)
    return PageContents(page.number, page.width, page.height, words, *(
        [rule for rule in rules if chance.random() > 0.05] for rules in (page.across, page.down)
    ), page.fills)  # fmt: skip
