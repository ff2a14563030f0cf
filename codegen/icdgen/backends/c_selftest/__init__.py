"""Backend of the C self-test: golden vectors as tables for target boards.

It includes the headers of the ``c`` backend and uses their names.
"""

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
    """Backend of ``icdgen --lang c-selftest``: golden vectors as C source that needs no
    file system, heap or output.
    """

    name = "c-selftest"
    title = "the self-test in C"
    reserved: frozenset[str] = frozenset()
    named_in = ("c",)

    def __init__(self) -> None:
        self.packages = Packages()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Yield the engine, the list of nodes, and one file of vectors per node."""
        from icdgen.backends.c.short_names import with_short_names
        from icdgen.backends.c.symbols import C_NAMES
        from icdgen.backends.c_selftest import rows
        from icdgen.describe import describe
        from icdgen.describe.symbols import symbols

        # The names must match those of the generated C package.
        prefixed = with_prefix(icd, self.packages.c_prefix)
        return with_short_names(
            rows.files(prefixed, render), symbols(describe(prefixed), C_NAMES)
        )

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers: all names derive from names of the ``c`` backend."""
        return iter(())
