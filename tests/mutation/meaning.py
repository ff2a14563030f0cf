"""Whether a changed message provably means the same as the unchanged one."""

from __future__ import annotations

from icdgen import codec
from icdgen.icd.model import Message, Node
from icdgen.icd.places import NodePlace


def same(node: Node, message: Message, other_node: Node, other: Message) -> bool:
    """Whether the reference codec reads and writes every bit alike, and everything else
    that code is made from is equal.
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
    """Where each of its bits lies; what only the end of a frame counts has none."""
    if field.is_bytes or field.is_count:
        return field.at
    orders = field.orders_in_effect(node.orders)
    return codec._runs(field.at, field.bits, orders.byte, orders.bit)
