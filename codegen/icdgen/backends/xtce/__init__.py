"""Backend of XTCE 1.2 (CCSDS 660.1-G): one file per node with all its messages, for
Yamcs and other consumers of the standard.

`sides` collects the content of a direction from `frames` (containers), `places`
(positions of bits) and `types`; the template ``system.xml.j2`` writes it.
"""

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
    """Backend of ``icdgen --lang xtce``."""

    name = "xtce"
    title = "XTCE"
    reserved: frozenset[str] = frozenset()

    def files(self, icd: Icd, render: Renderer) -> Iterator[tuple[PurePosixPath, str]]:
        """Yield ``<node>.xml`` for each node, in order."""
        from icdgen.backends.xtce.sides import direction_content, xml_text

        for node in describe(icd).nodes:
            sides = {
                of: direction_content(icd, node, of) for of in (TELEMETRY, TELECOMMAND)
            }
            document = render(
                "system.xml.j2",
                node=node,
                origin=origin(node.model, with_digest=True),
                text=xml_text,
                **sides,
            )
            yield PurePosixPath(f"{node.name}.xml"), document

    def identifiers(self, icd: Icd) -> Iterator[Identifier]:
        """Return no identifiers: names are made unique when they are assigned, and
        aliases contain the names of the ICD.
        """
        return iter(())
