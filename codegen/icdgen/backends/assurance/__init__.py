"""The papers that a review of flight software asks for: trace, errata and assumptions, and what was measured."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends import Identifier
from icdgen.icd.model import Icd

if TYPE_CHECKING:
    from icdgen.render import Renderer


class AssuranceBackend:
    """``icdgen --lang assurance``. ``measured`` is the folder of measurements that go into the pack."""

    name = "assurance"
    reserved: frozenset[str] = frozenset()
    named_in = ("c", "python", "rust")
    needs_lines = True  # of the ICDs: a model that was remembered has none

    def __init__(self) -> None:
        self.measured: Path | None = None

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Every page and table, in a fixed order."""
        from icdgen.backends.assurance import pack

        return pack.files(icd, render, self.measured)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None: what is made of an ICD's names is text."""
        return iter(())
