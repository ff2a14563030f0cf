"""Decoding and encoding single messages with the reference codec: ``icdgen decode`` and ``icdgen encode``."""

from __future__ import annotations

import shlex

from icdgen import codec
from icdgen.icd.model import Icd
from icdgen.values.encode import encode
from icdgen.values.errors import Ambiguous, BadHex, BadLength, BadValue, NotFound
from icdgen.values.find import KINDS, find_field, find_frame, find_message, find_named, find_node
from icdgen.values.frame import Frame, Row, frame
from icdgen.values.hexadecimal import parse_hex
from icdgen.values.text import to_text

__all__ = [
    "KINDS", "Ambiguous", "BadHex", "BadLength", "BadValue", "Frame", "NotFound", "Row",
    "decode", "encode", "find_field", "find_frame", "find_message", "find_named", "find_node", "parse_hex", "to_text",
]  # fmt: skip


def decode(icd: Icd, node_name: str, key: str, data: bytes, kind: str | None = None) -> Frame:
    """What the bytes of a message say. Raises `NotFound`, `Ambiguous`, `BadLength`."""
    node = find_node(icd, node_name)
    message = find_message(icd, node_name, key, kind)
    try:
        return frame(icd, node, message, data)
    except codec.LengthError as error:
        help = f"`icdgen show {node.name} {shlex.quote(message.name)}` shows what it holds"
        if error.actual == error.expected + 1 and data[0] in message.ids:
            help = "the bytes begin with the id: leave it out"
        raise BadLength(str(error), error.expected, error.actual, help) from None
