"""What an edit is, and what edits are made of."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import wraps

from icdgen.icd import layout_copies
from icdgen.icd.layout import Layout, Scalar
from icdgen.icd.model import Enum, Icd, Message, Node
from icdgen.naming import words


@dataclass(frozen=True)
class Edited:
    """``must`` are found, ``may`` possibly, and nothing else.

    ``at`` names the message or enumeration.
    """

    icd: Icd
    must: frozenset[str]
    may: frozenset[str]
    at: str = ""


Edit = Callable[[Icd, random.Random], "Edited | None"]
EDITS: dict[str, Edit] = {}
TEXT: list[str] = []  # edits of words only
BEYOND: list[
    str
] = []  # edits of what no message of the generated code shows: protocol facts, the log mask
STRANGE = "Zorkmid flux 7"


def edit(text: bool = False, beyond: bool = False) -> Callable[[Edit], Edit]:
    def register(function: Edit) -> Edit:
        name = function.__name__
        EDITS[name] = function
        if text:
            TEXT.append(name)
        if beyond:
            BEYOND.append(name)
        return function

    return register


def done(icd: Icd, at: str, *must: str, may: tuple[str, ...] = ()) -> Edited:
    return Edited(icd, frozenset(must), frozenset(may), at)


# Putting things in the place of others


def with_node(icd: Icd, old: Node, new: Node) -> Icd:
    return Icd(tuple(new if node is old else node for node in icd.nodes))


def with_message(icd: Icd, node: Node, old: Message, *new: Message) -> Icd:
    messages = [m for one in node.messages for m in (new if one is old else (one,))]
    return with_node(icd, node, replace(node, messages=tuple(messages)))


def with_layout(icd: Icd, node: Node, message: Message, layout: Layout) -> Icd:
    return with_message(icd, node, message, replace(message, layout=layout))


def with_fields(
    icd: Icd, node: Node, message: Message, fields: list[Scalar], **more: object
) -> Icd:
    """Puts other scalars in the place of those of a message, all other nodes stay;
    ``more`` is of the layout.
    """
    others = [one for one in message.layout.fixed if not isinstance(one, Scalar)]
    return with_layout(
        icd, node, message, replace(message.layout, fixed=(*fields, *others), **more)
    )


def with_field(icd: Icd, node: Node, message: Message, old: Scalar, new: Scalar) -> Icd:
    return with_layout(
        icd, node, message, layout_copies.with_node(message.layout, old, new)
    )


def with_enum(icd: Icd, old: Enum, new: Enum) -> Icd:
    def message(one: Message) -> Message:
        layout = layout_copies.with_enum(one.layout, old, new)
        return one if layout is one.layout else replace(one, layout=layout)

    return Icd(
        tuple(
            replace(
                node,
                enums=tuple(new if e is old else e for e in node.enums),
                messages=tuple(map(message, node.messages)),
            )
            for node in icd.nodes
        )
    )


def with_member(icd: Icd, enum: Enum, index: int, **values: object) -> Icd:
    members = list(enum.members)
    members[index] = replace(members[index], **values)
    return with_enum(icd, enum, replace(enum, members=tuple(members)))


# Choosing


def pick(rng: random.Random, items: Iterator | list):
    items = list(items)
    return rng.choice(items) if items else None


def scalars(message: Message) -> list[Scalar]:
    """The fields of a message that are no array, struct or overlay."""
    return [one for one in message.layout.fixed if isinstance(one, Scalar)]


def fields_of(
    icd: Icd, wanted: Callable[[Scalar], bool] = lambda f: True
) -> list[tuple[Node, Message, Scalar]]:
    return [
        (n, m, f)
        for n in icd.nodes
        for m in n.messages
        for f in scalars(m)
        if wanted(f)
    ]


def messages_of(
    icd: Icd, wanted: Callable[[Message], bool] = lambda m: True
) -> list[tuple[Node, Message]]:
    return [(n, m) for n in icd.nodes for m in n.messages if wanted(m)]


def members_of(icd: Icd) -> list[tuple[Enum, int]]:
    return [(e, i) for n in icd.nodes for e in n.enums for i in range(len(e.members))]


def is_plain(field: Scalar) -> bool:
    """A number without anything that depends on its range."""
    return (
        field.type in ("uint", "int")
        and field.const is None
        and not field.special
        and not field.limits
    )


def is_free(message: Message, name: str) -> bool:
    return all(
        words(f.name) != words(name) and f.name != name for f in message.layout.nodes
    )


def free_id(icd: Icd) -> int | None:
    taken = {number for node in icd.nodes for m in node.messages for number in m.ids}
    return next((number for number in range(250, 0, -1) if number not in taken), None)


# Edits of one thing, chosen at random


def on_field(
    wanted: Callable[[Scalar], bool] = lambda f: True, **kind: bool
) -> Callable[[Callable], Edit]:
    """Registers ``function(icd, rng, node, message, field)``."""
    return _on(lambda icd: fields_of(icd, wanted), kind)


def on_message(
    wanted: Callable[[Message], bool] = lambda m: True, **kind: bool
) -> Callable[[Callable], Edit]:
    """Registers ``function(icd, rng, node, message)``."""
    return _on(lambda icd: messages_of(icd, wanted), kind)


def _on(
    found: Callable[[Icd], list[tuple]], kind: dict[str, bool]
) -> Callable[[Callable], Edit]:
    def register(function: Callable) -> Edit:
        @wraps(function)
        def made(icd: Icd, rng: random.Random) -> Edited | None:
            one = pick(rng, found(icd))
            return None if one is None else function(icd, rng, *one)

        return edit(**kind)(made)

    return register
