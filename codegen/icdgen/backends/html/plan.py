"""Messages as the JavaScript codec wants them: which bits of which bytes, which scale. Plain data, ready for JSON.

Integers that a JavaScript number would not hold exactly are texts; the codec takes both.
"""

from __future__ import annotations

from icdgen import layout
from icdgen.describe.bounds import bounds
from icdgen.describe.steps import EXACT_DOUBLE, steps
from icdgen.icd.model import Enum, Field, Message, Node


def message_plan(message: Message, node: Node) -> dict[str, object]:
    """The plan of a message; ``node`` is the one that declares it. Fields stand in the order of the ICD."""
    fields = [_field(field, node) for field in message.fields]
    plan: dict[str, object] = {"name": message.name, "length": message.length, "fields": fields}
    places = {field.name: place for place, field in enumerate(message.fields)}
    if message.has_conditions:
        plan["conditional"] = True
    for field, row in zip(message.fields, fields, strict=True):
        if field.when:
            row["when"] = [[places[one.field], list(map(integer, one.values))] for one in field.when]
        if field.derived is not None:
            how = field.derived
            row["derived"] = [
                [places[name] for name in how.fields],
                list(how.numbers),
                [list(step) for step in how.steps],
            ]
    if message.may_end_early:
        plan["endsEarly"] = True
    if message.inner:
        plan["inner"] = [
            {"counter": places[one.counter], "begin": one.begin, "step": one.step, "most": one.most, "plus": one.plus}
            for one in message.inner
        ]
        plan["fewest"] = message.least
        names = {one.name for one in message.inner}
        for field, own in zip(message.fields, fields, strict=True):
            if field.path and field.path[0].name in names:
                own["inner"] = True  # a new message has it, though it is not sent
    if message.tail is not None:
        tail = message.tail
        plan["tail"] = {
            "part": tail.name, "counter": tail.counter, "least": message.begin, "step": tail.step, "most": tail.most,
            **({"plus": tail.plus} if tail.plus else {}),
        }  # fmt: skip
        for field, own in zip(message.fields, fields, strict=True):
            if field.name == tail.name:
                own["isOpen"] = True  # bytes or text, which a frame holds in part
    return plan


def enum_plan(enum: Enum) -> list[list[object]]:
    """Value and name of each member, and of a range its last value."""
    return [[*map(integer, (m.value,)), m.name, *([] if m.to is None else [integer(m.to)])] for m in enum.members]


def integer(value: int) -> int | str:
    """The number, as text where a double would not hold it."""
    return value if abs(value) < EXACT_DOUBLE else str(value)


def _field(field: Field, node: Node) -> dict[str, object]:
    plan: dict[str, object] = {"name": field.name, "type": field.type, "bits": field.bits}
    if field.signed:
        plan["signed"] = True
    if field.view:
        plan["view"] = True
    if field.implied:
        plan["implied"] = True
        plan["pieces"] = []
    elif field.is_bytes:
        plan["type"] = "bytes"
        if field.type == "text":
            plan["text"] = True
        plan["first"] = field.at // 8
    else:
        plan["pieces"] = [[p.byte, p.shift, p.bits, p.at] for p in layout.pieces(field, node)]
    scaled = steps(field)
    if scaled is not None:
        plan["scale"] = [integer(term) for term in scaled.terms]
    if field.curve is not None:
        plan["curve"] = [[start, list(terms)] for start, terms in field.curve.pieces]
        if not field.leads_back:
            plan["oneWay"] = True
        elif field.ends != (field.raw_min, field.raw_max):
            plan["ends"] = list(field.ends)
    if field.unit is not None:
        plan["unit"] = field.unit.symbol
    if field.enum is not None:
        plan["enum"] = field.enum.name
    if field.const is not None:
        plan["const"] = integer(field.const)
    if field.special:
        plan["special"] = [[integer(one.value), one.meaning] for one in field.special]  # bits of floats
    limits = bounds(field.limits)
    if limits:  # numerator and denominator of each
        plan["limits"] = {one.key: [integer(one.value.numerator), integer(one.value.denominator)] for one in limits}
    return plan
