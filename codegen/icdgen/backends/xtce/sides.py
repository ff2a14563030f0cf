"""Content of one direction of a node for the template: header and messages.

`direction_content` builds the containers of all messages, and removes telecommands that
XTCE cannot represent completely.
"""

from __future__ import annotations

import re
from typing import Any

from icdgen.backends.xtce.frames import (
    BaseContainer,
    ContainerBuilder,
    ContainerEntry,
    MessageContainer,
    XtceParameter,
)
from icdgen.backends.xtce.places import BitRun
from icdgen.backends.xtce.types import GeneratedType, TypeBuilder, most_first
from icdgen.describe import NodeDescription
from icdgen.frozen import NamedTuple
from icdgen.icd.model import TELECOMMAND, Icd

_UNPRINTABLE = re.compile("[^ -~\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]+")


_PACKET = {
    "Version": BitRun(0, 3), "Type": BitRun(3, 1), "SecondaryHeader": BitRun(4, 1), "Apid": BitRun(5, 11),
    "SequenceFlags": BitRun(16, 2), "SequenceCount": BitRun(18, 14), "Length": BitRun(32, 16),
}  # fmt: skip
# Other fields are 0; the sender sets counter and length
_IN_COMMANDS = {"Type": 1, "SequenceFlags": 3}


class Head(NamedTuple):
    """Header of a space packet, or only the id.

    ``id``: name of the parameter or argument that identifies a message.
    """

    id: str
    bits: int
    rows: tuple[XtceParameter, ...]
    entries: tuple[ContainerEntry, ...]


class DirectionContent(NamedTuple):
    """Telemetry or telecommands of a file."""

    types: dict[str, GeneratedType]  # by name
    head: Head
    rows: list[XtceParameter]  # parameters; arguments belong to their commands
    frames: list[MessageContainer]
    bases: list[BaseContainer]  # of frames that share an id
    notes: list[str]


def direction_content(
    icd: Icd, node: NodeDescription, direction: str
) -> DirectionContent | None:
    """Return the content of a direction; None if the node has no messages in it."""
    messages = {each.kind: each.messages for each in node.directions}.get(direction)
    if not messages:
        return None
    types = TypeBuilder()
    ids = [id for described in node.all_messages for id in described.model.ids]
    id_bits = max(node.model.id_bits, *(id.bit_length() for id in ids))
    head = _head(id_bits, icd.protocol_of(node.model), direction, types)
    shared = {}  # shared id -> bytes that all its frames have
    for entry in node.ids(direction):
        if entry.is_shared:
            layouts = (each.message.model.layout for each in entry.messages)
            shared[entry.id] = min(layout.shortest for layout in layouts)
    maker = ContainerBuilder(
        direction,
        types,
        head.bits,
        shared=shared,
        # The template declares these containers itself.
        taken={"TelemetryFrame", "TelecommandFrame"},
    )
    frames = [maker.frame(message) for message, _ in messages]
    notes = [
        f"{direction} `{frame.message.model.name}`: {note}"
        for frame in frames
        for note in (*frame.lacks, *frame.notes)
    ]
    if direction == TELECOMMAND:
        notes += [
            f"{direction} `{frame.message.model.name}` is left out"
            for frame in frames
            if frame.lacks
        ]
        frames = [frame for frame in frames if not frame.lacks]
    rows = [
        *head.rows,
        *maker.reserved.values(),
        *(row for frame in frames for row in frame.rows),
    ]
    named = {name: type_ for type_, name in types.names.items()}
    return DirectionContent(
        named, head, rows, frames, list(maker.bases.values()), notes
    )


def _head(
    id_bits: int, protocol: dict[str, Any], direction: str, types: TypeBuilder
) -> Head:
    """Return the header of all messages of a direction."""
    header = protocol.get("link", {}).get("header", ())
    # The header of CCSDS 133.0-B-2 is recognized by the positions of its fields.
    is_packet = [(row.get("at"), row.get("bits")) for row in header] == [
        run[:2] for run in _PACKET.values()
    ]
    places = _PACKET if is_packet else {"Id": BitRun(0, -(-id_bits // 8) * 8)}
    id = "Apid" if is_packet else "Id"
    rows, entries = [], []
    for name, run in places.items():
        if direction == TELECOMMAND and name != id:
            entries.append(
                ContainerEntry(
                    name,
                    run,
                    value=f"{_IN_COMMANDS.get(name, 0):0{-(-run.bits // 8) * 2}X}",
                )
            )
            continue
        type_ = types.name_of_type(
            GeneratedType("Integer", run.bits, "unsigned", most_first(run.bits)),
            f"uint{run.bits}",
        )
        rows.append(XtceParameter(name, type_))
        entries.append(ContainerEntry(name, run))
    return Head(
        id, sum(run.bits for run in places.values()), tuple(rows), tuple(entries)
    )


def xml_text(value: object) -> str:
    """Return a text as one line without characters that XML does not permit."""
    return " ".join(_UNPRINTABLE.sub(" ", str(value)).split())
