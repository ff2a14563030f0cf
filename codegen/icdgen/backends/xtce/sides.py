"""All that a node speaks in one direction, ready for the template."""

from __future__ import annotations

import re
from typing import NamedTuple

from icdgen.backends.xtce.frames import Base, Frame, Frames, Row
from icdgen.backends.xtce.heads import Head, head_of
from icdgen.backends.xtce.types import Type, Types
from icdgen.describe import NodeDescription
from icdgen.icd.model import TELECOMMAND, Icd

_UNPRINTABLE = re.compile("[^ -~\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]+")


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
    id_bits = max(node.model.id_bits, *(id.bit_length() for one in node.spoken for id in one.model.ids))
    head = head_of(id_bits, icd.protocol_of(node.model), direction, types)
    shared = {
        one.id: min(among.message.model.least for among in one.candidates)
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


def text(value: object) -> str:
    """A text in one line, without what XML cannot have."""
    return " ".join(_UNPRINTABLE.sub(" ", str(value)).split())
