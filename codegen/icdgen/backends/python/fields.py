"""Fields of messages and structs: annotations, and the calls that declare them.

Input is a `FieldDescription`; output is text such as ``mode: Mode = _base.field(...)``.
The functions of `_base` are in ``runtime/python``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

from icdgen.backends.lines import STEP, exploded
from icdgen.backends.python.names import accessors_in_python, constant_name
from icdgen.backends.python.symbols import PYTHON_NAMES
from icdgen.backends.python.text import literal
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.accessors import Accessor
from icdgen.describe.constants import Constant
from icdgen.describe.derived import computation_of
from icdgen.describe.description import VariablePartDescription
from icdgen.describe.integer_scale import IntegerScale
from icdgen.icd import floats
from icdgen.icd.curve import Curve
from icdgen.icd.model import Special

_WIDTH = 120
"""Columns of a declaration: wider than `text.WIDTH`, because its call is easier to read
on one line.
"""
_KEYWORDS = {"min": "minimum", "max": "maximum"}


def annotation(field: FieldDescription) -> str:
    """Return the type of the attribute."""
    return (
        f"tuple[{_element_annotation(field)}, ...]"
        if field.count
        else _optional(field, _element_annotation(field))
    )


def _optional(field: FieldDescription, note: str) -> str:
    """Return the type of an attribute. Absent optional fields have the value None."""
    # `_lazy` imports `typing` only if something evaluates the annotation, so importing
    # a message stays fast.
    return f"_lazy.Optional[{note}]" if field.model.conditions else note


def _element_annotation(field: FieldDescription) -> str:
    if field.struct is not None:
        return PYTHON_NAMES.symbol(field.struct, "class")
    if field.is_text:
        return "bytes"
    if field.enum is not None:
        return PYTHON_NAMES.symbol(field.enum, "class")
    return "int" if field.model.type == "uint" else field.model.type


def default_value(field: FieldDescription) -> str:
    """Return the raw value in a new message."""
    if field.count:
        return _repeated(field, _element_default(field))
    if field.is_in_last_part:
        return f"bytes({field.initial_count})" if field.initial_count else 'b""'
    return _element_default(field)


def _repeated(field: FieldDescription, value: str) -> str:
    """Return the values of an array in a new message."""
    return f"({value},) * {field.initial_count}" if field.initial_count else "()"


def _element_default(field: FieldDescription) -> str:
    kind, value = field.model.type, field.initial_raw
    if field.model.is_bytes:
        return f"bytes({field.model.bits // 8})"
    if kind == "bool":
        return str(bool(value))
    if kind == "float":
        return "0.0"
    if field.enum is None:
        return str(value)
    # An initial value can be without a name. The class then gives a member for the
    # number.
    name, member = PYTHON_NAMES.symbol(field.enum, "class"), field.enum.member(value)
    return f"{name}.{constant_name(member.name)}" if member else f"{name}({value})"


def _keywords(field: FieldDescription) -> list[str]:
    """Return the keyword arguments that describe a field."""
    place, items = field.model, []
    if field.count:
        items.append(f"elements={field.count}")
    if field.is_in_last_part:
        items.append("is_open=True")
        items += [f"fewest={field.initial_count}"] if field.initial_count else []
    # `_base.field` takes the enumeration from the first element of the default, and an
    # empty array has none.
    if field.is_in_last_part and field.enum is not None:
        items.append(f"enum={PYTHON_NAMES.symbol(field.enum, 'class')}")
    if field.needs:
        needs = (
            f'("{need.field.name}", ({", ".join(map(str, need.values))},))'
            for need in field.needs
        )
        items.append(f"when=({', '.join(needs)},)")
    if place.unit:
        items.append(f"unit={literal(place.unit.symbol)}")
    if place.const is not None:
        items.append(f"const={place.const}")
    if place.special:
        pairs = [
            f"({special_value(special, place.bits)}, {literal(special.meaning)})"
            for special in place.special
        ]
        items.append(exploded("special=(", pairs, ")", " " * 8))
    items += (
        f'{key}="{value}"'
        for key in ("byte_order", "bit_order")
        if (value := getattr(place, key))
    )
    items += (
        f"{_KEYWORDS.get(bound.key, bound.key)}={number_literal(bound.value)}"
        for bound in field.bounds
    )
    return items


def constant_value(field: FieldDescription, constant: Constant) -> str:
    """Return the literal of a constant of a field."""
    if constant.number:
        return special_value(constant, field.model.bits)
    return number_literal(constant.value)


def special_value(value: Special | Constant, bits: int) -> str:
    """Return the literal of a special raw value; for a float the value that the
    attribute has.
    """
    if value.number in floats.NAMED:
        return f'float("{value.number}")'
    return (
        repr(floats.value_of(int(value.value), bits))
        if value.number
        else str(value.value)
    )


def declaration(field: FieldDescription) -> str:
    """Return the declaration of a field: ``control_mode: ConModeSelect =
    _base.field(...)``.
    """
    place = field.model
    if field.struct is not None:
        items = [
            literal(place.name),
            str(place.at),
            str(place.bits),
            f"factory={PYTHON_NAMES.symbol(field.struct, 'class')}",
            *_keywords(field),
        ]
        return _call_declaration(field.name, annotation(field), "part", items)
    items = [
        literal(place.name),
        str(place.at),
        str(place.bits),
        f'"{place.type}"',
        f"default={default_value(field)}",
        *_keywords(field),
    ]
    return _call_declaration(field.name, annotation(field), "field", items)


def inner(message: MessageDescription) -> list[str]:
    """Return the items of ``INNER``: variable parts after which frames differ from the
    longest one.
    """
    return [f"({_placed_part(part)})" for part in message.spread_parts]


def nested(message: MessageDescription) -> list[str]:
    """Return the items of ``NESTED``: variable-length arrays in the elements of a part."""
    return [
        f'("{part.field.name}", {_placed_part(inner)})'
        for part in message.variable_parts
        for inner in part.inner
    ]


def _placed_part(part: VariablePartDescription) -> str:
    """Return a variable part, its place, and the bits of its counter."""
    # A tuple of one item needs a comma at its end.
    pieces = [f"({p.byte}, {p.shift}, {p.bits}, {p.at})" for p in part.counter.pieces]
    return f"{open_part(part)}, {part.model.begin}, ({', '.join(pieces)}{',' * (len(pieces) == 1)})"


def open_part(part: VariablePartDescription) -> str:
    """Return ``_base.Tail(...)``: the attributes of a variable part and its counter,
    and sizes.
    """
    counter = "" if part.is_rest else part.counter.name
    plus, behind = part.model.plus, part.model.behind
    # The arguments are positional, so the last one needs the one before it.
    more = f", {plus}" if plus or behind else ""
    more += f", {behind}" if behind else ""
    return f'_base.Tail("{part.field.name}", "{counter}", {part.model.step}, {part.model.most}{more})'


def view_info(field: FieldDescription) -> str:
    """Return ``_base.FieldInfo(...)`` of an overlay field or derived value."""
    place = field.model
    items = [
        f'"{field.name}"',
        literal(place.name),
        str(place.at),
        str(place.bits),
        f'"{place.type}"',
        *_keywords(field),
    ]
    if field.steps is not None:
        items += [f'physical="{field.physical_name}"', f"scale={field.steps.terms}"]
    if field.curve is not None:
        pieces = _piece_literals(field.curve)
        listed = (
            exploded("(", pieces, ")", " " * 12)
            if len(pieces) > 1
            else f"({pieces[0]},)"
        )
        items += [f'physical="{field.physical_name}"', f"curve={listed}"]
    if field.enum is not None:
        items.append(f"enum={PYTHON_NAMES.symbol(field.enum, 'class')}")
    if place.derived is not None:
        operands = (operand for _, operand in computation_of(field).fields)
        attributes = tuple(
            operand.physical_name if operand.is_scaled else operand.name
            for operand in operands
        )
        steps = tuple(tuple(step) for step in place.derived.steps)
        items.append(
            # No text in these tuples has a quote, so the quotes of `repr` can be
            # replaced.
            f"derived=({attributes!r}, {place.derived.numbers!r}, {steps!r})".replace(
                "'", '"'
            )
        )
    return f"_base.FieldInfo({', '.join(items)})"


def getter(field: FieldDescription) -> str:
    """Return the expression of an overlay field or derived value."""
    if field.model.derived is not None:
        return f'_base.derived(self, "{field.name}")'
    return f'_base.view(self, "{field.name}", {annotation(field)})'


def physical(field: FieldDescription) -> str:
    """Return the expression of the physical value of an overlay field."""
    if field.curve is not None:
        return f'_base.on_curve(self, "{field.name}")'
    assert field.steps is not None
    p, c, q = field.steps.terms
    # Python divides whole numbers of any size with a single rounding, so the result is
    # the double nearest to the exact value for any terms.
    return f"(self.{field.name} * {p} {'-' if c < 0 else '+'} {abs(c)}) / {q}"


def accessors(field: FieldDescription) -> Iterator[tuple[str, str]]:
    """List the declarations of the physical value of a field, with their comments."""
    for accessor in accessors_in_python(field):
        if accessor.kind == "text":
            yield (
                _text_declaration(field),
                f"{accessor.comment} An invalid byte reads as U+FFFD.",
            )
        else:
            yield (
                (
                    _physical_declaration(field)
                    if accessor.scale is None
                    else _integer_declaration(accessor, accessor.scale)
                ),
                accessor.comment,
            )


def _physical_declaration(field: FieldDescription) -> str:
    """Return the declaration of a physical value: ``estimated_roll_angle_deg: float =
    _base.scaled(...)``.
    """
    curve = field.curve
    steps = field.steps
    first = _double_literal(field.initial_physical)
    first, note = (
        (_repeated(field, first), "tuple[float, ...]")
        if field.count
        else (first, _optional(field, "float"))
    )
    if curve is not None:
        items = [*_piece_literals(curve), f"default={first}"]
        # By default, `_base.curve` searches the whole range of raw values.
        if field.is_settable and field.model.settable_raws != (
            field.model.raw_min,
            field.model.raw_max,
        ):
            items.append(f"ends={field.model.settable_raws}")
        return _call_declaration(
            field.physical_name,
            note,
            "curve" if field.is_settable else "curve_only",
            items,
        )
    assert steps is not None
    return _call_declaration(
        field.physical_name,
        note,
        "scaled",
        [*map(str, steps.terms), f"default={first}"],
    )


def _piece_literals(curve: Curve) -> list[str]:
    """Return a literal for each piece of a calibration."""
    return [f"({start!r}, {terms!r})" for start, terms in curve.pieces]


def _double_literal(value: float) -> str:
    """Return the literal of a double."""
    # `repr` of NaN and of the infinities is the name of an undefined variable.
    return repr(value) if math.isfinite(value) else f'float("{value}")'


def _text_declaration(field: FieldDescription) -> str:
    """Return the declaration of a text: ``version_text: str = _base.text(...)``."""
    first = _repeated(field, '""') if field.count else '""'
    return _call_declaration(
        field.physical_name,
        "tuple[str, ...]" if field.count else "str",
        "text",
        [f"default={first}"],
    )


def _integer_declaration(accessor: Accessor, scale: IntegerScale) -> str:
    """Return the declaration of whole parts of the unit: ``estimated_roll_angle_mdeg:
    int = _base.whole(...)``.
    """
    note = (
        "tuple[int, ...]" if accessor.field.count else _optional(accessor.field, "int")
    )
    return _call_declaration(
        accessor.name, note, "whole", [str(scale.factor), str(scale.offset)]
    )


def _call_declaration(name: str, note: str, call: str, items: list[str]) -> str:
    """Return ``name: note = _base.call(items)`` on one line, or with the items on lines
    of their own if it is too long.
    """
    head, inner = f"{name}: {note} = _base.{call}(", ", ".join(items)
    if "\n" in inner or len(inner) + 8 > _WIDTH:
        return exploded(head, items, ")", STEP)
    line = f"{head}{inner})"
    return (
        line
        if len(line) + len(STEP) <= _WIDTH
        else f"{head}\n{STEP * 2}{inner}\n{STEP})"
    )


def number_literal(exact: Fraction | int) -> str:
    """Return the literal of a whole number, or of the nearest float."""
    return (
        str(exact.numerator)
        if exact.denominator == 1
        else repr(exact.numerator / exact.denominator)
    )
