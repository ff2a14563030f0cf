"""The golden vectors as one JSON file a node. They are data, so there is no template: see `icdgen.vectors.write`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.icd.model import Icd


class VectorsBackend:
    """``icdgen --lang vectors``"""

    name = "vectors"
    reserved: frozenset[str] = frozenset()

    def files(self, icd: Icd, render: object) -> Iterator[tuple[PurePosixPath, str]]:
        """``<node>.json`` for each node, in their order."""
        from icdgen import vectors

        for node in icd.nodes:
            yield PurePosixPath(f"{node.name}.json"), vectors.text(vectors.make(icd, node))

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None: JSON strings may hold any name."""
        return iter(())
