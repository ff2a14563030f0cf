"""Combines mutants into batches of small ICDs that are loaded, checked and built
together.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.icd.model import Icd, Node
from icdgen.loading import load
from tests.mutation.mutants import Mutant

MOST_MUTANTS = 400
MOST_FIELDS = 6000

# Errors in spite of which code can be generated: an overlap, and bytes at the end without a
# field. The vectors are tried on this code, although no user would get it.
TOLERATED = frozenset({"ICD021", "ICD024"})


@dataclass
class Batch:
    """A batch: its mutants and the rejected ones, by the name of their node, and the
    ICD of the mutants from which code can be generated.
    """

    mutants: dict[str, Mutant]
    refused: dict[str, list[str]] = field(default_factory=dict)  # name -> codes
    icd: Icd = field(default_factory=lambda: Icd(()))

    def node(self, name: str) -> Node:
        return self.icd.node(name)


def split(mutants: Iterable[Mutant]) -> Iterator[list[Mutant]]:
    """Yield batches of about equal work."""
    batch: list[Mutant] = []
    fields = 0
    for mutant in mutants:
        size = 1 + sum(
            _size(message, mutant.tree) for message in mutant.tree.get("messages") or ()
        )
        if batch and (fields + size > MOST_FIELDS or len(batch) >= MOST_MUTANTS):
            yield batch
            batch, fields = [], 0
        batch.append(mutant)
        fields += size
    if batch:
        yield batch


def _size(owner: dict, tree: dict) -> int:
    """Return the number of fields of a message or a struct.

    Each element of an array and each field of a struct counts.
    """
    structs = {entry["name"]: entry for entry in tree.get("structs") or ()}
    size = 0
    for row in owner.get("fields") or ():
        count = row.get("count", 1)
        struct = structs.get(row.get("struct"))
        times = count if isinstance(count, int) else row.get("up_to", 1)
        size += times * (
            _size(struct, tree) if struct is not None and struct is not owner else 1
        )
    return size


def prepare(
    mutants: list[Mutant], folder: Path, accepted: dict[tuple, set[str]] | None = None
) -> Batch:
    """Write the ICDs to an empty folder and load them.

    ``accepted``: codes of errors that the unchanged message has, too.
    """
    batch = Batch({f"m{number:05}": mutant for number, mutant in enumerate(mutants)})
    for name, mutant in batch.mutants.items():
        tree = {**mutant.tree, "node": {"name": name, **mutant.tree["node"]}}
        (folder / f"{name}.yaml").write_text(
            json.dumps(tree, ensure_ascii=False, indent=1), encoding="utf-8"
        )
    loaded = load([folder])
    for finding in loaded.findings:
        name = Path(finding.place.file).stem
        if finding.severity == "error" and finding.code not in (accepted or {}).get(
            key(batch.mutants[name]), ()
        ):
            batch.refused.setdefault(name, []).append(finding.code)
    built = {node.name for node in loaded.icd.nodes}
    for name in batch.mutants:
        if name not in built:
            batch.refused.setdefault(name, ["unreadable"])
    batch.icd = Icd(
        tuple(
            node
            for node in loaded.icd.nodes
            if TOLERATED.issuperset(batch.refused.get(node.name, ()))
        )
    )
    return batch


def key(mutant: Mutant) -> tuple:
    """Return the node, message or enumeration that the mutant changes."""
    return mutant.node, mutant.message, mutant.enum


def baseline(unchanged: list[Mutant], folder: Path) -> dict[tuple, set[str]]:
    """Return the codes of the errors that the small ICDs have without any change.

    There are some, because a message that is cut out of its node loses its errata.
    """
    batch = prepare(unchanged, folder)
    return {
        key(batch.mutants[name]): set(codes) for name, codes in batch.refused.items()
    }
