"""Small ICDs cut out of the shipped ones with one edit each, so that one build contains
hundreds of edits.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, replace

from icdgen.icd.layout import scalar_of
from icdgen.icd.layout_copies import with_enum
from icdgen.icd.layout_nodes import walk
from icdgen.icd.model import Enum, Icd, Message, Node
from tests.diff.edits import BEYOND, EDITS

TRIES = 40  # messages that are tried before the next edit


@dataclass
class EditCase:
    """An edit of a small ICD. Both sides have the same node name, which the requests
    use.
    """

    name: str
    edit: str
    old: Icd
    new: Icd

    @property
    def node(self) -> Node:
        return self.new.nodes[0]


def cases(icd: Icd, count: int, seed: int) -> list[EditCase]:
    """Return ``count`` edits, each kind in turn, of messages chosen at random."""
    rng = random.Random(seed)
    kinds = [kind for kind in EDITS if kind not in BEYOND]
    messages = [(node, message) for node in icd.nodes for message in node.messages]
    drawn_cases: list[EditCase] = []
    while len(drawn_cases) < count:
        kind = kinds[len(drawn_cases) % len(kinds)]
        name = f"e{len(drawn_cases):05}"
        drawn_cases.append(next(_attempts(icd, kind, name, messages, rng)))
    return drawn_cases


def _attempts(
    icd: Icd,
    kind: str,
    name: str,
    messages: list[tuple[Node, Message]],
    rng: random.Random,
) -> Iterator[EditCase]:
    while True:
        node, message = rng.choice(messages)
        beside = [m for m in node.messages if m is not message]
        common = (
            (message, rng.choice(beside))
            if kind == "swap_ids" and beside
            else (message,)
        )
        old = piece(icd, node, common, name)
        done = EDITS[kind](old, rng)
        if done is not None:
            yield EditCase(name, kind, old, done.icd)


def piece(icd: Icd, node: Node, messages: tuple[Message, ...], name: str) -> Icd:
    """Return an ICD with a node of the given messages and the enumerations that they
    use.
    """
    enums: dict[int, Enum] = {}

    def own(message: Message) -> Message:
        layout = replace(message.layout, owner=name)
        for visit in walk(message.layout, node.orders):
            scalar = scalar_of(visit.node)
            if scalar is not None and scalar.enum is not None:
                enum = enums.setdefault(
                    id(scalar.enum), replace(scalar.enum, node=name)
                )
                layout = with_enum(layout, scalar.enum, enum)
        return replace(message, node=name, contains=(), layout=layout)

    own_messages = tuple(map(own, messages))
    cut = replace(
        node,
        name=name,
        messages=own_messages,
        enums=tuple(enums.values()),
        includes=(),
        loggable=(),
        missing=(),
        protocol={},
        errata=(),
        digest="0" * 64,
    )
    return Icd((cut,))
