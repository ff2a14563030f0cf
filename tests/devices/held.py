"""Which definitions the format holds: an ICD is written, and what `icdgen check`
refuses goes, with the code that did it.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from icdgen.diagnostics import Finding
from icdgen.icd.fmt import emit
from icdgen.icd.model import Icd
from icdgen.loading import load
from tests.devices.definition import Definition, Definitions

ROUNDS = 20  # a rule may speak only after another is satisfied
NAMES = {
    "ICD054",
    "ICD070",
    "ICD071",
    "ICD072",
}  # a name that cannot be an identifier, or not beside another


@dataclass
class Held:
    """One node: its ICD, what stands in it and why the rest does not."""

    definitions: Definitions
    icd: Icd | None
    messages: list[Definition]
    causes: dict[str, str] = field(default_factory=dict)


def held(definitions: Definitions, folder: Path) -> Held:
    """Writes the node into ``folder`` and takes out what is refused, until nothing is."""
    causes = {one.name: one.cause for one in definitions.messages if one.cause}
    left = [one for one in definitions.messages if not one.cause and not one.unread]
    file = folder / f"{definitions.name}.yaml"
    if definitions.tree is not None:
        return _imported(definitions, definitions.tree, file, left, causes)
    for _ in range(ROUNDS):
        if not left:
            break
        owners = _write(file, definitions.node, left)
        loaded = load([file])
        errors = [finding for finding in loaded.findings if finding.severity == "error"]
        if not errors:
            return Held(definitions, loaded.icd, left, causes)
        for finding in errors:
            owner = owners.get(finding.place.line)
            if owner is None:
                raise ValueError(str(finding))
            if finding.code not in NAMES or not _renamed(owner, _quoted(file, finding)):
                causes.setdefault(owner.name, finding.code)
        left = [one for one in left if one.name not in causes]
    file.unlink(missing_ok=True)
    return Held(definitions, None, [], causes)


def _imported(
    definitions: Definitions,
    tree: dict,
    file: Path,
    left: list[Definition],
    causes: dict[str, str],
) -> Held:
    """A node that `icdgen import` made: all that stands in it is held, and as `icdgen
    fmt` has it.
    """
    names, tree = {one.name for one in left}, dict(tree)
    tree["messages"] = [one for one in tree["messages"] if one["name"] in names]
    if link := tree.get("protocol", {}).get("link", {}):
        checksums = {
            name: {
                **one,
                "seeds": {
                    owner: seed
                    for owner, seed in one["seeds"].items()
                    if owner in names
                },
            }
            for name, one in link.get("checksums", {}).items()
        }
        if checksums:
            tree["protocol"] = {
                **tree["protocol"],
                "link": {**link, "checksums": checksums},
            }
    file.write_text(emit.canonical_yaml(tree), encoding="utf-8")
    loaded = load([file])
    if not loaded.ok:
        raise ValueError(f"{file}: {loaded.findings}")
    return Held(definitions, loaded.icd, left, causes)


def _quoted(file: Path, finding: Finding) -> str:
    """The name that a finding points at."""
    assert (
        finding.place is not None
        and finding.place.line is not None
        and finding.place.column is not None
    )
    line = file.read_text(encoding="utf-8").split("\n")[finding.place.line - 1]
    try:
        return str(json.JSONDecoder().raw_decode(line[finding.place.column - 1 :])[0])
    except ValueError:
        return ""


def _renamed(owner: Definition, name: str) -> bool:
    """Gives a field, member or message an identifier of its own; whether that is new."""
    members = [member for enum in owner.enums for member in enum["members"]]
    fields = [
        *owner.fields,
        *(field for struct in owner.structs for field in struct["fields"]),
    ]
    for one, number in (
        *((f, f["at"]) for f in fields),
        *((struct, owner.id) for struct in owner.structs),
        *((m, m["value"]) for m in members),
        (owner.more, owner.id),
    ):
        if one.get("name", owner.name) == name and "identifier" not in one:
            plain = (
                name
                if re.match(r"[^A-Za-z0-9]*[A-Za-z]", name) and name.isascii()
                else f"item {name}"
            )
            one["identifier"] = (
                f"{plain if plain.isascii() else 'item'} {number}".replace(
                    "-", "minus "
                )
            )
            return True
    return False


def _write(file: Path, node: dict, messages: list[Definition]) -> dict[int, Definition]:
    """One line for each enumeration, struct and message; whose line is whose."""
    lines, owners = ['{"icdgen": 1, "node": ' + json.dumps(node) + ', "enums": ['], {}
    enums = [(json.dumps(enum), one) for one in messages for enum in one.enums]
    structs = [(json.dumps(struct), one) for one in messages for struct in one.structs]
    times = Counter((one.kind, one.id) for one in messages)
    shared = {
        key: {"shares_id": True} if number > 1 else {} for key, number in times.items()
    }
    trees = [
        (json.dumps(one.tree() | shared[one.kind, one.id]), one) for one in messages
    ]
    for group, after in (
        (enums, '], "structs": ['),
        (structs, '], "messages": ['),
        (trees, "]}"),
    ):
        for number, (text, one) in enumerate(group):
            lines.append(text + ("," if number + 1 < len(group) else ""))
            owners[len(lines)] = one
        lines.append(after)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return owners
