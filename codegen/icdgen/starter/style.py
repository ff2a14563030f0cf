"""Style of an existing node, for the first ICD of another device: its links, byte order
and bit order.

`style_of` takes these parts from the YAML of the node; `in_style` puts them into the
text of the first ICD and preserves its comments.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from icdgen.errors import UserError
from icdgen.icd import source
from icdgen.icd.fmt import emit, read, scalars
from icdgen.icd.fmt.commented import Branch, Child, ScalarText
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import (
    KEYS_OF_IDS,
    TELECOMMAND,
    TELEMETRY,
    Icd,
    Node,
    merged_protocols,
)
from icdgen.icd.packets import ID_ROLE, declared_packets
from icdgen.icd.rules.protocol_names import MESSAGES

# Protocol sections about links. The other sections are about files, logs and programs
# of the node itself.
_SECTIONS = (
    "identification",
    "link",
)
# Keys of these sections that name messages of the node, which are not copied.
_KEYS_ABOUT_MESSAGES = {"link": ("commands",)}
# Keys about the manual of the node, and about messages that are not copied.
_KEYS_ABOUT_THE_MANUAL = (
    "source",
    "assumptions",
    "listed",
    "group",
    "contains",
    "printed_constant",
)
_DIRECTIONS = (TELECOMMAND, TELEMETRY)

Tree = dict[str, Any]


@dataclass(frozen=True)
class Style:
    """Parts of an ICD that the first ICD copies, as trees of plain values."""

    node: Tree
    protocol: Tree
    units: list[Tree]
    enums: list[Tree]
    messages: list[Tree]
    lacks_responses: bool  # whether the responses to telecommands are not copied


def style_of(icd: Icd, node: Node, texts: Mapping[str, str]) -> Style:
    """Return the style of a node. ``texts`` are the files that the ICDs were read from.

    Raises `UserError` if the node does not describe a link.
    """
    scope = (*icd.included(node), node)
    spelled = _SpelledTrees(texts)
    sections = merged_protocols(
        spelled.plain(owner.source.get("protocol") or {}) for owner in scope
    )
    protocol = {key: sections[key] for key in _SECTIONS if key in sections}
    if not protocol:
        raise UserError(
            f"{node.name} does not say how its messages travel",
            "take the style of another node",
        )
    lacks_responses = "commands" in (sections.get("link") or {})
    if "packets" in protocol.get("link", {}):
        protocol["link"] = _without_listed_messages(protocol["link"])
    for key, omitted_keys in _KEYS_ABOUT_MESSAGES.items():
        for omitted in omitted_keys if key in protocol else ():
            protocol[key] = {k: v for k, v in protocol[key].items() if k != omitted}
    # The messages that the copied sections name, and the units and enumerations of their
    # fields
    named = set(_strings(protocol, MESSAGES))
    messages: list[Map] = []
    for owner in scope:
        messages += [each.source for each in owner.messages if each.name in named]
    fields = [field for message in messages for field in message.get("fields") or ()]
    used_units = {field.get("unit") for field in fields}
    used_enums = {field.get("enum") for field in fields} | set(_strings(protocol, None))
    units: list[Map] = []
    enums: list[Map] = []
    for owner in scope:
        declared_units = owner.source.get("units") or ()
        units += [each for each in declared_units if each["symbol"] in used_units]
        enums += [each.source for each in owner.enums if each.name in used_enums]
    head = node.source["node"]
    orders = {
        key: head[key] for key in ("byte_order", "bit_order", "id_bits") if key in head
    }
    return Style(
        node=orders,
        protocol=protocol,
        units=list(map(spelled.plain, units)),
        enums=list(map(spelled.plain, enums)),
        messages=list(map(spelled.plain, messages)),
        lacks_responses=lacks_responses,
    )


def in_style(text: str, style: Style, origin: str) -> str:
    """Return the ICD ``text`` with the style of the node ``origin``.

    The style replaces the protocol section, and enumerations and messages of the same
    names. Comments are preserved.
    """
    root = read.read_commented(text, source.parse(text.encode(), "the first ICD"))
    parts = {scalars.name(child.key): child for child in root.children}
    for child in _children(parts["node"]):
        if scalars.name(child.key) in style.node:
            child.value = emit.node(style.node[scalars.name(child.key)])
    own_messages = [_name(child) for child in _children(parts["messages"])]
    node_keys = {scalars.name(child.key) for child in _children(parts["node"])}
    added = emit.branch(
        {key: value for key, value in style.node.items() if key not in node_keys}
    )
    parts["node"].value.children += added.children  # type: ignore[union-attr]
    parts["protocol"].value = emit.branch(_seeded(style.protocol, own_messages))
    parts["protocol"].trailing = [f"# how messages travel, as {origin} has it"]
    # An enumeration and a message of one name have the same name in generated code.
    enums = [
        (
            {**enum, "identifier": f"Link {enum['name']}"}
            if enum["name"] in own_messages and "identifier" not in enum
            else enum
        )
        for enum in style.enums
    ]
    for key, more in (("enums", enums), ("messages", style.messages)):
        names = {item["name"] for item in more}
        own = [child for child in _children(parts[key]) if _name(child) not in names]
        if key == "enums":
            # The error codes of the protocol section that was replaced.
            own = [child for child in own if _name(child) != "Error"]
        else:
            _renumber(own, style)
            _lengthen(own, style)
        parts[key].value.children = emit.branch(more).children + own  # type: ignore[union-attr]
    if style.units:
        root.children.append(
            Child(ScalarText("units", "units"), emit.branch(style.units))
        )
    return emit.canonical_yaml_of_branch(root)


def _without_listed_messages(link: Tree) -> Tree:
    """Return the section `link` with the packets of all messages, of requests and of
    refused requests only: other packets have messages that are not copied.
    """
    requests = link.get("requests", {})
    responses = (row for row in requests.values() if isinstance(row, dict))
    named = {row.get("packet") for row in responses}
    responding = {
        row.get("packet")
        for row in link.get("commands", {}).values()
        if isinstance(row, dict)
    }
    packets = {
        name: packet
        for name, packet in link["packets"].items()
        if "messages" not in packet and (name in named or name not in responding)
    }
    return {**link, "packets": packets}


def _seeded(protocol: Tree, messages: list[str]) -> Tree:
    """Return the protocol section with checksum seeds of 0 for these messages instead
    of the seeds of other messages.
    """
    seeds = {"seeds": dict.fromkeys(messages, 0)}
    link = dict(protocol.get("link", {}))
    named = _checksums_in(link)
    checksums = {
        name: {**checksum, **seeds} if "seeds" in checksum else checksum
        for name, checksum in link.pop("checksums", {}).items()
        if name in named
    }
    if checksums:
        link["checksums"] = checksums
    return {**protocol, "link": link} if link else protocol


def _checksums_in(tree: object) -> set[str]:
    """Return the names of the checksums that fields of a link use.

    Procedures use the other checksums, and are not copied.
    """
    if isinstance(tree, list):
        return set().union(*map(_checksums_in, tree))
    if not isinstance(tree, dict):
        return set()
    own = {tree["checksum"]} if isinstance(tree.get("checksum"), str) else set()
    return own.union(*map(_checksums_in, tree.values()))


def _renumber(messages: list[Child], style: Style) -> None:
    """Replace ids that are out of range in the style, or that its messages have, by
    unused ids.
    """
    ranges = _ranges(style.protocol)
    framing = style.protocol.get("link", {}).get("framing", {})
    # Without a start byte, an id cannot be an escape character.
    escapes = [framing.get(key) for key in ("escape", "end", "data")]
    used = {
        (direction, message[key])
        for message in style.messages
        for key, direction in KEYS_OF_IDS[message["kind"]]
    }
    for message in messages:
        entries = {scalars.name(child.key): child for child in _children(message)}
        for key, direction in KEYS_OF_IDS[_value(entries["kind"])]:
            first, last = ranges[direction]
            candidates = (_value(entries[key]), *range(first, last + 1))
            for id in candidates:
                is_used = (direction, id) in used or id in escapes
                if first <= id <= last and not is_used:
                    entries[key].value = ScalarText(id, str(id))
                    break
            used.add((direction, _value(entries[key])))


def _lengthen(messages: list[Child], style: Style) -> None:
    """Add reserved bytes to messages that are no multiple of the unit of lengths."""
    packets = declared_packets(style.protocol.get("link", {})).all
    units = (
        row.get("unit", 1)
        for packet in packets
        for row in packet.fields_of_role("length")
    )
    unit = max(units, default=1)
    for message in messages:
        children = _children(message)
        at = [scalars.name(child.key) for child in children].index("length")
        length = _value(children[at])
        reserved = -length % unit
        if reserved:
            total = length + reserved
            children[at].value = ScalarText(total, str(total))
            children[at + 1 : at + 1] = emit.branch({"reserved": reserved}).children


def _ranges(protocol: Tree) -> dict[str, tuple[int, int]]:
    """Return the first and last id of each direction."""
    section = protocol.get("link", {}).get("ids") or {}
    packets = declared_packets(protocol.get("link", {})).all
    widths = (
        sum(row["bits"] for row in packet.fields_of_role(ID_ROLE)) for packet in packets
    )
    bits = min((width for width in widths if width), default=8)
    # Ids of the first ICD are small numbers, also if the link could carry larger ones.
    most = (1 << min(bits, 8)) - 1
    ranges: dict[str, tuple[int, int]] = {}
    for direction in _DIRECTIONS:
        part = section.get(direction)
        ranges[direction] = (part["first"], part["last"]) if part else (0, most)
    return ranges


class _SpelledTrees:
    """Converts trees of files to plain values that preserve the spelling of hexadecimal
    numbers, such as 0x1F.
    """

    def __init__(self, texts: Mapping[str, str]) -> None:
        self.lines = {file: text.split("\n") for file, text in texts.items()}

    def plain(self, value: Any) -> Any:
        """Return a tree without places, and without keys about the manual."""
        if isinstance(value, Map):
            return {
                key: self._item(item, value.at(key))
                for key, item in value.items()
                if key not in _KEYS_ABOUT_THE_MANUAL
            }
        if isinstance(value, Seq):
            return [self._item(item, place) for item, place in value.placed()]
        return value

    def _item(self, value: Any, place: Any) -> Any:
        """Return a value at a place; a hexadecimal number with its spelling."""
        if not isinstance(value, int) or isinstance(value, bool):
            return self.plain(value)
        lines, spelling = self.lines.get(place.file, []), ""
        if place.line <= len(lines):
            line = lines[place.line - 1]
            spelling = line[place.column - 1 :][: place.length]
        return emit.Spelled(spelling) if spelling.lower().startswith("0x") else value


def _strings(value: Any, keys: tuple[str, ...] | None) -> Iterator[str]:
    """Yield the texts of these keys at any depth; without ``keys`` the texts of all
    keys.
    """
    if isinstance(value, dict):
        for key, item in value.items():
            if keys is None or key in keys:
                for text in item if isinstance(item, list) else [item]:
                    if isinstance(text, str):
                        yield text
            yield from _strings(item, keys)
    elif isinstance(value, list):
        for item in value:
            yield from _strings(item, keys)


def _children(child: Child) -> list[Child]:
    """Return the entries or items of a value; an empty list for a scalar."""
    return child.value.children if isinstance(child.value, Branch) else []


def _value(child: Child) -> Any:
    """Return the value of a scalar."""
    assert isinstance(child.value, ScalarText)
    return child.value.value


def _name(child: Child) -> str:
    """Return the value of the key `name` of a mapping; empty without the key."""
    for entry in _children(child):
        if scalars.name(entry.key) == "name":
            name: str = _value(entry)
            return name
    return ""
