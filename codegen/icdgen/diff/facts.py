"""Differences of the protocol section between two nodes.

`facts` compares the YAML trees key by key and yields one entry for each differing value
with its path, such as ``protocol.link.framing.escape``. `packet_formats_differ` tells
whether such differences change the bytes around the data of a message.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import astuple, replace
from typing import Any

from icdgen.diagnostics import Place
from icdgen.diff.where import Places
from icdgen.frozen import NamedTuple
from icdgen.icd.located import Map, Seq
from icdgen.icd.model import Icd, Node, framed_link
from icdgen.protocol import facts as protocol

# Keys that describe the manual, not the device
WORDS = frozenset(("source", "summary", "printed_constant"))
NAMES = ("name", "role", "value")  # keys that identify the rows of a list
# Keys whose addition or removal changes the packet format.
PART = re.compile(
    r"protocol\.link(\.packets(\.[^.]+)?)?(\.(header|trailer)(\.[^.]+)?)?"
)
AROUND = re.compile(r"protocol\.link\.(framing|header|trailer|packets|checksums)\b.*")

# To telecommands and requests of telemetry
RESPONSES = re.compile(r"protocol\.link\.(commands|requests)\b.*")


class FactDifference(NamedTuple):
    """Fact that differs; ``old`` or ``new`` has the value None if it is not declared."""

    path: str  # "protocol.link.framing.escape"
    old: object
    new: object
    places: Places
    is_word: bool


def facts(old: Node, new: Node) -> Iterator[FactDifference]:
    """Yield all facts that differ, in the order of the old node, then of the new node."""
    before, after = (
        _Side(node.protocol, node.source.get("protocol")) for node in (old, new)
    )
    yield from _compare("protocol", before, after, is_word=False)


class _Side(NamedTuple):
    """Value of one side with its YAML node and place."""

    value: Any = None
    tree: object = None
    place: Place | None = None

    def inside(self, step: Any) -> _Side:
        """Return the value at a key or index, empty if it does not exist."""
        value, tree = self.value, self.tree
        if step is None or not (
            step in value if isinstance(value, dict) else step < len(value)
        ):
            return _Side()
        if isinstance(tree, Map) and step in tree:
            return _Side(value[step], tree[step], tree.at(step))
        if isinstance(tree, Seq) and step < len(tree):
            return _Side(value[step], tree[step], tree.item_at(step))
        return _Side(value[step], None, self.place)


def _compare(
    path: str, before: _Side, after: _Side, is_word: bool
) -> Iterator[FactDifference]:
    old, new = before.value, after.value
    # True equals 1 in Python, but not in YAML.
    if old == new and type(old) is type(new):
        return
    if isinstance(old, dict) and isinstance(new, dict):
        for key in old | new:
            yield from _compare(
                f"{path}.{key}",
                before.inside(key),
                after.inside(key),
                is_word or key in WORDS,
            )
    # Lists of mappings are compared by name, so that an insertion is one difference.
    elif (
        isinstance(old, list)
        and isinstance(new, list)
        and any(isinstance(v, dict) for v in (*old, *new))
    ):
        was, now = _row_names(old), _row_names(new)
        for name in was | now:
            yield from _compare(
                f"{path}.{name}",
                before.inside(was.get(name)),
                after.inside(now.get(name)),
                is_word,
            )
    else:
        yield FactDifference(path, old, new, (before.place, after.place), is_word)


def _row_names(rows: list[Any]) -> dict[str, int]:
    """Return the index of each row by its name.

    Repeated names are numbered: ``constant#2``.
    """
    index_by_name: dict[str, int] = {}
    occurrences: Counter[str] = Counter()
    for index, row in enumerate(rows):
        name = str(index)
        if isinstance(row, dict):
            name = next((str(row[key]) for key in NAMES if key in row), name)
        occurrences[name] += 1
        if occurrences[name] > 1:
            name = f"{name}#{occurrences[name]}"
        index_by_name[name] = index
    return index_by_name


def shown(value: object) -> str:
    """Return a value in the notation of the ICD, shortened."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    # Manuals print bytes and masks in hexadecimal.
    if isinstance(value, int) and value > 9:
        return f"{value} (0x{value:02X})"
    if isinstance(value, list):
        return f"[{', '.join(shown(item) for item in value)}]"
    if isinstance(value, dict):
        entries = [f"{k}: {shown(item)}" for k, item in value.items() if k not in WORDS]
        return f"{{{', '.join(entries)}}}"
    return str(value)


def has_packet_format(side: tuple[Icd, Node]) -> bool:
    """Return whether messages of the node have a packet format."""
    return bool(framed_link(side[1].protocol))


def packet_formats_differ(
    old: tuple[Icd, Node], new: tuple[Icd, Node], direction: str
) -> bool:
    """Return whether the packet formats of a direction are incompatible, regardless of
    the data.
    """
    return _form(*old, direction) != _form(*new, direction)


def _form(icd: Icd, node: Node, direction: str) -> object:
    """Return everything that determines header and trailer of a message in
    ``direction``.
    """
    stream = protocol.of(icd, node).stream
    assert stream is not None
    # `PacketField.values` has the value in telecommands first, then in telemetry.
    place = int(direction == "telemetry")
    packets = []
    for packet in stream.packets_of(direction):
        fields = []
        for field in packet.fields:
            # Only the constant of this direction counts; defaults of other roles do not
            # change the format.
            value = field.values[place] if field.role == "constant" else 0
            fields.append(replace(field, values=(value, value)))
        unnamed = replace(packet, name="", directions=(), fields=tuple(fields))
        packets.append(astuple(unnamed))
    return stream.delimited_by, stream.escaping, packets
