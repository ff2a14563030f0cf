"""Expressions and statements for the templates of messages and structs.

This covers initial values, range checks, lengths of variable parts, and the imports of
each module. Expressions of single fields are in `icdgen.backends.rust.bits`.
"""

from __future__ import annotations

import re
from typing import Any

from icdgen.backends.rust import bits, elements
from icdgen.backends.rust.names import field_name, reader
from icdgen.backends.rust.text import double, integer
from icdgen.backends.rust.types import integer_type, struct_path
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.constants import Constant
from icdgen.describe.description import Composite, Into, VariablePartDescription
from icdgen.describe.groups import bytes_of_flags
from icdgen.describe.lengths import ElementBytes

# A name of the support module that templates use but this set lacks is missing in
# `use`, and the generated crate does not compile. A name that a module does not use
# would be a warning of rustc, so each module imports only its own.
_SUPPORT = frozenset(
    """
    array arrays beginning counted each element_of elements exact first flags longest message number power present put put_array
    put_each put_element put_rounds put_words quiet rounds spread spread_elements structure take text text_array there told
    valid whole words Big Coded Curve Error Frame Scale Wide
    """.split()
)
# Names that code calls or uses as types. Comments and texts are matched first, so that
# names in them do not count.
_USED = re.compile(
    r'//.*|"(?:[^"\\]|\\.)*"|(?<![\w.:&])(?<!fn )([A-Za-z]\w*)(?=[(!<>]|::| = Wide)'
)
# Arrays have `Default` for each length up to 32 and not for any `N`.
DERIVES_DEFAULT = 32
"""Largest array for which the standard library implements `Default`."""


def flag_bytes(message: MessageDescription) -> list[int]:
    """Return the bytes whose flags are read from a table."""
    return sorted(bytes_of_flags(message, bits.FLAGS_FROM))


def literal(message: MessageDescription) -> str:
    """Return the struct expression of a message with the values in ``bytes``."""
    tables = bytes_of_flags(message, bits.FLAGS_FROM)
    values = [
        "None" if field.model.conditions else bits.read_expression(field, tables)
        for field in message.members
    ]
    return elements.struct_literal(message.members, values)


def write_statements(message: MessageDescription) -> list[str]:
    """Return the statements that write all members but optional ones."""
    lines = []
    for member in message.walk(Into.STRUCTS):
        if not member.model.conditions:
            lines += bits.write_field(member)
    return lines


def overlay_value(field: FieldDescription) -> str:
    """Return the expression of an overlay field."""
    return bits.read_expression(field, set(), depth=2)


def counter_value(part: VariablePartDescription) -> str:
    """Return the expression of the counter of a variable part in a frame."""
    return bits.read_expression(part.counter, set())


def part_bytes(part: VariablePartDescription, is_limited: bool = False) -> str:
    """Return the number of bytes of a variable part in a message; of elements if they
    have variable-length arrays.

    ``is_limited``: for any value of the counter, valid or not.
    """
    model, step = part.model, 1 if part.inner else part.model.step
    count = f"number(self.{field_name(part.counter)}, {model.low}, {model.fewest})"
    # The counter is a public member, so it can have a value that no frame can have.
    return times(step, f"{count}.min({model.most})" if is_limited else count)


def element_bytes(part: VariablePartDescription) -> str:
    """Return the bytes of an element with variable-length arrays."""
    fixed = sum(chunk.fixed for chunk in part.chunks)
    arrays = (part_bytes(inner, is_limited=True) for inner in part.inner)
    return " + ".join((*([str(fixed)] if fixed else []), *arrays))


def times(step: int, count: str) -> str:
    """Return the bytes of elements of ``step`` bytes."""
    if step == 1:
        return count
    return f"{step} * ({count})" if " + " in count else f"{step} * {count}"


def used_names(body: str) -> frozenset[str]:
    """Return the names that the body of a module uses."""
    # For comments and texts, `findall` returns an empty group, which is no name.
    return frozenset(_USED.findall(body))


def imports(used: frozenset[str]) -> str:
    """Return the names of the support module that a module uses, for its ``use``
    statement.
    """
    names = sorted(
        _SUPPORT & used,
        key=lambda name: (name[0].isupper(), name),
    )
    return f"{{{', '.join(names)}}}" if len(names) > 1 else names[0]


def derives(composite: Composite[Any]) -> str:
    """Return the traits that the struct derives."""
    traits = ["Clone", "Copy", "Debug", "PartialEq"]
    if all(map(_is_default, composite.members)):
        traits.insert(3, "Default")
    # Floats have no total equality.
    return ", ".join(traits + ([] if composite.has_floats else ["Eq", "Hash"]))


def default(composite: Composite[Any]) -> str:
    """Return the struct expression of the initial values; empty if `Default` is derived."""
    fields = composite.members
    if all(map(_is_default, fields)):
        return ""
    return elements.struct_literal(fields, [_initial_value(field) for field in fields])


def fits(composite: Composite[Any]) -> list[str]:
    """Return the statements that return an error if a raw value does not fit."""
    lines = []
    for field in composite.members:
        if field.needs_range_check and not field.model.conditions:
            lines += bits.check_range(field)
    return lines


def typed_constant(field: FieldDescription, constant: Constant) -> tuple[str, str]:
    """Return type and value of a constant of a field."""
    if constant.number:
        kind = f"f{field.model.bits}"
        named = {"nan": "NAN", "inf": "INFINITY", "-inf": "NEG_INFINITY"}.get(
            constant.number
        )
        return kind, f"{kind}::{named}" if named else double(float(constant.number))
    if field.model.type == "bool" and constant.is_raw:
        return "bool", "true" if constant.value else "false"
    if isinstance(constant.value, int):
        return integer_type(field), integer(constant.value)
    return "f64", double(constant.double)


def bytes_of(elements: ElementBytes) -> str:
    """Return the number of bytes for ``count`` elements."""
    counted = times(elements.step, "count")
    return f"{elements.before} + {counted}" if elements.before else counted


def counted_text(last: VariablePartDescription) -> str:
    """Return the value of the counter for a ``text``."""
    more = last.counter_of_text
    if more < 0:
        return f"text.len().saturating_sub({-more})"
    return f"(text.len() + {more})" if more else "text.len()"


def part_count(part: VariablePartDescription) -> str:
    """Return the number of elements of a variable part."""
    counter, model = f"self.{field_name(part.counter)}", part.model
    return f"number({counter}, {model.low}, {model.fewest})" if model.plus else counter


def _is_default(field: FieldDescription) -> bool:
    """Return whether a derived `Default` gives the initial value of a field."""
    if field.count > DERIVES_DEFAULT or (
        field.model.is_bytes and field.size > DERIVES_DEFAULT
    ):
        return False
    return field.is_initially_zero


def _initial_value(field: FieldDescription) -> str:
    value = _value_expression(field, field.initial_raw)
    if field.is_in_last_part and field.count:
        # Decoding gives missing elements the values of zero bytes. These can differ
        # from the initial values of the struct, so absent elements are read from zeros
        # here, too.
        length = field.struct.model.length if field.struct is not None else 0
        absent = (
            f"Self::{reader(field.name)}(&[0; {length}])"
            if length
            else _value_expression(field, 0)
        )
        few = field.initial_count if field.has_initial_value else 0
        return (
            f"first({few}, {value}, {absent})" if few else f"[{absent}; {field.count}]"
        )
    if field.model.conditions:
        return f"Some({value})" if field.is_initially_present else "None"
    return f"[{value}; {field.count}]" if field.count else value


def _value_expression(field: FieldDescription, raw: int) -> str:
    kind = field.model.type
    if field.struct is not None:
        return f"{struct_path(field.struct, field.message.node)}::default()"
    if field.model.is_bytes:
        return f"[0; {field.model.bits // 8}]"
    if kind == "enum":
        return f"Coded::from_raw({integer(raw)})"
    if kind == "float":
        return "0.0"
    if kind == "bool":
        return "true" if raw else "false"
    return integer(raw)
