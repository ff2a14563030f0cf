"""Cache of facts about a node, for functions that run for each frame of a log or of the
simulator.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from icdgen.icd.model import Icd, Node

Result = TypeVar("Result")


def cached_by_node(
    compute: Callable[[Icd, Node], Result],
) -> Callable[[Icd, Node], Result]:
    """Decorate a function of a node so that its results are cached for the nodes of the
    most recent ICD.

    ICDs and nodes are compared by identity: comparing or hashing a whole model would
    take longer than the function.
    """
    last: list[Icd] = []
    # id() of a node -> the node and the result. The reference to the node prevents the
    # reuse of its id().
    results: dict[int, tuple[Node, Result]] = {}

    @wraps(compute)
    def look_up(icd: Icd, node: Node) -> Result:
        if not last or last[0] is not icd:
            last[:] = [icd]
            results.clear()
        if id(node) not in results:
            results[id(node)] = (node, compute(icd, node))
        return results[id(node)][1]

    return look_up
