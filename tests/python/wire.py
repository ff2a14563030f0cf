"""What tests of the wire layer share: the link of a node, the reference's facts of it,
and hypothesis strategies.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

from hypothesis import strategies as st

from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from tests.python import packages
from tests.python.packages import Package

NODE = "cubeacp"  # has all of the protocol


@cache
def known(node: str = NODE) -> Facts:
    """The reference's facts."""
    icd = packages.shipped()
    return facts.of(icd, icd.node(node))


def link(package: Package, node: str = NODE) -> Any:
    return package.module(node).LINK


# Bytes of which most mean something, so that streams are full of starts, ends and
# escapes.
MARKERS = st.sampled_from([0x1F, 0x1F, 0x1F, 0x7F, 0xFF, 0x00, 0x80, 0x92])
NOISE = st.lists(MARKERS, max_size=12).map(bytes) | st.binary(max_size=12)


def cut(data: bytes, places: list[int]) -> list[bytes]:
    """The pieces of a stream that is cut at these places."""
    edges = [0, *sorted(min(place, len(data)) for place in places), len(data)]
    return [data[a:b] for a, b in pairwise(edges)]
