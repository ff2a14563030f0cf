"""Pages of the rules in ``<theme>.md``, which are read only for `icdgen rule` and the
documentation.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from icdgen.frozen import NamedTuple

FOLDER = Path(__file__).parent

# The headings and labels are the same in all themes, so that a test can run each
# example: the wrong one must have exactly this finding.
_SECTION = re.compile(r"^## ([A-Z]{3}[0-9]{3}): (.+)\n", re.MULTILINE)
_EXAMPLES = re.compile(
    r"(?P<why>.+?)\n\n(?:Wrong|Before):\n\n```yaml\n(?P<wrong>.*?)```\n\n"
    r"(?:Right|After):\n\n```yaml\n(?P<right>.*?)```\n",
    re.DOTALL,
)


class RulePage(NamedTuple):
    """Page of a rule. The examples omit the head of the ICD."""

    title: str
    why: str
    # Violates the rule and no other; for a rule of the diff: the ICD before the change.
    wrong: str
    right: str  # violates no rule; for a rule of the diff: the ICD after the change


@cache
def pages_of_theme(theme: str, folder: Path = FOLDER) -> dict[str, RulePage]:
    """Return the pages of a theme by code.

    Raises `ValueError` if a page does not have the usual form.
    """
    pages = {}
    # The text before the first heading, then code, title and text in turn.
    _, *parts = _SECTION.split((folder / f"{theme}.md").read_text(encoding="utf-8"))
    for code, title, text in zip(parts[0::3], parts[1::3], parts[2::3], strict=True):
        match = _EXAMPLES.match(text.strip("\n") + "\n")
        if match is None:
            raise ValueError(f"{theme}.md: {code} is not laid out like the others")
        pages[code] = RulePage(title, match["why"], match["wrong"], match["right"])
    return pages


def page_as_markdown(
    code: str,
    severity: str,
    page: RulePage,
    labels: tuple[str, str] = ("Wrong", "Right"),
) -> str:
    """Return a page as Markdown."""
    wrong, right = labels
    return (
        f"# {code}: {page.title} ({severity})\n\n{page.why}\n\n"
        f"{wrong}:\n\n```yaml\n{page.wrong}```\n\n{right}:\n\n```yaml\n{page.right}```\n"
    )
