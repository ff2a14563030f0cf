"""Golden vectors, made by the reference codec alone: what every language's code is held to.

`make` builds them, `text` lays them out; their form is described by ``vectors.schema.json`` beside this package.
"""

from __future__ import annotations

from icdgen.vectors.make import FORMAT, MessageVectors, NodeVectors, Row, make
from icdgen.vectors.write import text

__all__ = ["FORMAT", "MessageVectors", "NodeVectors", "Row", "make", "text"]
