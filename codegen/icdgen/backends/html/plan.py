"""Messages in the form of the JavaScript codec: positions of bits, and scales, as data
for JSON.

Integers that a JavaScript number cannot represent exactly are strings; the codec
accepts both.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from icdgen import frame_bits
from icdgen.describe.bounds import bounds_of_limits
from icdgen.describe.display import base_of, digits_of
from icdgen.describe.steps import EXACT_DOUBLE, steps_of_scale
from icdgen.icd.layout import Derived, Layout, VariablePart
from icdgen.icd.model import Enum, Message, Node
from icdgen.icd.places import NodePlace, places_in


def message_plan(
    message: Message, node: Node, represented: Collection[str] = ()
) -> dict[str, object]:
    """Return the data of a message; ``node`` declares it.

    Fields are in the order of the ICD. An array of elements of whole bytes is one item
    with the fields of its first element; `expanded` of the JavaScript codec lists all
    of them. ``represented``: names of the arrays that the page represents by one
    element.
    """
    # Conditions, counters and derived values name other fields. Fields have the index
    # that they have in the expanded list.
    in_frame = places_in(message.layout)
    places = dict(_indices(in_frame, 0, _needed_names(message.layout)))
    fields = _FieldPlans(message, node, places, represented).field_plans(in_frame, "")
    plan: dict[str, object] = {
        "name": message.name,
        "length": message.length,
        "fields": fields,
    }
    if any(node.present_if for node in message.layout.fixed):
        plan["conditional"] = True
    if message.may_end_early:
        plan["endsEarly"] = True
    parts = message.layout.parts
    if message.layout.has_inner_gaps:
        plan["inner"] = [
            _part_plan(part, places)
            for part in parts
            if part is not parts[-1] or part.inner
        ]
        plan["fewest"] = message.layout.shortest
    if parts:
        tail = parts[-1]
        plan["tail"] = {
            "part": tail.name, "counter": tail.counter, "least": tail.begin, "step": tail.step, "most": tail.most,
            **({"plus": tail.plus} if tail.plus else {}), **({"behind": tail.behind} if tail.behind else {}),
        }  # fmt: skip
    return plan


def _needed_names(layout: Layout) -> set[str]:
    """Return the names of the fields that count elements or that other fields depend
    on.
    """
    names = {part.counter for part in layout.counted_parts}
    for node in layout.nodes:
        names.update(condition.field for condition in node.present_if)
        if isinstance(node, Derived):
            names.update(node.derivation.fields)
    return names


def _indices(
    places: Iterable[NodePlace], index: int, names: set[str]
) -> Iterator[tuple[str, int]]:
    """Yield each of these names among the scalars of places, with its index; ``index``
    is that of the first scalar.
    """
    for place in places:
        # Few formulas name an element: `Levels[2]`.
        is_named = not place.count or any(
            name.startswith(f"{place.name}[") for name in names
        )
        for number, element in enumerate(place.elements() if is_named else ()):
            first = index + number * element.scalar_count
            if element.struct is not None:
                yield from _indices(element.inner(), first, names)
            elif element.name in names:
                yield element.name, first
        index += place.scalar_count


def _part_plan(part: VariablePart, places: Mapping[str, int]) -> dict[str, object]:
    """Return the data of a part after which a frame differs from the longest frame."""
    plan: dict[str, object] = {
        "counter": places[part.counter],
        "begin": part.begin,
        "step": part.step,
        "most": part.most,
        "plus": part.plus,
    }
    return plan | (
        {"nested": [_part_plan(inner, places) for inner in part.inner]}
        if part.inner
        else {}
    )


def enum_plan(enum: Enum) -> list[list[object]]:
    """Return value and name of each member, and the last value of a range."""
    return [
        [integer(m.value), m.name, *([] if m.to is None else [integer(m.to)])]
        for m in enum.members
    ]


def integer(value: int) -> int | str:
    """Return the number, as text if a double cannot represent it exactly."""
    return value if abs(value) < EXACT_DOUBLE else str(value)


class _FieldPlans:
    """Data of the fields of a message.

    ``places``: indices by name of the fields that other fields depend on.
    """

    def __init__(
        self,
        message: Message,
        node: Node,
        places: Mapping[str, int],
        represented: Collection[str],
    ) -> None:
        self._node, self._places = node, places
        self._represented = represented
        self._parts = message.layout.parts

    def field_plans(
        self, places: Iterable[NodePlace], prefix: str
    ) -> list[dict[str, object]]:
        """Return the data of fields and arrays, with names without ``prefix``."""
        items: list[dict[str, object]] = []
        for place in places:
            # Elements of an array that are not whole bytes begin at different bits of a
            # byte, so each has pieces of its own.
            if place.count > 1 and place.bits % 8 == 0:
                items.append(self._array_plan(place, prefix))
                continue
            for element in place.elements():
                if element.struct is None:
                    items.append(
                        self._field_plan(element, element.name.removeprefix(prefix))
                    )
                else:
                    items += self.field_plans(element.inner(), prefix)
        return items

    def _array_plan(self, place: NodePlace, prefix: str) -> dict[str, object]:
        """Return the data of an array; its fields have names within their element, an
        element without struct none.
        """
        first = place.first_element
        array: dict[str, object] = {
            "array": place.name.removeprefix(prefix),
            "count": place.count,
            "step": place.bits // 8,
            "fields": (
                [self._field_plan(first, "")]
                if first.struct is None
                else self.field_plans(first.inner(), f"{first.name}.")
            ),
        }
        part = next((part for part in self._parts if part.node is place.node), None)
        if part is not None and part.inner and part.fewest:
            # A new message stores these elements, although its part has no others.
            array["initial"] = part.fewest
        if place.name in self._represented:
            array["isShownOnce"] = True
        return array

    def _field_plan(self, field: NodePlace, name: str) -> dict[str, object]:
        """Return the data of a field without inapplicable keys."""
        node, places, variable = self._node, self._places, self._parts
        scaled, curve, how = steps_of_scale(field), field.curve, field.derived
        earlier = [part.node for part in variable[:-1]]
        digits, base = digits_of(field), base_of(field)
        pieces = (
            () if field.is_count or field.is_bytes else frame_bits.pieces(field, node)
        )
        # A lookup table may cover only a part of the raw range.
        is_part = (
            bool(curve)
            and field.is_invertible
            and field.settable_raws != (field.raw_min, field.raw_max)
        )
        limits = {
            bound.key: [
                integer(bound.value.numerator),
                integer(bound.value.denominator),
            ]
            for bound in bounds_of_limits(field.limits)
        }
        plan: dict[str, object] = {
            "name": name,
            "type": "bytes" if field.is_bytes else field.type,
            "bits": field.bits,
            "signed": field.is_signed,
            "view": field.is_read_only,
            "implied": field.is_count,
            "text": field.type == "text",
            "first": field.at // 8 if field.is_bytes else None,
            "pieces": (
                None
                if field.is_bytes
                else [[p.byte, p.shift, p.bits, p.at] for p in pieces]
            ),
            "scale": [integer(term) for term in scaled.terms] if scaled else None,
            "curve": (
                [[start, list(terms)] for start, terms in curve.pieces]
                if curve
                else None
            ),
            "oneWay": curve is not None and not field.is_invertible,
            "decimals": digits.decimals if digits else None,
            "digits": digits.significant if digits else None,
            "fixed": digits is not None and digits.is_fixed,
            "base": list(base) if base else None,
            "ends": list(field.settable_raws) if is_part else None,
            "unit": field.unit_symbol or None,
            "enum": field.enum.name if field.enum else None,
            "const": None if field.const is None else integer(field.const),
            # Bits of floats
            "special": [
                [integer(special.value), special.meaning] for special in field.special
            ]
            or None,
            "limits": limits or None,  # numerator and denominator of each
            "when": [
                [places[condition.field], list(map(integer, condition.values))]
                for condition in field.conditions
            ]
            or None,
            "derived": (
                [
                    [places[name] for name in how.fields],
                    list(how.numbers),
                    list(map(list, how.steps)),
                ]
                if how
                else None
            ),
            # a new message stores it, although its part has no elements
            "inner": field.name != field.steps[0].node.name
            and any(field.steps[0].node is node for node in earlier),
            # variable-length bytes or text
            "isOpen": bool(variable)
            and field.is_bytes
            and field.scalar.length is not None
            and field.node is variable[-1].node,
        }
        # 0 stays: it is a value, such as a constant or the first byte.
        return {
            key: value
            for key, value in plan.items()
            if value is not None and value is not False and value != ""
        }
