"""A message -> what its template needs beside the description."""

from __future__ import annotations

import re
from typing import Any

from icdgen.backends.rust import arrays, bits, conditional, elements, parts
from icdgen.backends.rust.names import field_name, integer_type, struct_path
from icdgen.backends.rust.physical import has_constant
from icdgen.backends.rust.text import double, integer
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.constants import Constant
from icdgen.describe.description import Composite, Into, VariablePartDescription
from icdgen.describe.groups import bytes_of_flags

_SUPPORT = frozenset("""
    array arrays beginning counted each element_of elements first flags longest message number power present put put_array
    put_each put_element put_rounds put_words quiet rounds spread structure take text text_array there told whole words
    Big Coded Curve Error Frame Scale Wide
    """.split())
# What is called or named in code; comments and texts come first, so that nothing is found in them.
_USED = re.compile(r'//.*|"(?:[^"\\]|\\.)*"|(?<![\w.:&])(?<!fn )([A-Za-z]\w*)(?=[(!<>]|::| = Wide)')
DERIVES_DEFAULT = 32  # elements of an array; longer ones do not


def values(message: MessageDescription) -> dict[str, object]:
    """What is read, written, derived and imported."""
    fields, tables, last = message.members, bytes_of_flags(message, bits.FLAGS_FROM), message.last_part
    readings = ["None" if field.model.when else bits.reading(field, tables) for field in fields]
    views = [(field, bits.reading(field, set(), depth=2)) for field in message.overlays]
    conditions = conditional.conditional(message)
    writings = [line for one in message.walk(Into.STRUCTS) if not one.model.when for line in bits.writing(one)]
    return {
        **of_composite(message),
        "refused": message.is_narrow or bool(conditions),
        "conditional": conditions,
        "last": last,
        "earlier": list(map(_inner, message.earlier_parts)),
        **(_of_end(message, last) if last else {}),
        "tables": sorted(tables),
        "literal": elements.literal(fields, readings),
        "views": views,
        "writings": writings,
        "repeated": list(elements.functions(message)),
        "parts": parts.parts(message),
    }


def _of_end(message: MessageDescription, last: VariablePartDescription) -> dict[str, object]:
    """What the code of frames that differ in length needs."""
    return {
        "bytes_of_end": _times(last.model.step, f"count + {last.model.fewest}" if last.model.fewest else "count"),
        "bytes_of_elements": _times(last.model.step, "count"),
        "length_of_frame": _length(last.model.shortest, last.model.step),
        "length_of_elements": _length(last.model.begin, last.model.step),
        "counted_text": _counted_text(last),
        "open_parts": [(one, _number(one)) for one in (*message.earlier_parts, last)],
    }


def _inner(part: VariablePartDescription) -> tuple[VariablePartDescription, str, str, str]:
    """What is open in front of the end, how its count is read, and its bytes: of a count that there may be, and of any."""
    count = f"number(self.{field_name(part.counter)}, {part.model.low}, {part.model.fewest})"
    there, any_count = (_times(part.model.step, one) for one in (count, f"{count}.min({part.model.most})"))
    return part, bits.reading(part.counter, set(), depth=3), there, any_count


def _times(step: int, count: str) -> str:
    if step == 1:
        return count
    return f"{step} * ({count})" if " + " in count else f"{step} * {count}"


def imports(body: str) -> str:
    """What a module uses of the support module, as its ``use`` has it; ``body`` is the rest of the module."""
    names = sorted(_SUPPORT.intersection(_USED.findall(body)), key=lambda name: (name[0].isupper(), name))
    return f"{{{', '.join(names)}}}" if len(names) > 1 else names[0]


def of_composite(one: Composite[Any]) -> dict[str, object]:
    """What is said of a message and of a struct."""
    fields = one.members
    has_default = all(map(_is_default, fields))
    traits = ["Clone", "Copy", "Debug", *(["Default"] if has_default else []), "PartialEq"]
    narrow = [field for field in fields if field.needs_range_check]
    return {
        "constants": _constants(one),
        "fits": [line for field in narrow if not field.model.when for line in bits.fitting(field)],
        "scales": [field for field in one.declared_members if has_constant(field)],
        "curves": [field for field in one.declared_members if field.curve is not None],
        "default": None if has_default else elements.literal(fields, [_initial(field) for field in fields]),
        "derives": ", ".join(traits + ([] if one.has_floats else ["Eq", "Hash"])),
        "uses_enums": any(enum.node is one.node for enum in one.enums),
    }


def _constants(one: Composite[Any]) -> list[tuple[Constant, str, str]]:
    """The constants of fields, their types and values."""
    return [(constant, *_constant(field, constant)) for field in one.declared_members for constant in field.constants]


def _constant(field: FieldDescription, one: Constant) -> tuple[str, str]:
    if one.number:
        kind = f"f{field.model.bits}"
        named = {"nan": "NAN", "inf": "INFINITY", "-inf": "NEG_INFINITY"}.get(one.number)
        return kind, f"{kind}::{named}" if named else double(float(one.number))
    if field.model.type == "bool" and one.is_raw:
        return "bool", "true" if one.value else "false"
    if isinstance(one.value, int):
        return integer_type(field), integer(one.value)
    return "f64", double(one.double)


def _length(before: int, step: int) -> str:
    """Bytes of a frame that has ``count`` elements behind so many bytes."""
    rest = _times(step, "count")
    return f"{before} + {rest}" if before else rest


def _counted_text(last: VariablePartDescription) -> str:
    """What the counter of an open text says of a ``text``, which is filled up to the fewest characters."""
    if last.model.fewest:
        return f"text.len().saturating_sub({last.model.fewest})"
    return f"(text.len() + {last.model.low})" if last.model.low else "text.len()"


def _number(last: VariablePartDescription) -> str:
    """How many elements a message has."""
    counter = f"self.{field_name(last.counter)}"
    return f"number({counter}, {last.model.low}, {last.model.fewest})" if last.model.plus else counter


def _is_default(field: FieldDescription) -> bool:
    """Whether a new message has of it what a `Default` that is derived gives."""
    if field.count > DERIVES_DEFAULT or (field.model.is_bytes and field.size > DERIVES_DEFAULT):
        return False
    return field.is_initially_zero


def _initial(field: FieldDescription) -> str:
    value = _valued(field, field.initial_raw)
    if field.is_in_last_part and field.count:
        length = field.struct.model.length if field.struct is not None else 0
        absent = f"Self::{arrays.reader(field.name)}(&[0; {length}])" if length else _valued(field, 0)
        few = field.initial_count if field.has_initial_value else 0
        return f"first({few}, {value}, {absent})" if few else f"[{absent}; {field.count}]"
    if field.model.when:
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
