"""A definition as a whole: file in, trees of ICDs and what to say of them out. Nothing is written here."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.definitions import kinds
from icdgen.definitions.model import Definitions, Item, Network, Reader, unreadable
from icdgen.definitions.settle import settle

TOLD = frozenset({"special", "min", "max", "shares_id"})  # what people add to manuals, and definitions say themselves


@dataclass
class Read:
    """A file that was read."""

    definitions: Definitions
    kind: str
    trees: dict[str, Item]
    identifiers: list[str] = field(default_factory=list)  # names that were given one, and which

    @property
    def held(self) -> int:
        """Messages of all ICDs."""
        return sum(len(tree.get("messages", ())) for tree in self.trees.values())

    @property
    def failed(self) -> bool:
        """Whether something that the file defines is missing."""
        return any(finding.severity == "error" for finding in self.definitions.troubles)


def read(path: Path, reader: Reader) -> Read:
    """Reads a file. Raises `Findings` where nothing of it can be imported, and `UserError` where a library is missing."""
    found = kinds.read(path, reader)
    made = _settled(found, reader)
    if not made.trees:
        first = next((finding for finding in found.troubles if finding.severity == "error"), None)
        why = ", for none is defined" if first is None else f": {first.message}"
        raise unreadable(str(path), f"no message can be imported{why}", "" if first is None else first.help)
    return made


def read_set(files: Sequence[tuple[Path, Reader]]) -> list[Read]:
    """Reads files, those of a kind together: what one refers to may be in another. ICDs of all have names of their own.

    Raises `UserError` where a library is missing.
    """
    by_kind: dict[str, tuple[Reader, list[Path]]] = {}
    for path, reader in files:
        by_kind.setdefault(reader.name, (reader, []))[1].append(path)
    found = [(one, reader) for reader, paths in by_kind.values() for one in kinds.read_set(paths, reader)]
    _name_apart(network for one, _ in found for network in one.networks if network.messages)
    return [_settled(one, reader) for one, reader in found]


def _settled(found: Definitions, reader: Reader) -> Read:
    """What was read, as `icdgen check` takes it."""
    made = Read(found, reader.title, {})
    _name_apart(found.networks)
    for network in found.networks:
        if network.messages:
            made.identifiers += settle(network, found)
        if network.messages:
            made.trees[network.name] = network.tree()
    return made


def _name_apart(networks: Iterable[Network]) -> None:
    """Networks of one name get numbers behind it."""
    taken: Counter[str] = Counter()
    for network in networks:
        taken[network.name] += 1
        if taken[network.name] > 1:
            network.name = f"{network.name[:36]}_{taken[network.name]}"
