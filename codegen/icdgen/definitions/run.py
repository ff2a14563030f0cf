"""Import of definitions from files to trees of ICDs with findings.

Files with their readers go in. A `ReadDefinitions` for each file or set of files comes
out, with content that `icdgen check` accepts. No file is written; that is the task of
`commands/import_.py`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.definitions import kinds
from icdgen.definitions.model import (
    DefinitionReader,
    Definitions,
    Item,
    Network,
    unreadable,
)
from icdgen.definitions.settle import settle

# Keys that manuals usually lack, and definitions contain.
TOLD = frozenset({"special", "min", "max", "shares_id"})


@dataclass
class ReadDefinitions:
    """Result of reading a file."""

    definitions: Definitions
    kind: str
    trees: dict[str, Item]
    # Names with their generated identifiers, as text.
    identifiers: list[str] = field(default_factory=list)

    @property
    def imported(self) -> int:
        """Number of messages in all ICDs."""
        return sum(len(tree.get("messages", ())) for tree in self.trees.values())

    @property
    def failed(self) -> bool:
        """Return whether a part of the definition is missing in the ICDs."""
        return any(
            finding.severity == "error" for finding in self.definitions.import_findings
        )


def read(path: Path, reader: DefinitionReader) -> ReadDefinitions:
    """Read a file.

    Raises `Findings` if no message can be imported, and `UserError` if a library is
    missing.
    """
    definitions = kinds.read(path, reader)
    result = _settled_result(definitions, reader)
    if not result.trees:
        first = next(
            (
                finding
                for finding in definitions.import_findings
                if finding.severity == "error"
            ),
            None,
        )
        why = ", for none is defined" if first is None else f": {first.message}"
        raise unreadable(
            str(path),
            f"no message can be imported{why}",
            "" if first is None else first.help,
        )
    return result


def read_set(files: Sequence[tuple[Path, DefinitionReader]]) -> list[ReadDefinitions]:
    """Read files, all files of a kind together because they may refer to each other.

    The names of all ICDs are unique.

    Raises `UserError` if a library is missing.
    """
    by_kind: dict[str, tuple[DefinitionReader, list[Path]]] = {}
    for path, reader in files:
        by_kind.setdefault(reader.name, (reader, []))[1].append(path)
    results = [
        (definitions, reader)
        for reader, paths in by_kind.values()
        for definitions in kinds.read_set(paths, reader)
    ]
    _make_names_unique(
        network
        for definitions, _ in results
        for network in definitions.networks
        if network.messages
    )
    return [_settled_result(definitions, reader) for definitions, reader in results]


def _settled_result(
    definitions: Definitions, reader: DefinitionReader
) -> ReadDefinitions:
    """Return the result with ICDs that pass `icdgen check`."""
    result = ReadDefinitions(definitions, reader.title, {})
    _make_names_unique(definitions.networks)
    for network in definitions.networks:
        if network.messages:
            result.identifiers += settle(network, definitions)
        if network.messages:
            result.trees[network.name] = network.tree()
    return result


def _make_names_unique(networks: Iterable[Network]) -> None:
    """Add a number to duplicate network names.

    A name with a number is never that of another network.
    """
    listed = list(networks)
    reserved, taken = {network.name for network in listed}, set[str]()
    for network in listed:
        name, number = network.name, 1
        while network.name in taken:
            number += 1
            numbered = f"{name[:36]}_{number}"
            if numbered not in reserved:
                network.name = numbered
        taken.add(network.name)
