"""The Python testee: modules inside the generated package that answer requests about
it.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.icd.model import Icd
from icdgen.render import Renderer
from tests.conformance.testees import RUNTIME, TEMPLATES


class PythonTesteeBackend:
    """``PACKAGE._testee``, copied into the generated package."""

    name = "python-testee"
    reserved: frozenset[str] = frozenset()
    templates = TEMPLATES / name
    runtime = RUNTIME / name

    def __init__(self, package: str = "icdgen_messages") -> None:
        self.package = package

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Return the modules and the order of the nodes."""
        root = PurePosixPath(self.package)
        for name in render.runtime_files():
            yield root / name, render.source(name)
        nodes = "".join(f'    "{node.name}",\n' for node in icd.nodes)
        yield (
            root / "_testee_order.py",
            f'"""Nodes, after those that they include."""\n\nORDER = [\n{nodes}]\n',
        )

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers, because names of nodes do not start with `_`."""
        return iter(())
