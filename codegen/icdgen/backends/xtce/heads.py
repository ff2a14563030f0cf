"""What stands before the data of a message: the header of a space packet, or the id alone."""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen.backends.xtce.frames import Entry, Row
from icdgen.backends.xtce.places import Run
from icdgen.backends.xtce.types import Type, Types
from icdgen.icd.model import TELECOMMAND

_PACKET = {
    "Version": Run(0, 3), "Type": Run(3, 1), "SecondaryHeader": Run(4, 1), "Apid": Run(5, 11),
    "SequenceFlags": Run(16, 2), "SequenceCount": Run(18, 14), "Length": Run(32, 16),
}  # fmt: skip
_IN_COMMANDS = {"Type": 1, "SequenceFlags": 3}  # the others are 0, until the link counts and measures


class Head(NamedTuple):
    """``id`` is the parameter, or the argument, that tells a message."""

    id: str
    bits: int
    rows: tuple[Row, ...]
    entries: tuple[Entry, ...]


def head_of(id_bits: int, protocol: dict[str, Any], direction: str, types: Types) -> Head:
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
        order = "mostSignificantByteFirst" if run.bits > 8 else ""
        type_ = types.name(Type("Integer", run.bits, "unsigned", order), f"uint{run.bits}")
        rows.append(Row(name, type_))
        entries.append(Entry(name, run))
    return Head(id, sum(run.bits for run in places.values()), tuple(rows), tuple(entries))
