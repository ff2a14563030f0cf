"""Small ICDs cut out of the shipped ones, one edit each: so hundreds of edits are nodes
of one build.
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

TRIES = 40  # pieces that are tried for an edit before another edit is taken


@dataclass
class Case:
    """An edit of a small ICD.

    Both sides have the same node name, by which the build is asked.
    """

    name: str
    edit: str
    old: Icd
    new: Icd

    @property
    def node(self) -> Node:
        return self.new.nodes[0]


def cases(icd: Icd, count: int, seed: int) -> list[Case]:
    """So many edits, each kind in turn, of messages chosen at random."""
    rng = random.Random(seed)
    kinds = [kind for kind in EDITS if kind not in BEYOND]
    messages = [(node, message) for node in icd.nodes for message in node.messages]
    found: list[Case] = []
    while len(found) < count:
        kind = kinds[len(found) % len(kinds)]
        name = f"e{len(found):05}"
        found.append(next(_attempts(icd, kind, name, messages, rng)))
    return found


def _attempts(
    icd: Icd,
    kind: str,
    name: str,
    messages: list[tuple[Node, Message]],
    rng: random.Random,
) -> Iterator[Case]:
    while True:
        node, message = rng.choice(messages)
        beside = [m for m in node.messages if m is not message]
        both = (
            (message, rng.choice(beside))
            if kind == "swap_ids" and beside
            else (message,)
        )
        old = piece(icd, node, both, name)
        done = EDITS[kind](old, rng)
        if done is not None:
            yield Case(name, kind, old, done.icd)


def piece(icd: Icd, node: Node, messages: tuple[Message, ...], name: str) -> Icd:
    """The messages and the enumerations that they use, as a node of their own."""
    made: dict[int, Enum] = {}

    def own(message: Message) -> Message:
        layout = replace(message.layout, owner=name)
        for visit in walk(message.layout, node.orders):
            scalar = scalar_of(visit.node)
            if scalar is not None and scalar.enum is not None:
                enum = made.setdefault(id(scalar.enum), replace(scalar.enum, node=name))
                layout = with_enum(layout, scalar.enum, enum)
        return replace(message, node=name, contains=(), layout=layout)

    own_messages = tuple(map(own, messages))
    cut = replace(
        node,
        name=name,
        messages=own_messages,
        enums=tuple(made.values()),
        includes=(),
        loggable=(),
        missing=(),
        protocol={},
        errata=(),
        digest="0" * 64,
    )
    return Icd((cut,))
