"""The documents of `docs/`, and the complete ICDs that they show."""

from __future__ import annotations

import re
from pathlib import Path

from tests.conftest import ROOT

DOCS = ROOT / "docs"
IMPORTS = ("definitions", "can", "xtce", "kaitai", "sunspec", "eds")
_EXAMPLE = re.compile(r"```yaml\n(icdgen: 1\n.*?)```", re.DOTALL)
_HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)


def pages() -> list[Path]:
    """Return all pages, in the order of their paths."""
    return sorted(DOCS.rglob("*.md"))


def text(name: str) -> str:
    """Return the text of a page; an example of a name is ``guides/scales``."""
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def blocks(page: str, language: str) -> list[str]:
    """Return the code blocks of a language on a page."""
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.DOTALL | re.MULTILINE)


def icds(page: str) -> list[str]:
    """Return the complete ICDs on a page."""
    return _EXAMPLE.findall(page)


def layout(icd: str) -> str:
    """Return a pattern of the text that `icdgen fmt` writes for an ICD of a page.

    The pattern has each row of a table on one line, because pages wrap long rows.
    """
    joined = re.sub(
        r"^ +- \{(?:.*,\n +)+",
        lambda row: re.sub(r"\n +", "\0", row[0]),
        icd,
        flags=re.MULTILINE,
    )
    # The last column before a break can be padded, as in other rows.
    return re.escape(joined).replace("\0", " +")


def icds_by_heading(page: str) -> dict[str, list[str]]:
    """Return the complete ICDs on a page, by the nearest heading above each."""
    examples: dict[str, list[str]] = {}
    for match in _EXAMPLE.finditer(page):
        # A comment in an earlier example is no heading.
        before = re.sub(
            r"^```.*?^```", "", page[: match.start()], flags=re.DOTALL | re.MULTILINE
        )
        examples.setdefault(_HEADING.findall(before)[-1], []).append(match[1])
    return examples
