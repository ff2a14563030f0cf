"""Rows of the message template for fields: annotation, documentation, physical property."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.python import names
from icdgen.backends.python.black import WIDTH, annotated, assignment, bracketed, definition, display
from icdgen.backends.python.text import docstring, literal, prose, sentence
from icdgen.icd.exact import terms
from icdgen.icd.model import Field

_ANNOTATIONS = {"uint": "int", "int": "int", "bool": "bool", "float": "float", "bytes": "bytes"}
_DEFAULTS = {"uint": "0", "int": "0", "bool": "False", "float": "0.0"}


class Row(NamedTuple):
    """One field."""

    attribute: str
    declaration: str
    doc: str
    parameter: str  # of __init__
    physical: str  # name of the property with the physical value, or of the attribute
    physical_parameter: str  # of from_physical
    info: str  # FieldInfo(...)
    initialise: str  # statement of __init__
    initialise_physical: str  # statement of from_physical


class Scaled(NamedTuple):
    """The property that holds a physical value."""

    name: str
    getter: str
    doc: str
    result: str
    setter: str
    assign: str


def double(field: Field, raw: int) -> str:
    """The physical value as a literal."""
    p, c, q = terms(field.scale)
    return number((raw * p + c) / q)


def number(value: float) -> str:
    """A float as Black writes it."""
    return repr(value).replace("e+", "e")


def row(field: Field, attribute: str, enum: str, member: str) -> Row:
    """Everything that the template needs of a field. ``enum`` is its class, ``member`` the one it has by default."""
    kind = enum or _ANNOTATIONS[field.type]
    default = _default(field, enum, member)
    physical = names.physical(field, attribute)
    if physical:
        physical_parameter = f"{physical}: float = {double(field, field.const or 0)}"
    else:
        physical_parameter = f"{attribute}: {kind} = {default}"
    return Row(
        attribute,
        annotated(4, attribute, kind),
        docstring(4, _documentation(field, physical)),
        f"{attribute}: {kind} = {default}",
        physical or attribute,
        physical_parameter,
        _info(field, attribute, physical, enum),
        assignment(8, f"self.{attribute}", attribute),
        assignment(8, f"self.{physical or attribute}", physical or attribute),
    )


def _default(field: Field, enum: str, member: str) -> str:
    value = field.const or 0
    if field.type in ("enum", "bytes"):
        return member
    if field.type == "bool":
        return "True" if value else "False"
    return "0.0" if field.type == "float" else str(value)


def _documentation(field: Field, physical: str) -> list[str]:
    last = field.at + field.bits - 1
    bits = f"bits {field.at} to {last}" if field.bits > 1 else f"bit {field.at}"
    text = f"{prose(field.name)}: {bits}"
    if field.type in ("uint", "int", "enum"):
        text += f", {field.raw_min} to {field.raw_max}"
    elif field.type == "float":
        text += f", {field.bits}-bit float"
    if field.unit and not physical:
        text += f", in {prose(field.unit.symbol)}"
    if field.const is not None:
        text += f", always {field.const}"
    if physical:
        text += f"; see `{physical}`"
    paragraphs = [text + "."]
    if field.summary:
        paragraphs.append(sentence(field.summary))
    if not physical and (limits := _limits(field)):
        paragraphs.append(limits)
    for special in field.special:
        paragraphs.append(f"{special.value}: {sentence(special.meaning)}")
    for erratum in field.errata:
        paragraphs.append(f"{erratum.label} {prose(erratum.id)}: {sentence(erratum.title)}")
    return paragraphs


def _limits(field: Field) -> str:
    words = {"min": "at least", "max": "at most", "above": "above", "below": "below"}
    limits = field.limits
    found = [
        f"{words[key]} {_number(getattr(limits, key))}" for key in words if limits and getattr(limits, key) is not None
    ]
    return f"Must be {' and '.join(found)}." if found else ""


def _number(exact) -> str:
    return str(exact.numerator) if exact.denominator == 1 else number(exact.numerator / exact.denominator)


def _info(field: Field, attribute: str, physical: str, enum: str) -> str:
    items = [f'"{attribute}"', literal(field.name), str(field.at), str(field.bits), f'"{field.type}"']
    if field.unit:
        items.append(f"unit={literal(field.unit.symbol)}")
    if physical:
        items += [f'physical="{physical}"', f"scale={tuple(terms(field.scale))}"]
    if enum:
        items.append(f"enum={enum}")
    if field.const is not None:
        items.append(f"const={field.const}")
    if field.special:
        pairs = [display(16, "(", [str(s.value), literal(s.meaning)], "),")[:-1].lstrip() for s in field.special]
        items.append(display(12, "special=(", pairs, ")").lstrip())
    if field.limits:
        keys = {"min": "minimum", "max": "maximum", "above": "above", "below": "below"}
        for key, name in keys.items():
            if (limit := getattr(field.limits, key)) is not None:
                items.append(f"{name}={_number(limit)}")
    return bracketed(8, "_base.FieldInfo(", items, "),")[:-1].lstrip()


def scaled(field: Field, attribute: str) -> Scaled:
    """The property of a field with a scale."""
    name = names.physical(field, attribute)
    p, c, q = terms(field.scale)
    low, high = sorted((field.raw_min, field.raw_max), key=lambda raw: raw * p)
    unit = f" in {prose(field.unit.symbol)}" if field.unit else ""
    paragraphs = [f"{prose(field.name)}{unit}: {double(field, low)} to {double(field, high)}."]
    if limits := _limits(field):
        paragraphs.append(limits)
    arguments = ["value", f'"{attribute}"', str((p, c, q)), str(field.raw_min), str(field.raw_max)]
    return Scaled(
        name,
        definition(4, f"def {name}(", ["self"], ") -> float:"),
        docstring(8, paragraphs),
        _result(attribute, p, c, q),
        definition(4, f"def {name}(", ["self", "value: float"], ") -> None:"),
        _stored(attribute, arguments),
    )


def _stored(attribute: str, arguments: list[str]) -> str:
    call = bracketed(8, f"self.{attribute} = _codec.raw_value(", arguments, ")")
    if len(call.partition("\n")[0]) <= WIDTH:
        return call
    call = bracketed(8, "raw = _codec.raw_value(", arguments, ")")
    return f"{call}\n{assignment(8, f'self.{attribute}', 'raw')}"


def _result(attribute: str, p: int, c: int, q: int) -> str:
    result = f"return {_value(f'self.{attribute}', p, c, q)}"
    if len(result) + 8 <= WIDTH:
        return result
    return f"{assignment(8, 'raw', f'self.{attribute}').lstrip()}\n        return {_value('raw', p, c, q)}"


def _value(value: str, p: int, c: int, q: int) -> str:
    if p != 1:
        value = f"{value} * {p}"
    if c:
        value = f"{value} {'+' if c > 0 else '-'} {abs(c)}"
    if q == 1:
        return f"float({value})"
    return f"({value}) / {q}" if c else f"{value} / {q}"
