"""What is around each message on the line: whether two releases have the same."""

from __future__ import annotations

import re
from dataclasses import astuple

from icdgen.icd.model import Icd, Node
from icdgen.protocol import facts

PART = re.compile(r"protocol\.stream(\.(header|trailer)(\.[^.]+)?)?")  # without which a message looks otherwise
FACT = re.compile(r"protocol\.stream\.(delimited_by|header|trailer)\b.*|protocol\.checksums\b.*")

Side = tuple[Icd, Node]


def has_envelope(side: Side) -> bool:
    """Whether messages of the node travel in envelopes."""
    return "stream" in (side[1].protocol or {})


def differ(old: Side, new: Side, direction: str) -> bool:
    """Whether no message of a direction that one side makes is one of the other's, whatever it holds."""
    return _form(*old, direction) != _form(*new, direction)


def _form(icd: Icd, node: Node, direction: str) -> object:
    """All that decides what is around the data of a message of ``direction``."""
    stream = facts.of(icd, node).stream
    assert stream is not None
    place = int(direction == "telemetry")
    fields = [(*astuple(one)[:-1], one.values[place] if one.role == "constant" else None) for one in stream.fields]
    check = None if stream.check is None else astuple(stream.check)
    return stream.delimited_by, stream.header_bytes, stream.trailer_bytes, stream.length_plus, fields, check
