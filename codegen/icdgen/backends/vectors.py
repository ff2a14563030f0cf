"""Backend of the golden vectors: one JSON file per node and one for the protocol.

The files are data without templates; see `icdgen.vectors`.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from icdgen.backends import Identifier
from icdgen.icd.model import Icd

FILE = "protocol"  # name of the vector file of the protocol, without extension


class VectorsBackend:
    """Backend of ``icdgen --lang vectors``."""

    name = "vectors"
    title = "the golden vectors"
    reserved: frozenset[str] = frozenset()

    def files(self, icd: Icd, render: object) -> Iterator[tuple[PurePosixPath, str]]:
        """Yield ``<node>.json`` for each node in order, and ``protocol.json`` if a node
        has a protocol.
        """
        from icdgen.vectors import protocol
        from icdgen.vectors.make import make_vectors
        from icdgen.vectors.write import vector_file_text

        for node in icd.nodes:
            yield (
                PurePosixPath(f"{node.name}.json"),
                vector_file_text(make_vectors(icd, node)),
            )
        protocol_text = protocol.protocol_vectors_text(icd)
        if protocol_text:
            yield PurePosixPath(f"{FILE}.json"), protocol_text

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Yield the file names.

        JSON strings can contain any name, so only file names can conflict.
        """
        if any(icd.protocol_of(node) for node in icd.nodes):
            yield Identifier(
                "the files of the vectors", FILE, "vectors of the protocol", None
            )
        for node in icd.nodes:
            yield Identifier(
                "the files of the vectors",
                node.name,
                f"node `{node.name}`",
                node.source,
            )
