"""Keeps what was found out about a node: recognizing frames and answering requests ask for it thousands of times."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from icdgen.icd.model import Icd, Node

Known = TypeVar("Known")


def kept(find: Callable[[Icd, Node], Known]) -> Callable[[Icd, Node], Known]:
    """``find``, which is called once for each node of the ICD that was asked about last. Objects count, not their values."""
    last: list[Icd] = []
    known: dict[int, tuple[Node, Known]] = {}

    @wraps(find)
    def look_up(icd: Icd, node: Node) -> Known:
        if not last or last[0] is not icd:
            last[:] = [icd]
            known.clear()
        if id(node) not in known:
            known[id(node)] = (node, find(icd, node))  # with the node: while it is kept, no other has its id
        return known[id(node)][1]

    return look_up
