"""The documentation site: plain pages that work from a folder, without network.

But for search and decoder they do without JavaScript.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen import shipped
from icdgen.backends import Identifier
from icdgen.backends.packages import Packages
from icdgen.icd.model import Icd

if TYPE_CHECKING:
    from icdgen.diff.inputs.side import Side
    from icdgen.render import Renderer

shipped.provide_runtime()  # which makes the bytes that pages show


class HtmlBackend:
    """``icdgen --lang html``. ``previous`` is an older release to compare with, for the page that says what changed."""

    name = "html"
    reserved: frozenset[str] = frozenset()
    named_in = ("c", "python", "rust")

    def __init__(self, previous: Side | None = None) -> None:
        self.previous = previous
        self.packages = Packages()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Every page, and what the pages load."""
        from icdgen.backends.html.site import files

        return files(icd, render, self.packages, self.previous)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None: file names and anchors are made unique as they are given out."""
        return iter(())
