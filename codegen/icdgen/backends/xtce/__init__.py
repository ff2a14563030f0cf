"""XTCE 1.2 (CCSDS 660.1): one file a node, with all that it speaks, for Yamcs and whatever reads the standard."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from icdgen.backends import Identifier
from icdgen.backends.origin import origin
from icdgen.describe import describe
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Icd

if TYPE_CHECKING:
    from icdgen.render import Renderer


class XtceBackend:
    """``icdgen --lang xtce``"""

    name = "xtce"
    reserved: frozenset[str] = frozenset()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """``<node>.xml`` for each node, in their order."""
        from icdgen.backends.xtce.sides import side, text

        for node in describe(icd).nodes:
            sides = {of: side(icd, node, of) for of in (TELEMETRY, TELECOMMAND)}
            made = render("system.xml.j2", node=node, origin=origin(node.model, with_digest=True), text=text, **sides)
            yield PurePosixPath(f"{node.name}.xml"), made

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """None: names are made unique as they are given out, and the ICD's own stand beside them."""
        return iter(())
