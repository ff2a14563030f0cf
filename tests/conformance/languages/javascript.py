"""JavaScript: the codec of the documentation site, under Node."""

from __future__ import annotations

from pathlib import Path

from tests.conformance.languages import Language


def build(source: Path, out: Path) -> list[str]:
    """Nothing is built: Node runs the source."""
    return ["node", str(source / "js-testee" / "testee.js")]


LANGUAGES = [Language("javascript", ("js-testee",), ("node",), build)]
