"""Programs that hold the generated C to the golden vectors: the testee of the conformance run, and the self-test for boards.

Both include the headers that the ``c`` backend generates, and take all names from its plan.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.icd.model import Icd
from icdgen.render import Renderer


class CTesteeBackend:
    """``icdgen --lang c-testee``: answers requests, one line of JSON each."""

    name = "c-testee"
    reserved: frozenset[str] = frozenset()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Files that are the same for every ICD, the list of nodes, and one file a node."""
        from icdgen.backends.c_conformance import testee

        return testee.files(icd, render)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None of its own: all are made from those of the ``c`` backend."""
        return iter(())


class CSelftestBackend:
    """``icdgen --lang c-selftest``: the golden vectors as C source; needs no file system, no heap and no output."""

    name = "c-selftest"
    reserved: frozenset[str] = frozenset()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """The engine, the list of nodes, and one file of vectors a node."""
        from icdgen.backends.c_conformance import selftest

        return selftest.files(icd, render)

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None of its own: all are made from those of the ``c`` backend."""
        return iter(())
