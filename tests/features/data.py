"""The features of the format, as docs/reference/features/rows.yaml has them, and the
ICDs on which they are tried.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from tests import documents

ROWS = documents.DOCS / "reference" / "features" / "rows.yaml"


@dataclass(frozen=True)
class Feature:
    """``uses``: by the list in which it stands, the keys and values (regular
    expressions) of what has the feature.

    ``alike``: keys of which another entry of the list must have the same values.
    ``change`` and ``wrong``: by turns what is replaced in the example, and by what;
    ``without``: by output, why it has it not.
    """

    name: str
    section: str
    uses: dict[str, dict[str, str]]
    change: tuple[str, ...]
    wrong: tuple[str, ...]
    without: dict[str, str] = field(default_factory=dict)
    alike: tuple[str, ...] = ()

    @property
    def example(self) -> str:
        """The whole ICD that the documents show of it."""
        found = [text for text in examples()[self.section] if self.change[0] in text]
        if not found:
            raise ValueError(
                f"no example under `{self.section}` has `{self.change[0]}`, the change of `{self.name}`"
            )
        return found[0]

    def changed(self) -> str:
        """The example with the feature said otherwise."""
        return self._replaced("change")

    def spoilt(self) -> str:
        """The example with the feature said wrongly."""
        return self._replaced("wrong")

    def _replaced(self, key: str) -> str:
        text, words = self.example, getattr(self, key)
        for old, new in zip(words[::2], words[1::2], strict=True):
            if text.count(old) != 1:
                raise ValueError(
                    f"`{old}`, the `{key}` of `{self.name}`, is {text.count(old)} times in its example"
                )
            text = text.replace(old, new)
        return text

    def places(self, tree: object) -> list[object]:
        """What a tree of an ICD says of the feature: the values at the keys, in order."""
        return list(_places(tree, self.uses, self.alike))


def features() -> list[Feature]:
    """In the order of the page."""
    data: dict[str, Any] = yaml.safe_load(ROWS.read_text("utf-8"))
    return [_feature(data["reasons"], **row) for row in data["features"]]


def unmeasured() -> list[str]:
    """Headings whose examples no line measures yet."""
    found: list[str] = yaml.safe_load(ROWS.read_text("utf-8"))["unmeasured"]
    return found


def _feature(
    reasons: dict[str, str],
    change: list[str],
    wrong: list[str],
    without: dict[str, str] | None = None,
    alike: tuple[str, ...] = (),
    **row: Any,
) -> Feature:
    why = {output: reasons[key] for output, key in (without or {}).items()}
    return Feature(
        change=tuple(change), wrong=tuple(wrong), without=why, alike=tuple(alike), **row
    )


def examples() -> dict[str, list[str]]:
    """Complete ICDs of the documents, by the heading above each."""
    by_heading: dict[str, list[str]] = {}
    for page in _pages():
        for heading, texts in documents.icds_by_heading(
            page.read_text("utf-8")
        ).items():
            by_heading.setdefault(heading, []).extend(texts)
    return by_heading


def _pages() -> list[Path]:
    """Pages whose examples show features; ``tests/protocol`` runs the examples of
    complete links.
    """
    return [page for page in documents.pages() if page.stem != "example-links"]


def page_of(section: str) -> str:
    """Page that shows the example of a section, relative to ``docs/reference``."""
    (page,) = (
        page
        for page in _pages()
        if section in documents.icds_by_heading(page.read_text("utf-8"))
    )
    return Path(os.path.relpath(page, ROWS.parent.parent)).as_posix()


def _places(
    tree: object, uses: dict[str, dict[str, str]], alike: tuple[str, ...]
) -> Iterator[object]:
    if isinstance(tree, dict):
        for key, value in tree.items():
            among = value if isinstance(value, list) else [value]
            for one in among:
                if (
                    isinstance(one, dict)
                    and key in uses
                    and (has := _having(one, uses[key]))
                    and _alike(one, among, alike)
                ):
                    yield has
                yield from _places(one, uses, alike)
    elif isinstance(tree, list):
        for one in tree:
            yield from _places(one, uses, alike)


def _alike(entry: dict[str, object], among: list[Any], keys: tuple[str, ...]) -> bool:
    """Whether another entry has the same values of the keys, if there are any."""
    return not keys or any(
        one is not entry and all(one.get(key) == entry.get(key) for key in keys)
        for one in among
    )


def _having(entry: dict[str, object], wanted: dict[str, str]) -> list[object]:
    """The values of the keys, if every one of them is there and as wanted."""
    values: list[object] = []
    for key, pattern in wanted.items():
        hits = [
            entry[k]
            for k in entry
            if re.fullmatch(key, str(k))
            and re.fullmatch(pattern, str(entry[k]), re.DOTALL)
        ]
        if not hits:
            return []
        values += hits
    return values
