"""The C self-test: the golden vectors as tables, for boards. It includes the headers of ``c`` and takes all names from its plan."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends import Identifier
from icdgen.backends.packages import Packages
from icdgen.icd.model import Icd
from icdgen.icd.prefixed import with_prefix

if TYPE_CHECKING:
    from icdgen.render import Renderer


class CSelftestBackend:
    """``icdgen --lang c-selftest``: the golden vectors as C source; needs no file system, no heap and no output."""

    name = "c-selftest"
    reserved: frozenset[str] = frozenset()
    named_in = ("c",)

    def __init__(self) -> None:
        self.packages = Packages()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """The engine, the list of nodes, and one file of vectors a node."""
        from icdgen.backends.c.declared_names import declared_names
        from icdgen.backends.c.short_names import with_short_names
        from icdgen.backends.c_selftest import rows
        from icdgen.describe import describe

        prefixed = with_prefix(icd, self.packages.c_prefix)
        return with_short_names(rows.files(prefixed, render), lambda: declared_names(describe(prefixed)))

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None of its own: all are made from those of the ``c`` backend."""
        return iter(())
