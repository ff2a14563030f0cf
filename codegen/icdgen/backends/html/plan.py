"""Messages as the JavaScript codec wants them: which bits of which bytes, which scale. Plain data, ready for JSON.

Integers that a JavaScript number would not hold exactly are texts; the codec takes both.
"""

from __future__ import annotations

from collections.abc import Mapping

from icdgen import layout
from icdgen.describe.bounds import bounds
from icdgen.describe.display import base_of, digits_of
from icdgen.describe.steps import EXACT_DOUBLE, steps
from icdgen.icd.model import Enum, Message, Node
from icdgen.icd.places import NodePlace, scalars_in


def message_plan(message: Message, node: Node) -> dict[str, object]:
    """The plan of a message; ``node`` is the one that declares it. Fields stand in the order of the ICD."""
    places = {field.name: place for place, field in enumerate(scalars_in(message.layout))}
    fields = [_field(field, message, node, places) for field in scalars_in(message.layout)]
    plan: dict[str, object] = {"name": message.name, "length": message.length, "fields": fields}
    if any(node.present_if for node in message.layout.fixed):
        plan["conditional"] = True
    if message.may_end_early:
        plan["endsEarly"] = True
    parts = message.layout.parts
    if len(parts) > 1:
        plan["inner"] = [
            {"counter": places[one.counter], "begin": one.begin, "step": one.step, "most": one.most, "plus": one.plus}
            for one in parts[:-1]
        ]
        plan["fewest"] = message.layout.shortest
    if parts:
        tail = parts[-1]
        plan["tail"] = {
            "part": tail.name, "counter": tail.counter, "least": tail.begin, "step": tail.step, "most": tail.most,
            **({"plus": tail.plus} if tail.plus else {}),
        }  # fmt: skip
    return plan


def enum_plan(enum: Enum) -> list[list[object]]:
    """Value and name of each member, and of a range its last value."""
    return [[integer(m.value), m.name, *([] if m.to is None else [integer(m.to)])] for m in enum.members]


def integer(value: int) -> int | str:
    """The number, as text where a double would not hold it."""
    return value if abs(value) < EXACT_DOUBLE else str(value)


def _field(field: NodePlace, message: Message, node: Node, places: Mapping[str, int]) -> dict[str, object]:
    """The plan of a field; what does not apply is left out. ``places``: of the message's fields by name."""
    scaled, curve, how = steps(field), field.curve, field.derived
    variable = message.layout.sequence
    digits, base = digits_of(field), base_of(field)
    pieces = () if field.is_count or field.is_bytes else layout.pieces(field, node)
    is_part = bool(curve) and field.is_invertible and field.settable_raws != (field.raw_min, field.raw_max)
    limits = {one.key: [integer(one.value.numerator), integer(one.value.denominator)] for one in bounds(field.limits)}
    plan: dict[str, object] = {
        "name": field.name,
        "type": "bytes" if field.is_bytes else field.type,
        "bits": field.bits,
        "signed": field.is_signed,
        "view": field.view,
        "implied": field.is_count,
        "text": field.type == "text",
        "first": field.at // 8 if field.is_bytes else None,
        "pieces": None if field.is_bytes else [[p.byte, p.shift, p.bits, p.at] for p in pieces],
        "scale": [integer(term) for term in scaled.terms] if scaled else None,
        "curve": [[start, list(terms)] for start, terms in curve.pieces] if curve else None,
        "oneWay": curve is not None and not field.is_invertible,
        "decimals": digits.decimals if digits else None,
        "digits": digits.significant if digits else None,
        "fixed": digits is not None and digits.is_fixed,
        "base": list(base) if base else None,
        "ends": list(field.settable_raws) if is_part else None,
        "unit": field.unit_symbol or None,
        "enum": field.enum.name if field.enum else None,
        "const": None if field.const is None else integer(field.const),
        "special": [[integer(one.value), one.meaning] for one in field.special] or None,  # bits of floats
        "limits": limits or None,  # numerator and denominator of each
        "when": [[places[one.field], list(map(integer, one.values))] for one in field.when] or None,
        "derived": (
            [[places[one] for one in how.fields], list(how.numbers), list(map(list, how.steps))] if how else None
        ),
        # a new message has it, though it is not sent
        "inner": field.name != field.steps[0].node.name and any(field.steps[0].node is part for part in variable[:-1]),
        # bytes or text, which a frame holds in part
        "isOpen": bool(variable) and field.is_bytes and field.scalar.length is not None and field.node is variable[-1],
    }
    return {key: value for key, value in plan.items() if value is not None and value is not False}
