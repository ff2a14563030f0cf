"""Multiplexed messages: messages of one direction that share an id, and the constants
that distinguish them.

Two messages are distinguishable if they have no common length, or different constants
at the same position. They are also distinguishable if one has all constants of the
other and more. That one is the narrower message: a frame that has its constants belongs
to it, and other frames belong to the more general message.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from icdgen.frozen import NamedTuple
from icdgen.icd.frames import FrameField, fixed_fields
from icdgen.icd.model import TELECOMMAND, TELEMETRY, Icd, Message, Node
from icdgen.icd.pieces import bits_of

DeclaredMessage = tuple[Message, Node]  # a message and the node that declares it
# Bit of the frame for each bit of a value; bit w (0: least significant) of byte b is 8
# * b + w.
BitPositions = tuple[int, ...]


class Variant(NamedTuple):
    """A message of an id, with the constants that distinguish it from the other
    messages of the id.
    """

    message: Message
    node: Node  # the node that declares the message
    # Without constants that all messages of the id have in common.
    constants: tuple[FrameField, ...] = ()


class Ids(NamedTuple):
    """Messages of a node by id, for each direction."""

    telecommand: dict[int, tuple[Variant, ...]]
    telemetry: dict[int, tuple[Variant, ...]]


def ids_of(icd: Icd, node: Node) -> Ids:
    """Return the messages of a node by id, in the order in which a receiver compares a
    frame with them.
    """
    messages = [(message, icd.node(message.node)) for message in icd.messages_of(node)]
    return Ids(_grouped(messages, TELECOMMAND), _grouped(messages, TELEMETRY))


def _grouped(
    messages: Iterable[DeclaredMessage], direction: str
) -> dict[int, tuple[Variant, ...]]:
    """Return the messages with an id in a direction, by id."""
    groups: dict[int, list[DeclaredMessage]] = {}
    for message, node in messages:
        id = getattr(message, f"{direction}_id")
        if id is not None:
            groups.setdefault(id, []).append((message, node))
    return {id: variants(group) for id, group in groups.items()}


def variants(messages: Sequence[DeclaredMessage]) -> tuple[Variant, ...]:
    """Return the messages of an id, narrower messages before more general ones."""
    if len(messages) == 1:
        return (Variant(*messages[0]),)
    values = [_constants(message, node) for message, node in messages]
    common = set(values[0].items()).intersection(*(own.items() for own in values[1:]))
    ranked = []
    for (message, node), own in zip(messages, values, strict=True):
        distinctive = {
            place for place, value in own.items() if (place, value) not in common
        }
        fields = (
            field
            for field in constants(message, node)
            if _bit_positions(field) in distinctive
        )
        ranked.append((len(own), Variant(message, node, tuple(fields))))
    # A narrower message has more constants. The sort is stable, so other messages stay
    # in the order of the ICD.
    return tuple(variant for _, variant in sorted(ranked, key=lambda entry: -entry[0]))


def are_distinguishable(first: DeclaredMessage, second: DeclaredMessage) -> bool:
    """Return whether no frame matches both messages, or one of them is narrower than
    the other.
    """
    if not _have_common_length(first, second):
        return True
    first_values, second_values = _constants(*first), _constants(*second)
    if any(
        second_values.get(place, value) != value
        for place, value in first_values.items()
    ):
        return True
    return is_narrower(first, second) or is_narrower(second, first)


def is_narrower(first: DeclaredMessage, second: DeclaredMessage) -> bool:
    """Return whether both messages can have a common length, and the first has all
    constants of the second and more.
    """
    return (
        _have_common_length(first, second)
        and _constants(*first).items() > _constants(*second).items()
    )


def constants(message: Message, node: Node) -> tuple[FrameField, ...]:
    """Return the constants that every frame has: not optional fields, and not fields of
    variable-length nodes.

    Trailing zeros that a frame omits count as part of it. `node` is the ICD node that
    declares the message.
    """
    return tuple(
        field
        for field in fixed_fields(message.layout, node.orders)
        if field.has_bits and field.const is not None and not field.conditions
    )


def common_length(group: Sequence[Variant]) -> int | None:
    """Return the fixed length that all messages of a group have in common; None if
    lengths differ.
    """
    layouts = [variant.message.layout for variant in group]
    lengths = {
        length for layout in layouts for length in (layout.shortest, layout.longest)
    }
    return lengths.pop() if len(lengths) == 1 else None


def _have_common_length(first: DeclaredMessage, second: DeclaredMessage) -> bool:
    """Return whether frames of two messages can have the same length."""
    return not set(first[0].layout.lengths).isdisjoint(second[0].layout.lengths)


def _constants(message: Message, node: Node) -> dict[BitPositions, int]:
    """Return the values of the constants of a message, by position."""
    return {
        _bit_positions(field): field.const or 0 for field in constants(message, node)
    }


def _bit_positions(field: FrameField) -> BitPositions:
    """Return the position of a field, equal for fields of different orders that have
    the same bits.
    """
    bits = bits_of(field.at, field.bits, field.byte_order, field.bit_order)
    return tuple(
        bits
        if field.bit_order == "lsb0"
        else (bit // 8 * 8 + 7 - bit % 8 for bit in bits)
    )
