"""Bytes of a message that is named -> what they say."""

from __future__ import annotations

from icdgen.icd.model import Icd
from icdgen.values.find import find_message, find_node
from icdgen.values.frame import DecodedFrame, decoded_frame


def decode(icd: Icd, node: str, key: str, data: bytes) -> DecodedFrame:
    """What the bytes of a message say."""
    return decoded_frame(icd, find_node(icd, node), find_message(icd, node, key), data)
