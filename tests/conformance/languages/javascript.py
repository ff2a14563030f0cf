"""JavaScript: the codec of the documentation site, under Node."""

from __future__ import annotations

from pathlib import Path

from tests.conformance.languages import Language


def build(source: Path, out: Path) -> list[str]:
    """Return the command line. Node runs the source without a build."""
    return ["node", str(source / "js-testee" / "testee.js")]


LANGUAGES = [Language("javascript", ("js-testee",), ("node",), build)]
