"""Messages as the JavaScript codec wants them: which bits of which bytes, which scale. Plain data, ready for JSON.

Integers that a JavaScript number would not hold exactly are texts; the codec takes both.
"""

from __future__ import annotations

from fractions import Fraction

from icdgen import layout
from icdgen.icd.exact import terms
from icdgen.icd.model import Enum, Field, Limits, Message, Node

_EXACT = 1 << 53


def message_plan(message: Message, node: Node) -> dict[str, object]:
    """The plan of a message; ``node`` is the one that declares it. Fields stand in the order of the ICD."""
    return {
        "name": message.name,
        "length": message.length,
        "fields": [_field(field, node) for field in message.fields],
    }


def enum_plan(enum: Enum) -> list[list[object]]:
    """Value and name of each member."""
    return [[integer(member.value), member.name] for member in enum.members]


def integer(value: int) -> int | str:
    """The number, as text where a double would not hold it."""
    return value if -_EXACT < value < _EXACT else str(value)


def _field(field: Field, node: Node) -> dict[str, object]:
    plan: dict[str, object] = {"name": field.name, "type": field.type, "bits": field.bits}
    if field.type == "bytes":
        plan["first"] = field.at // 8
    else:
        plan["pieces"] = [[p.byte, p.shift, p.bits, p.at] for p in layout.pieces(field, node)]
    if field.scale is not None:
        plan["scale"] = [integer(term) for term in terms(field.scale)]
    if field.unit is not None:
        plan["unit"] = field.unit.symbol
    if field.enum is not None:
        plan["enum"] = field.enum.name
    if field.const is not None:
        plan["const"] = integer(field.const)
    if field.special:
        plan["special"] = [[integer(one.value), one.meaning] for one in field.special]
    if field.limits is not None:
        plan["limits"] = _limits(field.limits)
    return plan


def _limits(limits: Limits) -> dict[str, list[int | str]]:
    """Numerator and denominator of each bound."""
    bounds: dict[str, Fraction | None] = {key: getattr(limits, key) for key in ("min", "max", "above", "below")}
    return {key: [integer(b.numerator), integer(b.denominator)] for key, b in bounds.items() if b is not None}
