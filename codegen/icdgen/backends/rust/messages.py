"""Values for the templates of messages and structs, in addition to the description."""

from __future__ import annotations

import re
from typing import Any

from icdgen.backends.rust import arrays, bits, conditional, elements, parts
from icdgen.backends.rust.names import field_name
from icdgen.backends.rust.physical import has_constant
from icdgen.backends.rust.text import double, integer
from icdgen.backends.rust.types import integer_type, struct_path
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.constants import Constant
from icdgen.describe.description import Composite, Into, VariablePartDescription
from icdgen.describe.groups import bytes_of_flags
from icdgen.describe.lengths import ElementBytes

_SUPPORT = frozenset("""
    array arrays beginning counted each element_of elements exact first flags longest message number power present put put_array
    put_each put_element put_rounds put_words quiet rounds spread spread_elements structure take text text_array there told
    valid whole words Big Coded Curve Error Frame Scale Wide
    """.split())
# Names that code calls or uses as types. Comments and texts are matched first, so that
# names in them do not count.
_USED = re.compile(
    r'//.*|"(?:[^"\\]|\\.)*"|(?<![\w.:&])(?<!fn )([A-Za-z]\w*)(?=[(!<>]|::| = Wide)'
)
DERIVES_DEFAULT = 32
"""Largest array for which the standard library implements `Default`."""


def values(message: MessageDescription) -> dict[str, object]:
    """Return the values for the template of a message."""
    fields, tables, last = (
        message.members,
        bytes_of_flags(message, bits.FLAGS_FROM),
        message.last_part,
    )
    readings = [
        "None" if field.model.conditions else bits.reading(field, tables)
        for field in fields
    ]
    overlays = [
        (field, bits.reading(field, set(), depth=2)) for field in message.overlays
    ]
    conditions = conditional.conditional(message)
    writings = [
        line
        for member in message.walk(Into.STRUCTS)
        if not member.model.conditions
        for line in bits.writing(member)
    ]
    return {
        **of_composite(message),
        "refused": message.is_narrow or bool(conditions),
        "conditional": conditions,
        "last": last,
        "earlier": list(map(_earlier_part, message.earlier_parts)),
        "groups": any(part.inner for part in message.variable_parts)
        and list(map(_spread_part, message.spread_parts)),
        **(_of_variable_length(message, last) if last else {}),
        "tables": sorted(tables),
        "literal": elements.literal(fields, readings),
        "overlays": overlays,
        "writings": writings,
        "repeated": list(elements.functions(message)),
        "parts": parts.parts(message),
    }


def _of_variable_length(
    message: MessageDescription, last: VariablePartDescription
) -> dict[str, object]:
    """Return the values for messages whose frames differ in length."""
    return {
        "bytes_of_end": _times(
            last.model.step,
            f"count + {last.model.fewest}" if last.model.fewest else "count",
        ),
        "bytes_of_elements": _times(last.model.step, "count"),
        "length_of_frame": _length(last.bytes_beyond_fewest),
        "length_of_elements": _length(last.place),
        "counted_text": _counted_text(last),
        "variable_parts": [(part, _number(part)) for part in message.variable_parts],
    }


def _earlier_part(
    part: VariablePartDescription,
) -> tuple[VariablePartDescription, str, str, str]:
    """Return a variable part, the expression of its counter, and its bytes: for a valid
    count, and for any count.
    """
    count = f"number(self.{field_name(part.counter)}, {part.model.low}, {part.model.fewest})"
    valid, limited = _times(part.model.step, count), _times(
        part.model.step, f"{count}.min({part.model.most})"
    )
    return part, bits.reading(part.counter, set(), depth=3), valid, limited


def _spread_part(part: VariablePartDescription) -> dict[str, object]:
    """Return the values for a part of a message in which elements have variable-length
    arrays.
    """
    step = 1 if part.inner else part.model.step
    inner = [(inner, *_counted_bytes(inner, inner.model.step)) for inner in part.inner]
    reading, valid, limited = _counted_bytes(part, step)
    fixed = part.model.step - sum(
        inner.model.most * inner.model.step for inner in part.inner
    )
    return {
        "part": part,
        "step": step,
        "reading": reading,
        "valid": valid,
        "limited": limited,
        "inner": inner,
        "element": " + ".join(
            (*([str(fixed)] if fixed else []), *(limited for *_, limited in inner))
        ),
    }


def _counted_bytes(part: VariablePartDescription, step: int) -> tuple[str, str, str]:
    """Return the expression of the counter in a frame, and the bytes of a message for a
    valid count, and for any count.
    """
    _, reading, _, _ = _earlier_part(part)
    count = f"number(self.{field_name(part.counter)}, {part.model.low}, {part.model.fewest})"
    return reading, _times(step, count), _times(step, f"{count}.min({part.model.most})")


def _times(step: int, count: str) -> str:
    if step == 1:
        return count
    return f"{step} * ({count})" if " + " in count else f"{step} * {count}"


def imports(body: str) -> str:
    """Return the names of the support module that the body of a module uses, for its
    ``use`` statement.
    """
    names = sorted(
        _SUPPORT.intersection(_USED.findall(body)),
        key=lambda name: (name[0].isupper(), name),
    )
    return f"{{{', '.join(names)}}}" if len(names) > 1 else names[0]


def of_composite(composite: Composite[Any]) -> dict[str, object]:
    """Return the values for a message or struct."""
    fields = composite.members
    has_default = all(map(_is_default, fields))
    # Floats have no total equality, so messages with floats derive neither `Eq` nor
    # `Hash`.
    traits = [
        "Clone",
        "Copy",
        "Debug",
        *(["Default"] if has_default else []),
        "PartialEq",
    ]
    narrow = [field for field in fields if field.needs_range_check]
    return {
        "constants": _constants(composite),
        "fits": [
            line
            for field in narrow
            if not field.model.conditions
            for line in bits.fitting(field)
        ],
        "scales": [
            field for field in composite.declared_members if has_constant(field)
        ],
        "curves": [
            field for field in composite.declared_members if field.curve is not None
        ],
        "default": (
            None
            if has_default
            else elements.literal(fields, [_initial(field) for field in fields])
        ),
        "derives": ", ".join(traits + ([] if composite.has_floats else ["Eq", "Hash"])),
        "uses_enums": any(enum.node is composite.node for enum in composite.enums),
    }


def _constants(composite: Composite[Any]) -> list[tuple[Constant, str, str]]:
    """Return the constants of fields with their types and values."""
    return [
        (constant, *_constant(field, constant))
        for field in composite.declared_members
        for constant in field.constants
    ]


def _constant(field: FieldDescription, constant: Constant) -> tuple[str, str]:
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


def _length(bytes: ElementBytes) -> str:
    """Return the number of bytes for ``count`` elements."""
    elements_bytes = _times(bytes.step, "count")
    return f"{bytes.before} + {elements_bytes}" if bytes.before else elements_bytes


def _counted_text(last: VariablePartDescription) -> str:
    """Return the value of the counter for a ``text``."""
    more = last.counter_of_text
    if more < 0:
        return f"text.len().saturating_sub({-more})"
    return f"(text.len() + {more})" if more else "text.len()"


def _number(last: VariablePartDescription) -> str:
    """Return the number of elements of a variable part."""
    counter = f"self.{field_name(last.counter)}"
    return (
        f"number({counter}, {last.model.low}, {last.model.fewest})"
        if last.model.plus
        else counter
    )


def _is_default(field: FieldDescription) -> bool:
    """Return whether a derived `Default` gives the initial value of a field."""
    if field.count > DERIVES_DEFAULT or (
        field.model.is_bytes and field.size > DERIVES_DEFAULT
    ):
        return False
    return field.is_initially_zero


def _initial(field: FieldDescription) -> str:
    value = _valued(field, field.initial_raw)
    if field.is_in_last_part and field.count:
        length = field.struct.model.length if field.struct is not None else 0
        absent = (
            f"Self::{arrays.reader(field.name)}(&[0; {length}])"
            if length
            else _valued(field, 0)
        )
        few = field.initial_count if field.has_initial_value else 0
        return (
            f"first({few}, {value}, {absent})" if few else f"[{absent}; {field.count}]"
        )
    if field.model.conditions:
        return f"Some({value})" if field.is_initially_present else "None"
    return f"[{value}; {field.count}]" if field.count else value


def _valued(field: FieldDescription, raw: int) -> str:
    kind = field.model.type
    if field.struct is not None:
        return f"{struct_path(field.struct, field.message.node)}::default()"
    if field.model.is_bytes:
        return f"[0; {field.model.bits // 8}]"
    if kind == "enum":
        return f"Coded::from_raw({integer(raw)})"
    if kind == "float":
        return "0.0"
    return ("true" if raw else "false") if kind == "bool" else integer(raw)
