"""The features of the format in docs/reference/features/rows.yaml, and the ICDs on
which they are tried.
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
    """A feature of the format.

    ``uses``: for each list of an ICD (such as ``fields``), the keys and values, as
    regular expressions, of an entry that uses the feature. ``alike``: keys for which
    another entry of the list must have the same values. ``change`` and ``wrong``: pairs
    of a text of the example and its replacement. ``without``: outputs that lack the
    feature, with reasons.
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
        """The complete ICD by which the documents show the feature."""
        matches = [text for text in examples()[self.section] if self.change[0] in text]
        if not matches:
            raise ValueError(
                f"no example under `{self.section}` has `{self.change[0]}`, the change of `{self.name}`"
            )
        return matches[0]

    def changed(self) -> str:
        """Return the example with the feature used differently."""
        return self._replaced("change")

    def with_error(self) -> str:
        """Return the example with the feature used wrongly."""
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
        """Return the values at the keys of the feature in an ICD, in the order of the
        file.
        """
        return list(_places(tree, self.uses, self.alike))


def features() -> list[Feature]:
    """Return the features in the order of the page."""
    data: dict[str, Any] = yaml.safe_load(ROWS.read_text("utf-8"))
    return [_feature(data["reasons"], **row) for row in data["features"]]


def unmeasured() -> list[str]:
    """Return headings whose examples are not measured yet."""
    headings: list[str] = yaml.safe_load(ROWS.read_text("utf-8"))["unmeasured"]
    return headings


def _feature(
    reasons: dict[str, str],
    change: list[str],
    wrong: list[str],
    without: dict[str, str] | None = None,
    alike: tuple[str, ...] = (),
    **row: Any,
) -> Feature:
    reasons_by_output = {
        output: reasons[key] for output, key in (without or {}).items()
    }
    return Feature(
        change=tuple(change),
        wrong=tuple(wrong),
        without=reasons_by_output,
        alike=tuple(alike),
        **row,
    )


def examples() -> dict[str, list[str]]:
    """Return the complete ICDs of the documents, by the heading above each."""
    by_heading: dict[str, list[str]] = {}
    for page in _pages():
        for heading, texts in documents.icds_by_heading(
            page.read_text("utf-8")
        ).items():
            by_heading.setdefault(heading, []).extend(texts)
    return by_heading


def _pages() -> list[Path]:
    """Return the pages whose examples show features.

    ``tests/protocol`` runs the examples of complete links.
    """
    return [page for page in documents.pages() if page.stem != "example-links"]


def page_of(section: str) -> str:
    """Return the page with the example of a section, relative to ``docs/reference``."""
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
            entries = value if isinstance(value, list) else [value]
            for entry in entries:
                if isinstance(entry, dict) and key in uses:
                    values = _matching_values(entry, uses[key])
                    if values and _has_counterpart(entry, entries, alike):
                        yield values
                yield from _places(entry, uses, alike)
    elif isinstance(tree, list):
        for entry in tree:
            yield from _places(entry, uses, alike)


def _has_counterpart(
    entry: dict[str, object], entries: list[Any], keys: tuple[str, ...]
) -> bool:
    """Return whether another entry has the same values of ``keys``, or there are no
    keys.
    """
    return not keys or any(
        other is not entry and all(other.get(key) == entry.get(key) for key in keys)
        for other in entries
    )


def _matching_values(
    entry: dict[str, object], patterns: dict[str, str]
) -> list[object]:
    """Return the values of the keys; an empty list if one is absent or does not match."""
    values: list[object] = []
    for key, pattern in patterns.items():
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
