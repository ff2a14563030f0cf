"""Build one ICD tree per node from the results of all tables, and report contradictions
between tables.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any

from icdgen.import_results.findings import ImportFinding
from icdgen.importer import icd_trees, references
from icdgen.importer.document import Document
from icdgen.importer.model import (
    Found,
    NodeParts,
    ReadEnum,
    ReadList,
    ReadMessage,
    Survey,
)
from icdgen.importer.profile import Profile
from icdgen.importer.words import folded, squeezed, table_name


def assemble(
    document: Document, survey: Survey, profile: Profile, prose: bool = False
) -> dict[str, dict[str, Any]]:
    """Return the trees by node name. Findings are added to ``survey.import_findings``.

    ``prose``: keep descriptions as summaries.
    """
    findings = survey.import_findings
    nodes = _parts_by_node(document, survey, profile)
    everything = [enum for _, enum in survey.of(ReadEnum)]
    for node in nodes:
        _merge_enums(node, survey)
    for node in nodes:
        references.listed(node, findings)
    _includes(nodes)
    for node in nodes:
        references.enums(node, nodes, everything, findings)
    for node in nodes:
        head = icd_trees.head(node, document, profile)
        references.complete(node, head, findings)
    return {
        node.name: icd_trees.tree(node, document, profile, prose, findings)
        for node in nodes
        if node.holds
    }


def _parts_by_node(
    document: Document, survey: Survey, profile: Profile
) -> list[NodeParts]:
    """Each thing to its node."""
    keys = _keys(survey, profile)
    used = [
        (key, result.thing)
        for key, result in zip(keys, survey.found, strict=True)
        if result.thing is not None
    ]
    nodes = {key: _node(key, profile) for key, _ in used if key}
    if used and not nodes:
        nodes = {"": _node(_document_name(document), profile)}
    first = next(iter(nodes), "")
    for key, thing in used:
        nodes.get(key, nodes[first]).add(thing)
    if len(nodes) == 1:
        next(iter(nodes.values())).shared = False
    return [node for node in nodes.values() if node.holds]


def _keys(survey: Survey, profile: Profile) -> list[str]:
    """Return the name of the node of each table in the manual.

    It is "" if neither a caption nor the profile names a node.
    """
    keys, current, twins = [], "", _twins(survey)
    for result in survey.found:
        stated = _by_profile(result, profile)
        if stated is None and isinstance(result.thing, ReadList) and result.thing.node:
            current = result.thing.node
        if stated is not None:
            current = stated
        keys.append(current)
    keys = [_canonical(key, profile) for key in keys]
    named = {
        id(result.table): key for result, key in zip(survey.found, keys, strict=True)
    }
    return [
        key or named.get(twins.get(id(result.table), 0), "")
        for result, key in zip(survey.found, keys, strict=True)
    ]


def _twins(survey: Survey) -> dict[int, int]:
    """Enumeration table -> a later one of the same name, both by identity."""
    last: dict[str, int] = {}
    twins: dict[int, int] = {}
    for result, enum in reversed(survey.of(ReadEnum)):
        name = squeezed(enum.name)
        if name in last:
            twins[id(result.table)] = last[name]
        else:
            last[name] = id(result.table)
    return twins


def _by_profile(result: Found, profile: Profile) -> str | None:
    number = result.table.label
    for words in profile.nodes:
        if words.tables is not None or words.group is not None:
            in_group = words.group is None or words.group == result.table.run
            in_tables = words.tables is None or (
                number is not None and words.tables[0] <= number <= words.tables[1]
            )
            if in_group and in_tables:
                return words.name
        elif not words.match:
            return words.name  # a profile with one node and nothing to choose by
        elif isinstance(result.thing, ReadList):
            text = result.thing.node or result.table.caption
            if any(_says(text, match) for match in words.match):
                return words.name
    return None


def _canonical(key: str, profile: Profile) -> str:
    """Return the name in the profile of a node that the manual calls ``key``."""
    return next(
        (
            w.name
            for w in profile.nodes
            if w.name == key or any(_says(key, m) for m in w.match)
        ),
        key,
    )


def _says(text: str, phrase: str) -> bool:
    words, parts = folded(text), folded(phrase)
    return any(words[i : i + len(parts)] == parts for i in range(len(words)))


def _node(key: str, profile: Profile) -> NodeParts:
    words = next((w for w in profile.nodes if w.name == key), None)
    if words is not None:
        shared = any(_says(key, s) for s in profile.data["shared"])
        return NodeParts(
            words.name,
            words.head.get("title", key),
            shared,
            words,
            include=list(words.include),
        )
    shared = any(_says(key, word) for word in profile.data["shared"])
    name = re.sub(r"[^a-z0-9]", "", key.casefold())[:40]
    if not name or not name[0].isalpha():
        name = f"node{name}"[:40]
    return NodeParts(name, key, shared)


def _document_name(document: Document) -> str:
    words = re.findall("[A-Za-z0-9]+", Path(document.file).stem)
    return " ".join(words[:3]) or "device"


def _includes(nodes: list[NodeParts]) -> None:
    """Nodes that share messages with all others are included by these."""
    shared = [node.name for node in nodes if node.shared]
    for node in nodes:
        if not node.shared:
            node.include += [
                f"{name}.yaml" for name in shared if f"{name}.yaml" not in node.include
            ]


def _merge_enums(node: NodeParts, survey: Survey) -> None:
    """Merge tables that print the same enumeration, and number enumerations that have
    only the name in common.

    A table to which a field refers becomes the source of the merged enumeration.
    """
    pointed = {
        (message.table.run, field.described.enum_table)
        for _, message in survey.of(ReadMessage)
        for field in message.all_fields
        if field.described.enum_table is not None
    }
    by_name: dict[str, ReadEnum] = {}
    taken: Counter[str] = Counter()
    for duplicate in node.enums:
        first = by_name.get(duplicate.name)
        if first is None:
            by_name[duplicate.name] = duplicate
            continue
        if [(m.value, m.name) for m in first.members] == [
            (m.value, m.name) for m in duplicate.members
        ]:
            is_meant, first_is = (
                (enum.table.run, enum.table.label) in pointed
                for enum in (duplicate, first)
            )
            if is_meant and not first_is:
                duplicate.also = [first.table, *first.also]
                by_name[duplicate.name] = duplicate
            else:
                first.also.append(duplicate.table)
            continue
        taken[duplicate.name] += 1
        name = f"{duplicate.name} {taken[duplicate.name] + 1}"
        survey.import_findings.append(
            ImportFinding(
                "IMP052",
                f"{duplicate.table.title}: table {table_name(first.table.label)} has an enumeration of this name "
                "with other members",
                duplicate.table.spot,
                f"held as `{name}`: see which one the fields mean",
                "error",
            )
        )
        duplicate.name = name
        by_name[name] = duplicate
    node.enums = sorted(by_name.values(), key=lambda enum: enum.table.number)
