"""Subject of a change (`Where`) and its places in the files of both ICDs (`Places`)."""

from __future__ import annotations

from icdgen.diagnostics import Place
from icdgen.frozen import NamedTuple

Places = tuple[Place | None, Place | None]  # in the old and in the new ICD


class Where(NamedTuple):
    """Subject of a change by the names of the new ICD, otherwise of the old one."""

    node: str = ""
    message: str = ""
    field: str = ""
    enum: str = ""
    member: str = ""
    section: str = ""  # "protocol.link.framing.escape"
    erratum: str = ""

    def __str__(self) -> str:
        owner, part = self.message or self.enum, self.field or self.member
        words = [self.node, *(f"`{name}`" for name in (owner, part) if name)]
        return " ".join(
            [*words, *(word for word in (self.section, self.erratum) if word)]
        )
