"""The result type of edits, and functions that edits are built from."""

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
    """An edited set of ICDs. The diff must report the codes in ``must``, may report the
    codes in ``may``, and no others. ``at`` names the message or enumeration.
    """

    icd: Icd
    must: frozenset[str]
    may: frozenset[str]
    at: str = ""


Edit = Callable[[Icd, random.Random], "Edited | None"]
EDITS: dict[str, Edit] = {}
TEXT: list[str] = []  # edits of texts only
# Edits outside messages: protocol facts, the log mask.
BEYOND: list[str] = []
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


# Replacing objects


def with_node(icd: Icd, old: Node, new: Node) -> Icd:
    return Icd(tuple(new if node is old else node for node in icd.nodes))


def with_message(icd: Icd, node: Node, old: Message, *new: Message) -> Icd:
    messages = [
        m for message in node.messages for m in (new if message is old else (message,))
    ]
    return with_node(icd, node, replace(node, messages=tuple(messages)))


def with_layout(icd: Icd, node: Node, message: Message, layout: Layout) -> Icd:
    return with_message(icd, node, message, replace(message, layout=layout))


def with_fields(
    icd: Icd, node: Node, message: Message, fields: list[Scalar], **more: object
) -> Icd:
    """Replace the scalars of a message. Other nodes stay unchanged; ``more`` are
    changes of the layout.
    """
    unchanged = [
        field for field in message.layout.fixed if not isinstance(field, Scalar)
    ]
    return with_layout(
        icd, node, message, replace(message.layout, fixed=(*fields, *unchanged), **more)
    )


def with_field(icd: Icd, node: Node, message: Message, old: Scalar, new: Scalar) -> Icd:
    return with_layout(
        icd, node, message, layout_copies.with_node(message.layout, old, new)
    )


def with_enum(icd: Icd, old: Enum, new: Enum) -> Icd:
    def message(candidate: Message) -> Message:
        layout = layout_copies.with_enum(candidate.layout, old, new)
        return (
            candidate
            if layout is candidate.layout
            else replace(candidate, layout=layout)
        )

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


# Choosing objects


def pick(rng: random.Random, items: Iterator | list):
    items = list(items)
    return rng.choice(items) if items else None


def scalars(message: Message) -> list[Scalar]:
    """Return the fields of a message except arrays, structs and overlay fields."""
    return [field for field in message.layout.fixed if isinstance(field, Scalar)]


def fields_of(
    icd: Icd, wanted: Callable[[Scalar], bool] = lambda f: True
) -> list[tuple[Node, Message, Scalar]]:
    fields = []
    for node in icd.nodes:
        for message in node.messages:
            fields += [(node, message, f) for f in scalars(message) if wanted(f)]
    return fields


def messages_of(
    icd: Icd, wanted: Callable[[Message], bool] = lambda m: True
) -> list[tuple[Node, Message]]:
    return [(n, m) for n in icd.nodes for m in n.messages if wanted(m)]


def members_of(icd: Icd) -> list[tuple[Enum, int]]:
    return [(e, i) for n in icd.nodes for e in n.enums for i in range(len(e.members))]


def is_plain(field: Scalar) -> bool:
    """Return whether a field is a number whose range no other property depends on."""
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
    used = {number for node in icd.nodes for m in node.messages for number in m.ids}
    return next((number for number in range(250, 0, -1) if number not in used), None)


# Edits of one object, chosen at random


def on_field(
    wanted: Callable[[Scalar], bool] = lambda f: True, **kind: bool
) -> Callable[[Callable], Edit]:
    """Register ``function(icd, rng, node, message, field)``."""
    return _on(lambda icd: fields_of(icd, wanted), kind)


def on_message(
    wanted: Callable[[Message], bool] = lambda m: True, **kind: bool
) -> Callable[[Callable], Edit]:
    """Register ``function(icd, rng, node, message)``."""
    return _on(lambda icd: messages_of(icd, wanted), kind)


def _on(
    candidates_of: Callable[[Icd], list[tuple]], kind: dict[str, bool]
) -> Callable[[Callable], Edit]:
    def register(function: Callable) -> Edit:
        @wraps(function)
        def edited(icd: Icd, rng: random.Random) -> Edited | None:
            choice = pick(rng, candidates_of(icd))
            return None if choice is None else function(icd, rng, *choice)

        return edit(**kind)(edited)

    return register
