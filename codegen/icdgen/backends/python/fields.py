"""Fields: annotations, what they are at first, what is told of them, properties of physical values."""

from __future__ import annotations

from fractions import Fraction

from icdgen.backends.lines import bracketed, exploded
from icdgen.backends.python.names import class_name
from icdgen.backends.python.text import WIDTH, literal
from icdgen.describe import FieldDescription

_KEYWORDS = {"min": "minimum", "max": "maximum"}


def annotation(field: FieldDescription) -> str:
    """The type of the attribute."""
    one = _annotation(field)
    return f"tuple[{one}, ...]" if field.count else one


def _annotation(field: FieldDescription) -> str:
    if field.is_text:
        return "bytes"
    return class_name(field.enum) if field.enum else "int" if field.model.type == "uint" else field.model.type


def default(field: FieldDescription, constants: dict[str, str]) -> str:
    """What a field is at first; constants of the module are kept in ``constants``: the call that makes it, and its name."""
    one = _default(field, constants)
    return f"({one},) * {field.count}" if field.count else one


def physical_annotation(field: FieldDescription) -> str:
    """The type of the property of a number's physical value."""
    return "tuple[float, ...]" if field.count else "float"


def physical_default(field: FieldDescription) -> str:
    """The physical value of a field with a scale, as it is at first."""
    assert field.steps is not None
    one = repr(field.steps.double(field.fresh))
    return f"({one},) * {field.count}" if field.count else one


def _default(field: FieldDescription, constants: dict[str, str]) -> str:
    kind, value = field.model.type, field.fresh
    if field.model.is_bytes:
        return _constant(constants, f"bytes({field.model.bits // 8})")
    if field.enum is None:
        return str(bool(value)) if kind == "bool" else "0.0" if kind == "float" else str(value)
    name, member = class_name(field.enum), field.enum.member(value)
    return f"{name}.{member.name.upper()}" if member else _constant(constants, f"_codec.unnamed({name}, {value})")


def _constant(constants: dict[str, str], call: str) -> str:
    return constants.setdefault(call, f"_DEFAULT_{len(constants)}")


def info(field: FieldDescription) -> str:
    """``_base.FieldInfo(...)``"""
    one = field.model
    items = [f'"{field.name}"', literal(one.name), str(one.at), str(one.bits), f'"{one.type}"']
    if one.unit:
        items.append(f"unit={literal(one.unit.symbol)}")
    if field.is_text:
        items.append(f'physical="{field.physical_name}"')
    if field.steps is not None:
        items += [f'physical="{field.physical_name}"', f"scale={field.steps.terms}"]
    if field.enum is not None:
        items.append(f"enum={class_name(field.enum)}")
    if one.const is not None:
        items.append(f"const={one.const}")
    if one.special:
        pairs = [f"({special.value}, {literal(special.meaning)})" for special in one.special]
        items.append(exploded("special=(", pairs, ")", " " * 12))
    items += (f'{key}="{value}"' for key in ("byte_order", "bit_order") if (value := getattr(one, key)))
    if field.count:
        items.append(f"elements={field.count}")
    items += (f"{_KEYWORDS.get(bound.key, bound.key)}={_number(bound.value)}" for bound in field.bounds)
    return bracketed("_base.FieldInfo(", items, ")", WIDTH, " " * 8)


def _number(exact: Fraction) -> str:
    return str(exact.numerator) if exact.denominator == 1 else repr(exact.numerator / exact.denominator)


def physical(field: FieldDescription) -> str:
    """The physical value of a field with a scale."""
    assert field.steps is not None
    p, c, q = field.steps.terms
    raw = "raw" if field.count else f"self.{field.name}"
    value = raw if p == 1 else f"{raw} * {p}"
    if c:
        value = f"{value} {'+' if c > 0 else '-'} {abs(c)}"
    value = f"float({value})" if q == 1 else f"({value}) / {q}" if c else f"{value} / {q}"
    if not field.count:
        return value
    return bracketed("tuple(", [f"{value} for raw in self.{field.name}"], ")", WIDTH, " " * 8, last="")


def text(field: FieldDescription) -> str:
    """The text of a field of characters."""
    return f"_codec.text(self.{field.name})"


def set_text(field: FieldDescription) -> str:
    """The statement that sets it."""
    arguments = ["value", f'"{field.name}"', str(field.size)]
    return bracketed(f"self.{field.name} = _codec.text_bytes(", arguments, ")", WIDTH, " " * 8)


def set_physical(field: FieldDescription) -> str:
    """The statement that sets it."""
    assert field.steps is not None
    ends = str(field.model.raw_min), str(field.model.raw_max)
    arguments = ["value", f'"{field.name}"', str(field.steps.terms), *ends]
    arguments += [str(field.count)] if field.count else []
    function = "raw_values" if field.count else "raw_value"
    return bracketed(f"self.{field.name} = _codec.{function}(", arguments, ")", WIDTH, " " * 8)
