"""Decode bytes of a named message."""

from __future__ import annotations

from icdgen.icd.model import Icd
from icdgen.values.find import find_message, find_node
from icdgen.values.frame import DecodedFrame, decoded_frame


def decode(icd: Icd, node: str, key: str, data: bytes) -> DecodedFrame:
    """Return the decoded frame of a message."""
    return decoded_frame(icd, find_node(icd, node), find_message(icd, node, key), data)
