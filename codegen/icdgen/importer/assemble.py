"""Build one ICD tree per node from the results of all tables, and report contradictions
between tables.

The `Survey` of a document goes in, with messages, enumerations and lists in the order
of their tables. They are assigned to nodes here; `references` compares and connects
them, and `icd_trees` writes the tree of each node.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from icdgen.import_results.findings import ImportFinding
from icdgen.importer import icd_trees, references
from icdgen.importer.document import Document
from icdgen.importer.model import (
    NodeParts,
    ReadEnum,
    ReadList,
    ReadMessage,
    Survey,
    TableResult,
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
    everything = [enum for _, enum in survey.results_of(ReadEnum)]
    for node in nodes:
        _merge_enums(node, survey)
    for node in nodes:
        references.compare_with_lists(node, findings)
    _include_shared_nodes(nodes)
    for node in nodes:
        references.resolve_enumerations(node, nodes, everything, findings)
    for node in nodes:
        head = icd_trees.head(node, document, profile)
        references.check_messages(node, head, findings)
    return {
        node.name: icd_trees.tree(node, document, profile, prose, findings)
        for node in nodes
        if node.has_contents
    }


def _parts_by_node(
    document: Document, survey: Survey, profile: Profile
) -> list[NodeParts]:
    """Return the nodes, each with the contents of its tables."""
    keys = _nodes_of_results(survey, profile)
    used = [
        (key, result.content)
        for key, result in zip(keys, survey.results, strict=True)
        if result.content is not None
    ]
    # Captions that differ in punctuation only ("Motor A", "Motor-A") name one node.
    by_name: dict[str, NodeParts] = {}
    nodes: dict[str, NodeParts] = {}
    for key, _ in used:
        if key and key not in nodes:
            node = _new_node(key, profile)
            nodes[key] = by_name.setdefault(node.name, node)
    if used and not nodes:
        # Neither the document nor the profile names a node.
        words = re.findall("[A-Za-z0-9]+", Path(document.file).stem)
        name = " ".join(words[:3]) or "device"
        nodes = {"": _new_node(name, profile)}
    first = next(iter(nodes), "")
    for key, content in used:
        nodes.get(key, nodes[first]).add_content(content)
    distinct = list({node.name: node for node in nodes.values()}.values())
    if len(distinct) == 1:
        distinct[0].shared = False
    return [node for node in distinct if node.has_contents]


def _nodes_of_results(survey: Survey, profile: Profile) -> list[str]:
    """Return the name of the node of each table in the manual.

    It is "" if neither a caption nor the profile names a node.
    """
    keys, current, twins = [], "", _twins(survey)
    for result in survey.results:
        stated = _node_by_profile(result, profile)
        if (
            stated is None
            and isinstance(result.content, ReadList)
            and result.content.node
        ):
            current = result.content.node
        if stated is not None:
            current = stated
        keys.append(current)
    keys = [_name_in_profile(key, profile) for key in keys]
    named = {
        id(result.table): key for result, key in zip(survey.results, keys, strict=True)
    }
    return [
        key or named.get(twins.get(id(result.table), 0), "")
        for result, key in zip(survey.results, keys, strict=True)
    ]


def _twins(survey: Survey) -> dict[int, int]:
    """Enumeration table -> a later one of the same name, both by identity."""
    last: dict[str, int] = {}
    twins: dict[int, int] = {}
    for result, enum in reversed(survey.results_of(ReadEnum)):
        name = squeezed(enum.name)
        if name in last:
            twins[id(result.table)] = last[name]
        else:
            last[name] = id(result.table)
    return twins


def _node_by_profile(result: TableResult, profile: Profile) -> str | None:
    """Return the node to which the profile assigns a table, or None.

    The profile states table numbers or groups, or words in the caption of a list.
    """
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
        elif isinstance(result.content, ReadList):
            text = result.content.node or result.table.caption
            if any(_has_phrase(text, match) for match in words.match):
                return words.name
    return None


def _name_in_profile(key: str, profile: Profile) -> str:
    """Return the name in the profile of a node that the manual calls ``key``."""
    for node in profile.nodes:
        if node.name == key or any(_has_phrase(key, match) for match in node.match):
            return node.name
    return key


def _has_phrase(text: str, phrase: str) -> bool:
    """Return whether a text has the words of a phrase, consecutively and in order."""
    words, parts = folded(text), folded(phrase)
    return any(words[i : i + len(parts)] == parts for i in range(len(words)))


def _new_node(key: str, profile: Profile) -> NodeParts:
    """Return a node without contents, as the profile describes it.

    The name of a node that the profile does not have is derived from ``key``, its name
    in the manual.
    """
    words = next((w for w in profile.nodes if w.name == key), None)
    if words is not None:
        shared = any(_has_phrase(key, s) for s in profile.data["shared"])
        return NodeParts(
            words.name,
            words.head.get("title", key),
            shared,
            words,
            include=list(words.include),
        )
    shared = any(_has_phrase(key, word) for word in profile.data["shared"])
    name = re.sub(r"[^a-z0-9]", "", key.casefold())[:40]
    if not name or not name[0].isalpha():
        name = f"node{name}"[:40]
    return NodeParts(name, key, shared)


def _include_shared_nodes(nodes: list[NodeParts]) -> None:
    """Let all other nodes include the nodes that the profile states as shared."""
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
    # Tables to which fields refer, by run of table numbers and number.
    references_of_fields = set()
    for _, message in survey.results_of(ReadMessage):
        for field in message.all_fields:
            if field.described.enum_table is not None:
                references_of_fields.add(
                    (message.table.run, field.described.enum_table)
                )
    # By printed name, each enumeration with other members.
    variants: dict[str, list[ReadEnum]] = {}
    for enum in node.enums:
        same_name = variants.setdefault(enum.name, [])
        values = [(member.value, member.name) for member in enum.members]
        equal = next(
            (
                index
                for index, variant in enumerate(same_name)
                if [(member.value, member.name) for member in variant.members] == values
            ),
            None,
        )
        if equal is not None:
            first = same_name[equal]
            is_first_referenced, is_referenced = (
                (table.run, table.label) in references_of_fields
                for table in (first.table, enum.table)
            )
            if is_referenced and not is_first_referenced:
                enum.name = first.name
                enum.also = [first.table, *first.also]
                same_name[equal] = enum
            else:
                first.also.append(enum.table)
            continue
        same_name.append(enum)
        if len(same_name) == 1:
            continue
        name = f"{enum.name} {len(same_name)}"
        first = same_name[0]
        survey.import_findings.append(
            ImportFinding(
                "IMP052",
                f"{enum.table.title}: table {table_name(first.table.label)} has an enumeration of this name "
                "with other members",
                enum.table.spot,
                f"held as `{name}`: see which one the fields mean",
                "error",
            )
        )
        enum.name = name
    node.enums = sorted(
        (enum for same_name in variants.values() for enum in same_name),
        key=lambda enum: enum.table.number,
    )
