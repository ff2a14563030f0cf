"""The golden vectors: one JSON file a node and one for the protocol. Data, so without a template: see `icdgen.vectors`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.icd.model import Icd

FILE = "protocol"  # the file of the protocol's vectors, without its ending


class VectorsBackend:
    """``icdgen --lang vectors``"""

    name = "vectors"
    reserved: frozenset[str] = frozenset()

    def files(self, icd: Icd, render: object) -> Iterator[tuple[PurePosixPath, str]]:
        """``<node>.json`` for each node, in their order, and ``protocol.json`` if a node has a protocol."""
        from icdgen.vectors import protocol
        from icdgen.vectors.make import make
        from icdgen.vectors.write import text

        for node in icd.nodes:
            yield PurePosixPath(f"{node.name}.json"), text(make(icd, node))
        asked = protocol.text(icd)
        if asked:
            yield PurePosixPath(f"{FILE}.json"), asked

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Only those of the files: JSON strings may hold any name."""
        if any(icd.protocol_of(node) for node in icd.nodes):
            yield Identifier("the files of the vectors", FILE, "vectors of the protocol", None)
        for node in icd.nodes:
            yield Identifier("the files of the vectors", node.name, f"node `{node.name}`", node.source)
