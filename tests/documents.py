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
    """All pages, in the order of their paths."""
    return sorted(DOCS.rglob("*.md"))


def text(name: str) -> str:
    """Text of a page: ``guides/scales``."""
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def blocks(page: str, language: str) -> list[str]:
    """Code blocks of a language that a page shows."""
    return re.findall(rf"^```{language}\n(.*?)^```", page, re.DOTALL | re.MULTILINE)


def icds(page: str) -> list[str]:
    """Complete ICDs that a page shows."""
    return _EXAMPLE.findall(page)


def layout(icd: str) -> str:
    """Pattern of the text that `icdgen fmt` writes for an ICD of a page: each row of a
    table on one line. Pages wrap long rows.
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
    """Complete ICDs that a page shows, by the nearest heading above each."""
    examples: dict[str, list[str]] = {}
    for match in _EXAMPLE.finditer(page):
        # A comment in an earlier example is no heading.
        before = re.sub(
            r"^```.*?^```", "", page[: match.start()], flags=re.DOTALL | re.MULTILINE
        )
        examples.setdefault(_HEADING.findall(before)[-1], []).append(match[1])
    return examples
