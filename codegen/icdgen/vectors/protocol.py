"""Golden vectors of the protocol layer: requests and expected responses in the format
of the conformance tests.

The modules of ``wire`` yield the requests; `icdgen.runtime_objects.reference` answers
them with the Python runtime.
"""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from typing import Any

from icdgen import __version__
from icdgen.frozen import NamedTuple
from icdgen.icd.model import Icd, Node
from icdgen.protocol import facts
from icdgen.protocol.facts import Facts
from icdgen.runtime_objects import reference
from icdgen.runtime_objects.links import link_of_node
from icdgen.vectors.wire import (
    asking,
    clients,
    files,
    framed,
    i2c,
    logs,
    packets,
    procedures,
    streams,
    waits,
)

FORMAT = 1


class Case(NamedTuple):
    """Request with its expected response."""

    why: str
    request: dict[str, Any]
    answer: dict[str, Any]


def nodes(icd: Icd) -> list[Node]:
    """Return the nodes that have vectors: nodes with a protocol that no other node
    includes.
    """
    included = {name for node in icd.nodes for name in node.includes}
    return [
        node
        for node in icd.nodes
        if icd.protocol_of(node) and node.name not in included
    ]


def cases(icd: Icd, node: Node) -> list[Case]:
    """Return all cases of a node. The result is deterministic."""
    node_facts = facts.of(icd, node)
    cases = []
    for why, request in _requests(icd, node_facts):
        complete_request = {"op": request["op"], "node": node.name, **request}
        cases.append(
            Case(why, complete_request, reference.answer(icd, complete_request))
        )
    return cases


def protocol_vectors_text(icd: Icd) -> str | None:
    """Return the vector file, one case per line; None if no node has a protocol."""
    parts = []
    for node in nodes(icd):
        lines = [
            json.dumps(case._asdict(), separators=(",", ":"))
            for case in cases(icd, node)
        ]
        head = f'{{"node": {json.dumps(node.name)}, "digest": "{node.digest[:16]}", "cases": [\n'
        parts.append(head + ",\n".join(lines) + "\n]}")
    if not parts:
        return None
    head = f'"icdgen_protocol": {FORMAT},\n"generator": "icdgen {__version__}",\n"nodes": [\n'
    return "{\n" + head + ",\n".join(parts) + "\n]\n}\n"


def _requests(icd: Icd, node_facts: Facts) -> Iterator[tuple[str, dict[str, Any]]]:
    # Shared: an additional request changes the random bytes of those after it. Scripts
    # of clients and procedures have sources of their own.
    source = random.Random(node_facts.node.name)
    yield "facts that nothing but a user's own code reads", {"op": "link_data"}
    link = link_of_node(icd, node_facts.node)
    if node_facts.stream:
        yield from framed.requests(link, node_facts.stream, source)
        yield from asking.scripts(link, node_facts)
        yield from procedures.scripts(link, node_facts)
        yield from streams.checksums(node_facts, source)
        return
    yield from streams.checksums(node_facts, source)
    if node_facts.framing:
        yield from streams.encoded(link, node_facts, source)
        yield from streams.streams(link, node_facts, source)
    if node_facts.can:
        yield from packets.requests(link, node_facts, source)
    yield from i2c.requests(link, node_facts, source)
    yield from logs.requests(link, node_facts, source)
    yield from files.requests(link, node_facts, source)
    yield from clients.scripts(link, node_facts)
    yield from procedures.scripts(link, node_facts)
    yield from waits.scripts(link, node_facts)
