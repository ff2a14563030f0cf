"""The part of a library's definitions that icdgen supports.

The messages are written as an ICD. Messages for which `icdgen check` reports errors are
removed, and the code of the rule is recorded as the cause.
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

ROUNDS = 20  # some rules report only after the errors of others are corrected
NAMES = {
    "ICD054",
    "ICD070",
    "ICD071",
    "ICD072",
}  # a name that cannot be an identifier, or that collides with another


@dataclass
class SupportedNode:
    """A node: its ICD, its supported messages, and why the remaining ones are not
    supported.
    """

    definitions: Definitions
    icd: Icd | None
    messages: list[Definition]
    causes: dict[str, str] = field(default_factory=dict)


def supported_messages(definitions: Definitions, folder: Path) -> SupportedNode:
    """Write the node into ``folder`` and remove rejected messages until no error
    remains.
    """
    causes = {
        definition.name: definition.cause
        for definition in definitions.messages
        if definition.cause
    }
    remaining = [
        definition
        for definition in definitions.messages
        if not definition.cause and not definition.unread
    ]
    file = folder / f"{definitions.name}.yaml"
    if definitions.tree is not None:
        return _imported(definitions, definitions.tree, file, remaining, causes)
    # Each round removes the messages with errors, or renames their fields.
    for _ in range(ROUNDS):
        if not remaining:
            break
        owners = _write(file, definitions.node, remaining)
        loaded = load([file])
        errors = [finding for finding in loaded.findings if finding.severity == "error"]
        if not errors:
            return SupportedNode(definitions, loaded.icd, remaining, causes)
        for finding in errors:
            owner = owners.get(finding.place.line)
            if owner is None:
                raise ValueError(str(finding))
            if finding.code not in NAMES or not _renamed(owner, _quoted(file, finding)):
                causes.setdefault(owner.name, finding.code)
        remaining = [
            definition for definition in remaining if definition.name not in causes
        ]
    file.unlink(missing_ok=True)
    return SupportedNode(definitions, None, [], causes)


def _imported(
    definitions: Definitions,
    tree: dict,
    file: Path,
    remaining: list[Definition],
    causes: dict[str, str],
) -> SupportedNode:
    """Write a node that `icdgen import` created, in the style of `icdgen fmt`.

    All its messages are supported.
    """
    names, tree = {definition.name for definition in remaining}, dict(tree)
    tree["messages"] = [
        message for message in tree["messages"] if message["name"] in names
    ]
    if link := tree.get("protocol", {}).get("link", {}):
        # Seeds of messages that were removed would be errors.
        checksums = {}
        for name, checksum in link.get("checksums", {}).items():
            seeds = checksum["seeds"].items()
            own_seeds = {owner: seed for owner, seed in seeds if owner in names}
            checksums[name] = {**checksum, "seeds": own_seeds}
        if checksums:
            tree["protocol"] = {
                **tree["protocol"],
                "link": {**link, "checksums": checksums},
            }
    file.write_text(emit.canonical_yaml(tree), encoding="utf-8")
    loaded = load([file])
    if not loaded.ok:
        raise ValueError(f"{file}: {loaded.findings}")
    return SupportedNode(definitions, loaded.icd, remaining, causes)


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
    """Give a field, member or message an identifier of its own; return whether it is
    new.
    """
    members = [member for enum in owner.enums for member in enum["members"]]
    fields = [
        *owner.fields,
        *(field for struct in owner.structs for field in struct["fields"]),
    ]
    for named, number in (
        *((f, f["at"]) for f in fields),
        *((struct, owner.id) for struct in owner.structs),
        *((m, m["value"]) for m in members),
        (owner.more, owner.id),
    ):
        if named.get("name", owner.name) == name and "identifier" not in named:
            plain = (
                name
                if re.match(r"[^A-Za-z0-9]*[A-Za-z]", name) and name.isascii()
                else f"item {name}"
            )
            named["identifier"] = (
                f"{plain if plain.isascii() else 'item'} {number}".replace(
                    "-", "minus "
                )
            )
            return True
    return False


def _write(file: Path, node: dict, messages: list[Definition]) -> dict[int, Definition]:
    """Write one line for each enumeration, struct and message.

    Return the definition that each line belongs to, by the number of the line.
    """
    lines, owners = ['{"icdgen": 1, "node": ' + json.dumps(node) + ', "enums": ['], {}
    enums = [
        (json.dumps(enum), definition)
        for definition in messages
        for enum in definition.enums
    ]
    structs = [
        (json.dumps(struct), definition)
        for definition in messages
        for struct in definition.structs
    ]
    times = Counter((definition.kind, definition.id) for definition in messages)
    shared = {
        key: {"shares_id": True} if number > 1 else {} for key, number in times.items()
    }
    trees = [
        (
            json.dumps(definition.tree() | shared[definition.kind, definition.id]),
            definition,
        )
        for definition in messages
    ]
    for group, after in (
        (enums, '], "structs": ['),
        (structs, '], "messages": ['),
        (trees, "]}"),
    ):
        for number, (text, definition) in enumerate(group):
            lines.append(text + ("," if number + 1 < len(group) else ""))
            owners[len(lines)] = definition
        lines.append(after)
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return owners
