"""The protocol section as single facts: what differs, where it stands, and whether that changes what is around each message."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import astuple
from typing import Any, NamedTuple

from icdgen.diagnostics import Place
from icdgen.diff.where import Places
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Icd, Node
from icdgen.protocol import facts as protocol

WORDS = frozenset(("source", "summary", "printed_constant"))  # keys that say something about the manual, not the device
NAMES = ("name", "role", "value")  # what tells the rows of a list apart
PART = re.compile(r"protocol\.stream(\.(header|trailer)(\.[^.]+)?)?")  # without which a message looks otherwise
AROUND = re.compile(r"protocol\.stream\.(delimited_by|header|trailer)\b.*|protocol\.checksums\b.*")


class Fact(NamedTuple):
    """A fact that differs; ``old`` or ``new`` is None where it is not stated."""

    path: str  # "protocol.uart.framing.escape"
    old: object
    new: object
    places: Places
    is_word: bool


def facts(old: Node, new: Node) -> Iterator[Fact]:
    """All facts that differ, in the order of the old node, then of the new one."""
    before, after = (_Side(node.protocol, node.source.get("protocol")) for node in (old, new))
    yield from _compare("protocol", before, after, is_word=False)


class _Side(NamedTuple):
    """A value of one side, what was read for it, and where that stands."""

    value: Any = None
    tree: object = None
    place: Place | None = None

    def inside(self, step: Any) -> _Side:
        """A step further down, which may lead nowhere."""
        value, tree = self.value, self.tree
        if step is None or not (step in value if isinstance(value, dict) else step < len(value)):
            return _Side()
        if isinstance(tree, Map) and step in tree:
            return _Side(value[step], tree[step], tree.at(step))
        if isinstance(tree, Seq) and step < len(tree):
            return _Side(value[step], tree[step], tree.item_at(step))
        return _Side(value[step], None, self.place)


def _compare(path: str, before: _Side, after: _Side, is_word: bool) -> Iterator[Fact]:
    old, new = before.value, after.value
    if old == new and type(old) is type(new):
        return
    if isinstance(old, dict) and isinstance(new, dict):
        for key in old | new:
            yield from _compare(f"{path}.{key}", before.inside(key), after.inside(key), is_word or key in WORDS)
    elif isinstance(old, list) and isinstance(new, list) and any(isinstance(v, dict) for v in (*old, *new)):
        was, now = _row_names(old), _row_names(new)
        for name in was | now:
            yield from _compare(f"{path}.{name}", before.inside(was.get(name)), after.inside(now.get(name)), is_word)
    else:
        yield Fact(path, old, new, (before.place, after.place), is_word)


def _row_names(rows: list[Any]) -> dict[str, int]:
    """The place of each row by its name; of several that are called alike the second is ``constant#2``."""
    found: dict[str, int] = {}
    seen: Counter[str] = Counter()
    for index, row in enumerate(rows):
        key = next((str(row[k]) for k in NAMES if k in row), str(index)) if isinstance(row, dict) else str(index)
        seen[key] += 1
        found[f"{key}#{seen[key]}" if seen[key] > 1 else key] = index
    return found


def shown(value: object) -> str:
    """A value as a reader of the ICD knows it, short."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int) and value > 9:
        return f"{value} (0x{value:02X})"
    if isinstance(value, list):
        return f"[{', '.join(shown(item) for item in value)}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {shown(item)}' for key, item in value.items() if key not in WORDS)}}}"
    return str(value)


def has_envelope(side: tuple[Icd, Node]) -> bool:
    """Whether messages of the node travel in envelopes."""
    return "stream" in side[1].protocol


def differ(old: tuple[Icd, Node], new: tuple[Icd, Node], direction: str) -> bool:
    """Whether no message of a direction that one side makes is one of the other's, whatever it holds."""
    return _form(*old, direction) != _form(*new, direction)


def _form(icd: Icd, node: Node, direction: str) -> object:
    """All that decides what is around the data of a message of ``direction``."""
    stream = protocol.of(icd, node).stream
    assert stream is not None
    place = int(direction == "telemetry")
    fields = [(*astuple(one)[:-1], one.values[place] if one.role == "constant" else None) for one in stream.fields]
    check = None if stream.check is None else astuple(stream.check)
    return stream.delimited_by, stream.header_bytes, stream.trailer_bytes, stream.length_plus, fields, check
