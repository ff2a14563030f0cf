"""Compares the meaning of a changed message with that of the unchanged one."""

from __future__ import annotations

from icdgen import codec
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace


def is_same_meaning(
    node: Node, message: Message, other_node: Node, other: Message
) -> bool:
    """Return whether the reference codec handles every bit alike, and all other facts
    from which code is generated are equal.
    """
    return _facts(node, message) == _facts(other_node, other)


def _facts(node: Node, message: Message) -> tuple:
    fields = [
        (
            f.name, f.type, f.bits, f.is_read_only, f.derived and f.derived.sense({}), _place(node, f), f.scale, f.curve, f.const,
            f.special, f.limits, f.conditions, tuple((m.value, m.to, m.name) for m in f.enum.members) if f.enum else None,
        )
        for f in message.fields
    ]  # fmt: skip
    parts = [
        (part.name, part.counter, part.step, part.most, part.plus)
        for part in message.layout.counted_parts
    ]
    return (
        message.name,
        message.kind,
        message.ids,
        message.length,
        parts,
        message.may_end_early,
        fields,
    )


def _place(node: Node, field: NodePlace) -> object:
    """Return the position of each bit of a field; of a variable-length field its
    position.
    """
    if field.is_bytes or field.is_count:
        return field.at
    orders = field.orders_in_effect(node.orders)
    return codec._runs(field.at, field.bits, orders.byte, orders.bit)
