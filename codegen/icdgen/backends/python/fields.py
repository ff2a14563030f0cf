"""Fields: annotations, and the calls that declare them."""

from __future__ import annotations

import math
from fractions import Fraction

from icdgen.backends.lines import STEP, exploded
from icdgen.backends.python.names import class_name
from icdgen.backends.python.text import literal
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.constants import Constant
from icdgen.describe.derived import derived
from icdgen.describe.description import VariablePartDescription
from icdgen.describe.integer_scale import IntegerScale
from icdgen.icd import floats
from icdgen.icd.curve import Curve
from icdgen.icd.model import Special

_WIDTH = 120  # columns of a declaration
_KEYWORDS = {"min": "minimum", "max": "maximum"}


def annotation(field: FieldDescription) -> str:
    """The type of the attribute."""
    return f"tuple[{_annotation(field)}, ...]" if field.count else _perhaps(field, _annotation(field))


def _perhaps(field: FieldDescription, note: str) -> str:
    """The type of what is None where the field is not there."""
    return f"_lazy.Optional[{note}]" if field.model.when else note


def _annotation(field: FieldDescription) -> str:
    if field.struct is not None:
        return class_name(field.struct)
    if field.is_text:
        return "bytes"
    return class_name(field.enum) if field.enum else "int" if field.model.type == "uint" else field.model.type


def default(field: FieldDescription) -> str:
    """The raw value in a new message."""
    if field.count:
        return _repeated(field, _default(field))
    if field.is_in_last_part:
        return f"bytes({field.initial_count})" if field.initial_count else 'b""'
    return _default(field)


def _repeated(field: FieldDescription, value: str) -> str:
    """The values of an array in a new message."""
    return f"({value},) * {field.initial_count}" if field.initial_count else "()"


def _default(field: FieldDescription) -> str:
    kind, value = field.model.type, field.initial_raw
    if field.model.is_bytes:
        return f"bytes({field.model.bits // 8})"
    if field.enum is None:
        return str(bool(value)) if kind == "bool" else "0.0" if kind == "float" else str(value)
    name, member = class_name(field.enum), field.enum.member(value)
    return f"{name}.{member.name.upper()}" if member else f"{name}({value})"


def _told(field: FieldDescription) -> list[str]:
    """What is told of a field by keywords."""
    one, items = field.model, []
    if field.count:
        items.append(f"elements={field.count}")
    if field.is_in_last_part:
        items.append("is_open=True")
        items += [f"fewest={field.initial_count}"] if field.initial_count else []
    if field.is_in_last_part and field.enum is not None:
        items.append(f"enum={class_name(field.enum)}")
    if field.needs:
        needs = (f'("{need.field.name}", ({", ".join(map(str, need.values))},))' for need in field.needs)
        items.append(f"when=({', '.join(needs)},)")
    if one.unit:
        items.append(f"unit={literal(one.unit.symbol)}")
    if one.const is not None:
        items.append(f"const={one.const}")
    if one.special:
        pairs = [f"({special_value(special, one.bits)}, {literal(special.meaning)})" for special in one.special]
        items.append(exploded("special=(", pairs, ")", " " * 8))
    items += (f'{key}="{value}"' for key in ("byte_order", "bit_order") if (value := getattr(one, key)))
    items += (f"{_KEYWORDS.get(bound.key, bound.key)}={number(bound.value)}" for bound in field.bounds)
    return items


def constant(one: Constant, field: FieldDescription) -> str:
    """A literal of a constant of the field."""
    return special_value(one, field.model.bits) if one.number else number(one.value)


def special_value(one: Special | Constant, bits: int) -> str:
    """A literal of the raw value; of one of a float as the attribute has it."""
    if one.number in floats.NAMED:
        return f'float("{one.number}")'
    return repr(floats.value_of(int(one.value), bits)) if one.number else str(one.value)


def declaration(field: FieldDescription) -> str:
    """``control_mode: ConModeSelect = _base.field(...)``: its place, its first value, and what is told of it."""
    one = field.model
    if field.struct is not None:
        items = [literal(one.name), str(one.at), str(one.bits), f"factory={class_name(field.struct)}", *_told(field)]
        return _statement(field.name, annotation(field), "part", items)
    items = [literal(one.name), str(one.at), str(one.bits), f'"{one.type}"', f"default={default(field)}", *_told(field)]
    return _statement(field.name, annotation(field), "field", items)


def inner(message: MessageDescription) -> list[str]:
    """The items of ``INNER``: what is open in front of the end, its place, and the bits of what counts it."""
    found = []
    for one in message.earlier_parts:
        pieces = [f"({p.byte}, {p.shift}, {p.bits}, {p.at})" for p in one.counter.pieces]
        found.append(f"({open_part(one)}, {one.model.begin}, ({', '.join(pieces)}{',' * (len(pieces) == 1)}))")
    return found


def open_part(one: VariablePartDescription) -> str:
    """``_base.Tail(...)``: attributes, bytes and elements of what is open."""
    counter = "" if one.counter.model.is_count else one.counter.name
    plus = f", {one.model.plus}" if one.model.plus else ""
    return f'_base.Tail("{one.field.name}", "{counter}", {one.model.step}, {one.model.most}{plus})'


def view_info(field: FieldDescription) -> str:
    """``_base.FieldInfo(...)`` of a view."""
    one = field.model
    items = [f'"{field.name}"', literal(one.name), str(one.at), str(one.bits), f'"{one.type}"', *_told(field)]
    if field.steps is not None:
        items += [f'physical="{field.physical_name}"', f"scale={field.steps.terms}"]
    if field.curve is not None:
        pieces = _pieces(field.curve)
        listed = exploded("(", pieces, ")", " " * 12) if len(pieces) > 1 else f"({pieces[0]},)"
        items += [f'physical="{field.physical_name}"', f"curve={listed}"]
    if field.enum is not None:
        items.append(f"enum={class_name(field.enum)}")
    if one.derived is not None:
        fields = (held for _, held in derived(field).fields)
        attributes = tuple(held.physical_name if held.is_scaled else held.name for held in fields)
        steps = tuple(tuple(step) for step in one.derived.steps)
        items.append(f"derived=({attributes!r}, {one.derived.numbers!r}, {steps!r})".replace("'", '"'))
    return f"_base.FieldInfo({', '.join(items)})"


def getter(field: FieldDescription) -> str:
    """The value of a view."""
    if field.model.derived is not None:
        return f'_base.derived(self, "{field.name}")'
    return f'_base.view(self, "{field.name}", {annotation(field)})'


def physical(field: FieldDescription) -> str:
    """The physical value of a view."""
    if field.curve is not None:
        return f'_base.on_curve(self, "{field.name}")'
    assert field.steps is not None
    p, c, q = field.steps.terms
    return f"(self.{field.name} * {p} {'-' if c < 0 else '+'} {abs(c)}) / {q}"


def scaled(field: FieldDescription) -> str:
    """``estimated_roll_angle_deg: float = _base.scaled(...)``: the steps of the physical value, and the first one."""
    curve, steps, first = field.curve, field.steps, _double(field.initial_physical)
    first, note = (_repeated(field, first), "tuple[float, ...]") if field.count else (first, _perhaps(field, "float"))
    if curve is not None:
        items = [*_pieces(curve), f"default={first}"]
        if field.is_settable and field.model.settable_raws != (field.model.raw_min, field.model.raw_max):
            items.append(f"ends={field.model.settable_raws}")
        return _statement(field.physical_name, note, "curve" if field.is_settable else "curve_only", items)
    assert steps is not None
    return _statement(field.physical_name, note, "scaled", [*map(str, steps.terms), f"default={first}"])


def _pieces(curve: Curve) -> list[str]:
    """A literal of each."""
    return [f"({start!r}, {terms!r})" for start, terms in curve.pieces]


def _double(value: float) -> str:
    """A literal."""
    return repr(value) if math.isfinite(value) else f'float("{value}")'


def text(field: FieldDescription) -> str:
    """``version_text: str = _base.text(...)``: a field of characters as what it says."""
    first = _repeated(field, '""') if field.count else '""'
    return _statement(field.physical_name, "tuple[str, ...]" if field.count else "str", "text", [f"default={first}"])


def exact(field: FieldDescription, found: IntegerScale) -> str:
    """``estimated_roll_angle_mdeg: int = _base.whole(...)``"""
    note = "tuple[int, ...]" if field.count else _perhaps(field, "int")
    return _statement(field.integer_name(found.per), note, "whole", [str(found.factor), str(found.offset)])


def _statement(name: str, note: str, call: str, items: list[str]) -> str:
    """``name: note = _base.call(items)`` on a line; what is too long for that goes on lines of its own."""
    head, inner = f"{name}: {note} = _base.{call}(", ", ".join(items)
    if "\n" in inner or len(inner) + 8 > _WIDTH:
        return exploded(head, items, ")", STEP)
    line = f"{head}{inner})"
    return line if len(line) + len(STEP) <= _WIDTH else f"{head}\n{STEP * 2}{inner}\n{STEP})"


def number(exact: Fraction | int) -> str:
    """A literal: of an int, or of the nearest float."""
    return str(exact.numerator) if exact.denominator == 1 else repr(exact.numerator / exact.denominator)
