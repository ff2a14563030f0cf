"""The words of the rules: ``<theme>.md`` beside ``<theme>.py``, read only when somebody asks."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

FOLDER = Path(__file__).parent

_SECTION = re.compile(r"^## ([A-Z]{3}[0-9]{3}): (.+)\n", re.MULTILINE)
_EXAMPLES = re.compile(
    r"(?P<why>.+?)\n\n(?:Wrong|Before):\n\n```yaml\n(?P<wrong>.*?)```\n\n"
    r"(?:Right|After):\n\n```yaml\n(?P<right>.*?)```\n",
    re.DOTALL,
)


class Page(NamedTuple):
    """``wrong`` breaks the rule and no other, ``right`` none; both leave out the head of the file.

    For a rule of the diff they are the ICD before and after the change.
    """

    title: str
    why: str
    wrong: str
    right: str


@cache
def of(theme: str, folder: Path = FOLDER) -> dict[str, Page]:
    """The pages of a theme by code. Raises `ValueError` where one does not have the usual form."""
    pages = {}
    _, *parts = _SECTION.split((folder / f"{theme}.md").read_text(encoding="utf-8"))
    for code, title, text in zip(parts[0::3], parts[1::3], parts[2::3], strict=True):
        match = _EXAMPLES.match(text.strip("\n") + "\n")
        if match is None:
            raise ValueError(f"{theme}.md: {code} is not laid out like the others")
        pages[code] = Page(title, match["why"], match["wrong"], match["right"])
    return pages


def text(code: str, severity: str, page: Page, labels: tuple[str, str] = ("Wrong", "Right")) -> str:
    """A page as Markdown, for people."""
    wrong, right = labels
    return (
        f"# {code}: {page.title} ({severity})\n\n{page.why}\n\n"
        f"{wrong}:\n\n```yaml\n{page.wrong}```\n\n{right}:\n\n```yaml\n{page.right}```\n"
    )
