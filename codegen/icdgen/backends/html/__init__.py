"""Backend of the documentation site: static pages that work from a folder without
network.

Only search and decoder need JavaScript.
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
    from icdgen.diff.inputs.side import ComparisonSide
    from icdgen.render import Renderer

shipped.provide_runtime()  # computes the transmitted bytes that pages show


class HtmlBackend:
    """Backend of ``icdgen --lang html``.

    ``previous``: older release to compare with, for the page of changes.
    """

    name = "html"
    title = "the documentation site"
    reserved: frozenset[str] = frozenset()
    # Pages contain names of these languages, so loading computes them.
    named_in = ("c", "python", "rust")

    def __init__(self, previous: ComparisonSide | None = None) -> None:
        self.previous = previous
        self.packages = Packages()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Yield each page, and the files that pages load."""
        # Imported late: other commands do not need the pages.
        from icdgen.backends.html.site import files

        return files(icd, render, self.packages, self.previous)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers: file names and anchors become unique on
        assignment.
        """
        return iter(())
