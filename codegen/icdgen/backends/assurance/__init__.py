"""Verification package for reviews of flight software: traceability, errata,
assumptions and measurements.

`pack` lists the files. The traceability changes each number of the ICD by itself
(`changes`), looks for golden vectors that detect it (`detection`, `shared_ids`), and
reports the result per line of the ICD (`trace`, `tracing`).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends import Identifier
from icdgen.icd.model import Icd

if TYPE_CHECKING:
    from icdgen.render import Renderer


class AssuranceBackend:
    """Backend of ``icdgen --lang assurance``.

    ``measured``: folder of measurements to include.
    """

    name = "assurance"
    title = "the verification package"
    reserved: frozenset[str] = frozenset()
    named_in = ("c", "python", "rust")
    needs_lines = True  # line numbers of the ICDs, which a cached model lacks

    def __init__(self) -> None:
        self.measured: Path | None = None

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Yield each page and table, in a fixed order."""
        # Imported late: other commands do not need it.
        from icdgen.backends.assurance import pack

        return pack.files(icd, render, self.measured)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers: the package contains text only."""
        return iter(())
