"""Pages that explain the findings of an import (IMP codes), from ``findings.md``.

`icdgen rule CODE` prints them, and the reference of rules has them all.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from icdgen.frozen import NamedTuple

_PAGE = Path(__file__).with_name("findings.md")
_SECTION = re.compile(
    r"^## (IMP[0-9]{3}): (.+) \((error|warning|note)\)\n", re.MULTILINE
)


class ImportFindingPage(NamedTuple):
    """Explanation of a finding.

    ``text`` is the reason, and below it an example as an indented block, in Markdown.
    """

    title: str
    severity: str
    text: str


@cache
def pages() -> dict[str, ImportFindingPage]:
    """Return the pages by code, in ascending order."""
    _, *parts = _SECTION.split(_PAGE.read_text(encoding="utf-8"))
    sections = zip(parts[0::4], parts[1::4], parts[2::4], parts[3::4], strict=True)
    return {
        code: ImportFindingPage(title, severity, text.strip("\n"))
        for code, title, severity, text in sections
    }


def explain(code: str) -> str:
    """Return the page of a finding in Markdown. Raise `KeyError`."""
    page = pages()[code]
    return f"# {code}: {page.title} ({page.severity})\n\n{page.text}\n"
