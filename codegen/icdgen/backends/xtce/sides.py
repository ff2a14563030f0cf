"""All that a node speaks in one direction, ready for the template: what stands before the data, and the messages."""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from icdgen.backends.xtce.frames import Base, Entry, Frame, Frames, Row
from icdgen.backends.xtce.places import Run
from icdgen.backends.xtce.types import Type, Types, most_first
from icdgen.describe import NodeDescription
from icdgen.icd.model import TELECOMMAND, Icd

_UNPRINTABLE = re.compile("[^ -~\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]+")


_PACKET = {
    "Version": Run(0, 3), "Type": Run(3, 1), "SecondaryHeader": Run(4, 1), "Apid": Run(5, 11),
    "SequenceFlags": Run(16, 2), "SequenceCount": Run(18, 14), "Length": Run(32, 16),
}  # fmt: skip
_IN_COMMANDS = {"Type": 1, "SequenceFlags": 3}  # the others are 0, until the link counts and measures


class Head(NamedTuple):
    """The header of a space packet, or the id alone; ``id`` is the parameter, or the argument, that tells a message."""

    id: str
    bits: int
    rows: tuple[Row, ...]
    entries: tuple[Entry, ...]


class Side(NamedTuple):
    """One of the two halves of a file."""

    types: dict[str, Type]  # by name
    head: Head
    rows: list[Row]  # parameters; arguments stand with their commands
    frames: list[Frame]
    bases: list[Base]  # of frames that share an id
    notes: list[str]


def side(icd: Icd, node: NodeDescription, direction: str) -> Side | None:
    """What a node speaks in a direction; None if it is nothing."""
    spoken = next((one.messages for one in node.directions if one.kind == direction), ())
    if not spoken:
        return None
    types = Types()
    id_bits = max(node.model.id_bits, *(id.bit_length() for one in node.all_messages for id in one.model.ids))
    head = _head(id_bits, icd.protocol_of(node.model), direction, types)
    shared = {
        one.id: min(among.message.model.layout.shortest for among in one.messages)
        for one in node.ids(direction)
        if one.is_shared
    }
    maker = Frames(direction, types, head.bits, shared=shared, taken={"TelemetryFrame", "TelecommandFrame"})
    frames = [maker.frame(message) for message, _ in spoken]
    notes = [f"{direction} `{one.message.model.name}`: {note}" for one in frames for note in (*one.lacks, *one.notes)]
    if direction == TELECOMMAND:
        notes += [f"{direction} `{one.message.model.name}` is left out" for one in frames if one.lacks]
        frames = [one for one in frames if not one.lacks]
    rows = [*head.rows, *maker.reserved.values(), *(row for one in frames for row in one.rows)]
    named = {name: type_ for type_, name in types.names.items()}
    return Side(named, head, rows, frames, list(maker.bases.values()), notes)


def _head(id_bits: int, protocol: dict[str, Any], direction: str, types: Types) -> Head:
    """What all messages of a direction begin with."""
    header = protocol.get("stream", {}).get("header", ())
    is_packet = [(one.get("at"), one.get("bits")) for one in header] == [one[:2] for one in _PACKET.values()]
    places = _PACKET if is_packet else {"Id": Run(0, -(-id_bits // 8) * 8)}
    id = "Apid" if is_packet else "Id"
    rows, entries = [], []
    for name, run in places.items():
        if direction == TELECOMMAND and name != id:
            entries.append(Entry(name, run, value=f"{_IN_COMMANDS.get(name, 0):0{-(-run.bits // 8) * 2}X}"))
            continue
        type_ = types.name(Type("Integer", run.bits, "unsigned", most_first(run.bits)), f"uint{run.bits}")
        rows.append(Row(name, type_))
        entries.append(Entry(name, run))
    return Head(id, sum(run.bits for run in places.values()), tuple(rows), tuple(entries))


def text(value: object) -> str:
    """A text in one line, without what XML cannot have."""
    return " ".join(_UNPRINTABLE.sub(" ", str(value)).split())
