"""Messages of one direction that share an id: what tells a frame of one from those of the others.

They have no length in common, or differ in constants at the same place; or one has the constants of the other and more, and
the other, the general one, is what is left: it takes the frames that are none of the narrower ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from icdgen.icd.division import bits_of
from icdgen.icd.frames import FrameField, frame_fields
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Icd, Message, Node

Spoken = tuple[Message, Node]  # and the node that declares it
Place = tuple[int, ...]  # of each bit of a value the bit of the frame, counted from the least significant of each byte


class Variant(NamedTuple):
    """One of the messages that have an id, and the constants that a frame of it has and not every other of that id."""

    message: Message
    node: Node  # that declares it
    constants: tuple[FrameField, ...] = ()


class Ids(NamedTuple):
    """The messages that a node speaks, by their ids in each direction."""

    telecommand: dict[int, tuple[Variant, ...]]
    telemetry: dict[int, tuple[Variant, ...]]


def ids_of(icd: Icd, node: Node) -> Ids:
    """What the node speaks: of each id the messages, in the order in which a frame is tried with them."""
    spoken = [(message, icd.node(message.node)) for message in icd.messages_of(node)]
    return Ids(_grouped(spoken, TELECOMMAND), _grouped(spoken, TELEMETRY))


def _grouped(spoken: Iterable[Spoken], direction: str) -> dict[int, tuple[Variant, ...]]:
    found: dict[int, list[Spoken]] = {}
    for one in spoken:
        id = getattr(one[0], f"{direction}_id")
        if id is not None:
            found.setdefault(id, []).append(one)
    return {id: variants(those) for id, those in found.items()}


def variants(spoken: Sequence[Spoken]) -> tuple[Variant, ...]:
    """The messages of one id, the narrower ones before those that are more general."""
    if len(spoken) == 1:
        return (Variant(*spoken[0]),)
    known = [_constants(*one) for one in spoken]
    alike = set(known[0].items()).intersection(*(one.items() for one in known[1:]))
    made = []
    for (message, node), mine in zip(spoken, known, strict=True):
        telling = {place for place, value in mine.items() if (place, value) not in alike}
        fields = (field for field in constants(message, node) if _place(field) in telling)
        made.append((len(mine), Variant(message, node, tuple(fields))))
    return tuple(variant for _, variant in sorted(made, key=lambda one: -one[0]))


def are_told_apart(one: Spoken, other: Spoken) -> bool:
    """Whether every frame is of one of the two at most, or one of them is narrower than the other."""
    if not _meet(one, other):
        return True
    mine, its = _constants(*one), _constants(*other)
    if any(its.get(place, value) != value for place, value in mine.items()):
        return True
    return is_narrower(one, other) or is_narrower(other, one)


def is_narrower(one: Spoken, other: Spoken) -> bool:
    """Whether the first has lengths and all constants of the second, and more: a frame that holds these is of the first."""
    return _meet(one, other) and _constants(*one).items() > _constants(*other).items()


def constants(message: Message, node: Node) -> tuple[FrameField, ...]:
    """Return the fields that have the same value in every frame: no optional ones, and none of variable-length nodes.

    Zeros that a frame leaves out at its end count as part of it. `node` is the ICD node that declares the message.
    """
    end = 8 * message.layout.length
    fields = (field for field in frame_fields(message.layout, node.orders) if field.has_bits and field.at < end)
    return tuple(field for field in fields if field.const is not None and not field.conditions)


def common_length(group: Sequence[Variant]) -> int | None:
    """The length that all of them have: a frame of any other has the wrong length. None if they have several."""
    lengths = {length for one in group for length in (one.message.layout.shortest, one.message.layout.longest)}
    return lengths.pop() if len(lengths) == 1 else None


def _meet(one: Spoken, other: Spoken) -> bool:
    """Whether frames of the two can have the same length."""
    return not set(one[0].layout.lengths).isdisjoint(other[0].layout.lengths)


def _constants(message: Message, node: Node) -> dict[Place, int]:
    return {_place(field): field.const or 0 for field in constants(message, node)}


def _place(field: FrameField) -> Place:
    bits = bits_of(field.at, field.bits, field.byte_order, field.bit_order)
    return tuple(bits if field.bit_order == "lsb0" else (bit // 8 * 8 + 7 - bit % 8 for bit in bits))
