"""What a change is about, and where that stands."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.diagnostics import Place

Places = tuple[Place | None, Place | None]  # in the old ICD and in the new one


class Where(NamedTuple):
    """What a change is about, by the names that the new ICD has for it, else the old."""

    node: str = ""
    message: str = ""
    field: str = ""
    enum: str = ""
    member: str = ""
    section: str = ""  # "protocol.uart.framing.escape"
    erratum: str = ""

    def __str__(self) -> str:
        owner, part = self.message or self.enum, self.field or self.member
        words = [self.node, *(f"`{name}`" for name in (owner, part) if name)]
        return " ".join([*words, *(word for word in (self.section, self.erratum) if word)])
