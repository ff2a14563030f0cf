"""The style of a node that exists: how its messages travel, and in which order its bytes and bits stand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from icdgen.errors import UserError
from icdgen.icd import source
from icdgen.icd.fmt import emit, read, scalars
from icdgen.icd.fmt.commented import Branch, Child, Text
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import KEYS_OF_IDS, TELECOMMAND, TELEMETRY, Icd, Node
from icdgen.icd.rules.protocol_names import MESSAGES

# Sections about the line, and about what every message has; the others are about files, logs, programs of that very node.
_SECTIONS = ("message_id", "errors", "client", "identification", "uart", "i2c", "can", "crc8", "stream", "checksums")
_OF_ITS_MESSAGES = {"stream": ("replies",)}  # what a section says of messages that are not taken along
# What is said of a manual, and of frames that are not taken along.
_ABOUT_THE_MANUAL = ("source", "assumptions", "listed", "group", "contains", "printed_constant")
_WAYS = (TELECOMMAND, TELEMETRY)

Tree = dict[str, Any]


@dataclass(frozen=True)
class Style:
    """What is taken over: trees as an ICD has them. ``texts`` are the files that they were read from."""

    node: Tree
    protocol: Tree
    units: list[Tree]
    enums: list[Tree]
    messages: list[Tree]


def of(icd: Icd, node: Node, texts: Mapping[str, str]) -> Style:
    """The style of a node that was read from ``texts``. Raises `UserError` if it says nothing of how messages travel."""
    family = (*icd.included(node), node)
    taken = _Taken(texts)
    sections: dict[str, Any] = {}
    for one in family:
        sections.update(one.source.get("protocol") or {})
    protocol = {key: taken.plain(sections[key]) for key in _SECTIONS if key in sections}
    if not protocol:
        raise UserError(f"{node.name} does not say how its messages travel", "take the style of another node")
    for key, left in _OF_ITS_MESSAGES.items():
        if key in protocol:
            protocol[key] = {name: value for name, value in protocol[key].items() if name not in left}
    named = set(_strings(protocol, MESSAGES))
    messages = [m.source for one in family for m in one.messages if m.name in named]
    fields = [field for message in messages for field in message.get("fields") or ()]
    units = {field.get("unit") for field in fields}
    enums = {field.get("enum") for field in fields} | set(_strings(protocol, None))
    return Style(
        {key: node.source["node"][key] for key in ("byte_order", "bit_order", "id_bits") if key in node.source["node"]},
        protocol,
        [taken.plain(u) for one in family for u in one.source.get("units") or () if u["symbol"] in units],
        [taken.plain(e.source) for one in family for e in one.enums if e.name in enums],
        [taken.plain(message) for message in messages],
    )


def in_style(text: str, style: Style, origin: str) -> str:
    """The ICD ``text`` in that style: its own protocol, and what it calls as the style does, gives way. Comments stay."""
    root = read.read(text, source.parse(text.encode(), "the first ICD"))
    parts = {scalars.name(child.key): child for child in root.children}
    for child in _children(parts["node"]):
        if scalars.name(child.key) in style.node:
            child.value = emit.node(style.node[scalars.name(child.key)])
    mine = [_name(child) for child in _children(parts["messages"])]
    there = {scalars.name(child.key) for child in _children(parts["node"])}
    added = emit.branch({key: value for key, value in style.node.items() if key not in there})
    parts["node"].value.children += added.children  # type: ignore[union-attr]
    parts["protocol"].value = emit.branch(_seeded(style.protocol, mine))
    parts["protocol"].trailing = [f"# how messages travel, as {origin} has it"]
    for key, more in (("enums", style.enums), ("messages", style.messages)):
        names = {item["name"] for item in more}
        kept = [child for child in _children(parts[key]) if _name(child) not in names]
        if key == "enums":
            kept = [child for child in kept if _name(child) != "Error"]  # the codes of the protocol that gave way
        else:
            _renumber(kept, style)
        parts[key].value.children = emit.branch(more).children + kept  # type: ignore[union-attr]
    if style.units:
        root.children.append(Child(Text("units", "units"), emit.branch(style.units)))
    return emit.of(root)


def _seeded(protocol: Tree, messages: list[str]) -> Tree:
    """The section with seeds of these messages, 0 until they are known, where checksums have seeds of others."""
    checksums = {
        name: {**one, "seeds": dict.fromkeys(messages, 0)} if "seeds" in one else one
        for name, one in protocol.get("checksums", {}).items()
    }
    return {**protocol, "checksums": checksums} if checksums else protocol


def _renumber(messages: list[Child], style: Style) -> None:
    """Ids in the ranges of the style that its own messages leave free."""
    ranges = _ranges(style.protocol)
    used = {(way, m[key]) for m in style.messages for key, way in KEYS_OF_IDS[m["kind"]]}
    for message in messages:
        entries = {scalars.name(child.key): child for child in _children(message)}
        for key, way in KEYS_OF_IDS[_value(entries["kind"])]:
            first, last = ranges[way]
            wanted = _value(entries[key])
            free = [id for id in (wanted, *range(first, last + 1)) if first <= id <= last and (way, id) not in used]
            entries[key].value = Text(free[0], str(free[0])) if free else entries[key].value
            used.add((way, _value(entries[key])))


def _ranges(protocol: Tree) -> dict[str, tuple[int, int]]:
    """The ids that each direction can have."""
    section, rows = protocol.get("message_id") or {}, protocol.get("stream", {}).get("header", ())
    bits = min((row["bits"] for row in rows if row["role"] == "id"), default=8)
    most = (1 << min(bits, 8)) - 1
    return {way: (part["first"], part["last"]) if (part := section.get(way)) else (0, most) for way in _WAYS}


class _Taken:
    """Trees without their places. Numbers stay spelled as they were: 0x1F."""

    def __init__(self, texts: Mapping[str, str]) -> None:
        self.lines = {file: text.split("\n") for file, text in texts.items()}

    def plain(self, value: Any) -> Any:
        if isinstance(value, Map):
            return {k: self._item(v, value.at(k)) for k, v in value.items() if k not in _ABOUT_THE_MANUAL}
        if isinstance(value, Seq):
            return [self._item(item, place) for item, place in value.placed()]
        return value

    def _item(self, value: Any, place: Any) -> Any:
        if not isinstance(value, int) or isinstance(value, bool):
            return self.plain(value)
        lines = self.lines.get(place.file, [])
        spelling = lines[place.line - 1][place.column - 1 :][: place.length] if place.line <= len(lines) else ""
        return emit.Spelled(spelling) if spelling.lower().startswith("0x") else value


def _strings(value: Any, keys: tuple[str, ...] | None) -> Iterator[str]:
    """Texts under one of the keys (under any), on any level."""
    if isinstance(value, dict):
        for key, item in value.items():
            if keys is None or key in keys:
                yield from (one for one in (item if isinstance(item, list) else [item]) if isinstance(one, str))
            yield from _strings(item, keys)
    elif isinstance(value, list):
        for item in value:
            yield from _strings(item, keys)


def _children(child: Child) -> list[Child]:
    return child.value.children if isinstance(child.value, Branch) else []


def _value(child: Child) -> Any:
    assert isinstance(child.value, Text)
    return child.value.value


def _name(child: Child) -> str:
    return next((_value(one) for one in _children(child) if scalars.name(one.key) == "name"), "")
