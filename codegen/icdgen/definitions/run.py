"""A definition as a whole: file in, trees of ICDs and what to say of them out. Nothing is written here."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.definitions import kinds
from icdgen.definitions.model import Definitions, Item, Reader, unreadable
from icdgen.definitions.settle import settle
from icdgen.importer.targets import Target

TOLD = frozenset({"special", "min", "max"})  # what people add to manuals, and definitions say themselves


@dataclass
class Read:
    """A file that was read."""

    definitions: Definitions
    kind: str
    trees: dict[str, Item]
    identifiers: list[str] = field(default_factory=list)  # names that were given one, and which
    targets: list[Target] = field(default_factory=list)

    @property
    def held(self) -> int:
        """Messages of all ICDs."""
        return sum(len(tree.get("messages", ())) for tree in self.trees.values())

    @property
    def failed(self) -> bool:
        """Whether something that the file defines is missing."""
        return any(one.severity == "error" for one in self.definitions.troubles)


def read(path: Path, reader: Reader) -> Read:
    """Reads a file. Raises `Findings` where nothing of it can be held, and `UserError` where a library is missing."""
    found = kinds.read(path, reader)
    made = Read(found, reader.title, {})
    _name_apart(found)
    for network in found.networks:
        if network.messages:
            made.identifiers += settle(network, found)
        if network.messages:
            made.trees[network.name] = network.tree()
    if not made.trees:
        first = next((one.message for one in found.troubles if one.severity == "error"), "")
        raise unreadable(str(path), f"no message can be held{f': {first}' if first else ', for none is defined'}")
    return made


def _name_apart(found: Definitions) -> None:
    """Networks of one name get numbers behind it."""
    taken: Counter[str] = Counter()
    for network in found.networks:
        taken[network.name] += 1
        if taken[network.name] > 1:
            network.name = f"{network.name[:36]}_{taken[network.name]}"
