"""Everything that was read of one node, before it becomes an ICD."""

from __future__ import annotations

from dataclasses import dataclass, field

from icdgen.importer.profile import NodeWords
from icdgen.importer.understand.model import Listed, ReadEnum, ReadList, ReadLog, ReadMessage


@dataclass
class NodeParts:
    """What belongs to one node."""

    name: str
    title: str
    shared: bool = False
    words: NodeWords | None = None
    messages: list[ReadMessage] = field(default_factory=list)
    enums: list[ReadEnum] = field(default_factory=list)
    lists: list[ReadList] = field(default_factory=list)
    logs: list[ReadLog] = field(default_factory=list)
    include: list[str] = field(default_factory=list)
    missing: list[Listed] = field(default_factory=list)
