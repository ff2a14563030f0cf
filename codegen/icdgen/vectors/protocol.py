"""The golden vectors of the protocol layer: questions in the form of the testee protocol, with their answers."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from typing import Any, NamedTuple

from icdgen import __version__
from icdgen.icd.model import Icd, Node
from icdgen.protocol import facts, ops
from icdgen.protocol.facts import Facts
from icdgen.vectors.wire import (
    asking,
    clients,
    envelopes,
    files,
    i2c,
    logs,
    operations,
    packets,
    procedures,
    streams,
    waits,
)

FORMAT = 1


class Case(NamedTuple):
    """One question, and the answer that is demanded."""

    why: str
    request: dict[str, Any]
    answer: dict[str, Any]


def nodes(icd: Icd) -> list[Node]:
    """The nodes that have vectors: those with a protocol, except what is only there to be included."""
    included = {name for node in icd.nodes for name in node.includes}
    return [node for node in icd.nodes if icd.protocol_of(node) and node.name not in included]


def cases(icd: Icd, node: Node) -> list[Case]:
    """All cases of a node. Deterministic."""
    known = facts.of(icd, node)
    found = []
    for why, request in _requests(known):
        asked = {"op": request["op"], "node": node.name, **request}
        found.append(Case(why, asked, ops.answer(icd, asked)))
    return found


def text(icd: Icd) -> str | None:
    """The file, one case a line; None where no node has a protocol."""
    parts = []
    for node in nodes(icd):
        lines = [json.dumps(case._asdict(), separators=(",", ":")) for case in cases(icd, node)]
        head = f'{{"node": {json.dumps(node.name)}, "digest": "{node.digest[:16]}", "cases": [\n'
        parts.append(head + ",\n".join(lines) + "\n]}")
    if not parts:
        return None
    head = f'"icdgen_protocol": {FORMAT},\n"generator": "icdgen {__version__}",\n"nodes": [\n'
    return "{\n" + head + ",\n".join(parts) + "\n]\n}\n"


def _requests(known: Facts) -> Iterator[tuple[str, dict[str, Any]]]:
    source = random.Random(known.node.name)
    yield "facts that nothing but a user's own code reads", {"op": "link_data"}
    if known.stream:
        yield from envelopes.requests(known, source)
        yield from asking.scripts(known)
        return
    yield from streams.checksums(known, source)
    if known.framing:
        yield from streams.encoded(known, source)
        yield from streams.streams(known, source)
    if known.can:
        yield from packets.requests(known, source)
    yield from i2c.requests(known, source)
    yield from logs.requests(known, source)
    yield from files.requests(known, source)
    yield from clients.scripts(known)
    yield from procedures.scripts(known)
    yield from operations.scripts(known)
    yield from waits.scripts(known)
