"""The links of the documents lead to existing pages and headings, and the index lists
every page.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from icdgen.backends.html.guide import anchor_of
from scripts import reference_pages
from tests import documents
from tests.conftest import ROOT

PAGES = [
    *documents.pages(),
    *sorted(ROOT.glob("*.md")),
    *sorted(ROOT.glob("tests/*/README.md")),
]
MANUAL = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *documents.pages()]


def _name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def prose(page: Path) -> str:
    return re.sub(
        r"^\s*```.*?^\s*```",
        "",
        page.read_text("utf-8"),
        flags=re.DOTALL | re.MULTILINE,
    )


def links(page: Path) -> Iterator[str]:
    yield from re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`\n]*`", "", prose(page)))


def anchors(page: Path) -> set[str]:
    return {
        anchor_of(re.sub(r"[`*]", "", title))
        for title in re.findall(r"^#+ (.*)$", prose(page), re.MULTILINE)
    }


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_every_link_leads_to_a_page_and_heading_that_exists(page):
    dead = []
    for link in links(page):
        name, _, anchor = link.partition("#")
        if ":" in name:
            continue
        target = (page.parent / name).resolve() if name else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            dead.append(link)
    assert dead == []


def wrapped_lines(page: Path) -> Iterator[str]:
    """Yield the lines of a page that must be wrapped.

    Rows of Markdown tables and the output of commands are not wrapped.
    """
    language, command = "", False
    for line in page.read_text("utf-8").splitlines():
        if fence := re.match(r"\s*```(\w*)", line):
            language = "" if language else fence[1] or "text"
        # A backslash continues the command on the next line.
        command = line.startswith("$ ") or command
        is_output = language == "console" and not command
        command = command and line.endswith("\\")
        if not is_output and (language or not line.startswith("|")):
            yield line


@pytest.mark.parametrize("page", MANUAL, ids=_name)
def test_a_source_line_has_at_most_100_characters_except_tables_and_output(page):
    assert [line for line in wrapped_lines(page) if len(line) > 100] == []


@pytest.mark.parametrize("page", MANUAL, ids=_name)
def test_a_console_block_begins_with_a_command(page):
    blocks = re.findall(r"^ *```console\n(.*)", page.read_text("utf-8"), re.MULTILINE)
    assert [line for line in blocks if not line.startswith("$ ")] == []


def test_generated_reference_pages_are_current():
    old = [
        path.name
        for path, text in reference_pages.pages().items()
        if path.read_text("utf-8") != text
    ]
    assert old == [], "run `python -m scripts.reference_pages`"


def test_the_index_lists_every_page():
    index = documents.DOCS / "README.md"
    listed = {
        (index.parent / link.partition("#")[0]).resolve() for link in links(index)
    }
    assert [
        page.name
        for page in documents.pages()
        if page.resolve() not in listed | {index}
    ] == []


def test_the_path_of_a_field_through_the_generator_names_existing_functions():
    page = (ROOT / "docs" / "explanation" / "architecture.md").read_text("utf-8")
    section = page.split("## One field from YAML to C")[1].split("\n## ")[0]
    rows = [
        row.split("|")[2]
        for row in section.splitlines()
        if row.startswith("|") and "`" in row
    ]
    assert len(rows) > 15
    for row in rows:
        source = ""
        for word in re.findall(r"`([^`]+)`", row):
            if word.endswith((".py", ".h", ".j2")):
                file = (
                    ROOT / word
                    if word.split("/")[0] in ("templates", "runtime")
                    else ROOT / "codegen" / "icdgen" / word
                )
                source = file.read_text("utf-8")
            else:
                assert re.search(
                    rf"(def |class |\s|\*){word}\(|class {word}\b|def {word}\b", source
                ), (row, word)
