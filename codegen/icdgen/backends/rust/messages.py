"""A message -> what its template needs beside the description."""

from __future__ import annotations

from typing import Any, NamedTuple

from icdgen.backends.rust import arrays, bits, conditional, constants, derived, elements, parts
from icdgen.backends.rust.names import field_name, struct_path
from icdgen.backends.rust.physical import has_constant
from icdgen.backends.rust.text import integer
from icdgen.describe import FieldDescription, MessageDescription, StructDescription
from icdgen.describe.description import Composite, TailDescription

DERIVES_DEFAULT = 32  # elements of an array; longer ones do not


def values(message: MessageDescription) -> dict[str, object]:
    """What is read, written, derived and imported."""
    fields, tables, tail = message.members, bits.flag_tables(message), message.tail
    readings = ["None" if field.model.when else bits.reading(field, tables) for field in fields]
    views = [(field, bits.reading(field, set(), depth=2)) for field in message.seen]
    conditions = conditional.conditional(message)
    writings = [line for one in message.blocks if not one.model.when for line in bits.writing(one)]
    repeated = list(elements.functions(message))
    read = [*readings, *(one.decode for one in conditions), *(reading for _, reading in views)]
    read += [one.value for one in repeated]
    written = [*writings, *(line for one in conditions for line in one.encode)]
    written += [line for one in repeated for line in one.writings]
    helpers = {one.helper for one in repeated}
    imported = {
        "array": any("array(" in reading for reading in read),
        "arrays": any("arrays(" in reading for reading in read),
        "flags": bool(tables or any(one.tables for one in repeated)),
        "message": True,
        "put": any("put!(" in line for line in written),
        "put_array": any("put_array(" in line for line in written),
        "put_each": "each" in helpers,
        "put_rounds": "rounds" in helpers,
        "put_words": any("put_words(" in line for line in written),
        "take": any("take!(" in reading for reading in read),
        "there": bool(conditions),
        "counted": tail is not None and not tail.counter.model.implied,
        "elements": tail is not None,
        "first": any(map(_has_first, fields)),
        "number": (tail is not None and bool(tail.model.plus)) or bool(message.inner),
        "longest": (tail is not None and not message.inner) or bool(message.model.may_end_early),
        **dict.fromkeys(("beginning", "spread", "told"), bool(message.inner)),
        "present": tail is not None,
        "each": "each" in helpers,
        "rounds": "rounds" in helpers,
        "words": any("words(" in reading for reading in read),
        "Coded": any(field.enum for field in message.all_fields),
        "Error": True,
        "Frame": tail is not None,
        **derived.imported(message.derived),
    }
    return {
        **_shared(message, imported),
        "refused": message.is_narrow or bool(conditions),
        "conditional": conditions,
        "tail": tail,
        "inner": [_Inner.of(one) for one in message.inner],
        "bytes_of_end": "" if tail is None else _times(tail.step, f"count + {tail.fewest}" if tail.fewest else "count"),
        "bytes_of_elements": "" if tail is None else _times(tail.step, "count"),
        "length_of_frame": "" if tail is None else _length(tail.least, tail.step),
        "length_of_elements": "" if tail is None else _length(tail.begin, tail.step),
        "counted_text": "" if tail is None else _counted_text(tail),
        "open_parts": [] if tail is None else [(one, _number(one)) for one in (*message.inner, tail)],
        "tables": sorted(tables),
        "literal": elements.literal(fields, readings),
        "views": views,
        "writings": writings,
        "repeated": repeated,
        "parts": parts.parts(message),
    }


class _Inner(NamedTuple):
    """What is open in front of the end."""

    part: TailDescription
    reading: str  # of what counts it, from ``bytes``
    bytes: str  # of it in a message
    bytes_at_most: str  # the same, of a count that there may be, or not

    @classmethod
    def of(cls, part: TailDescription) -> _Inner:
        count = f"number(self.{field_name(part.counter)}, {part.low}, {part.fewest})"
        counts = (count, f"{count}.min({part.most})")
        return cls(part, bits.reading(part.counter, set(), depth=3), *(_times(part.step, one) for one in counts))


def _times(step: int, count: str) -> str:
    if step == 1:
        return count
    return f"{step} * ({count})" if " + " in count else f"{step} * {count}"


def of_struct(struct: StructDescription) -> dict[str, object]:
    """What is derived and imported for a struct: messages read and write it."""
    imported = {
        "structure": True,
        "Coded": any(field.enum for field in struct.members),
        "Error": struct.is_narrow or any(field.has_physical for field in struct.members),
    }
    return _shared(struct, imported)


def _shared(one: Composite[Any], imported: dict[str, bool]) -> dict[str, object]:
    """What is said of a message and of a struct."""
    fields = one.members
    is_there = any(field.model.name in field.message.model.fresh for field in fields if field.model.when)
    has_default = not is_there and all(
        (field.fresh == 0 or (field.is_open and not field.message.fewest) or field.model.when) and not _is_long(field)
        for field in fields
    )
    has_default = has_default and not any(
        field.struct is not None and field.is_open and any(one.fresh for one in field.struct.fields) for field in fields
    )
    traits = ["Clone", "Copy", "Debug", *(["Default"] if has_default else []), "PartialEq"]
    narrow = [field for field in fields if (field.struct or field).is_narrow]
    scales = [field for field in one.all_members if has_constant(field)]
    has_text = any(field.is_text for field in fields)
    has_elements = any(field.count and field.is_scaled for field in fields)
    has_texts = any(field.count and field.is_text for field in fields)
    curves = [field for field in one.all_members if field.curve is not None]
    imported |= {
        "element_of": has_elements,
        "put_element": has_texts or any(field.count and field.is_scaled and field.is_set for field in fields),
        "text": has_text,
        "text_array": has_text,
        "Big": one.has_wide_steps,
        "Curve": bool(curves),
        "Scale": any(field.steps is None or not field.steps.is_wide for field in scales),
        "Wide": one.has_wide_steps,
    }
    names = sorted((name for name, is_used in imported.items() if is_used), key=lambda name: (name[0].isupper(), name))
    return {
        "constants": constants.of_fields(one),
        "fits": [line for field in narrow if not field.model.when for line in bits.fitting(field)],
        "scales": scales,
        "curves": curves,
        "default": None if has_default else elements.literal(fields, [_fresh(field) for field in fields]),
        "derives": ", ".join(traits + ([] if one.has_floats else ["Eq", "Hash"])),
        "imports": f"{{{', '.join(names)}}}" if len(names) > 1 else names[0],
        "uses_enums": any(enum.node is one.node for enum in one.enums),
    }


def _length(before: int, step: int) -> str:
    """Bytes of a frame that has ``count`` elements behind so many bytes."""
    rest = "count" if step == 1 else f"{step} * count"
    return f"{before} + {rest}" if before else rest


def _counted_text(tail: TailDescription) -> str:
    """What the counter of an open text says of a ``text``, which is filled up to the fewest characters."""
    if tail.fewest:
        return f"text.len().saturating_sub({tail.fewest})"
    return f"(text.len() + {tail.low})" if tail.low else "text.len()"


def _number(tail: TailDescription) -> str:
    """How many elements a message has."""
    counter = f"self.{field_name(tail.counter)}"
    return f"number({counter}, {tail.low}, {tail.fewest})" if tail.model.plus else counter


def _is_long(field: FieldDescription) -> bool:
    """Whether it is an array that has no `Default`."""
    if field.count > DERIVES_DEFAULT:
        return True
    return field.model.is_bytes and field.model.bits > DERIVES_DEFAULT * 8


def _fresh(field: FieldDescription) -> str:
    if field.is_open and field.count:
        length = field.struct.model.length if field.struct is not None else 0
        absent = f"Self::{arrays.reader(field.name)}(&[0; {length}])" if length else _zero(field)
        return (
            f"first({field.message.fewest}, {_one_fresh(field)}, {absent})"
            if _has_first(field)
            else f"[{absent}; {field.count}]"
        )
    if field.model.when:
        is_there = field.model.name in field.message.model.fresh
        return f"Some({_one_fresh(field)})" if is_there else "None"
    return f"[{_one_fresh(field)}; {field.count}]" if field.count else _one_fresh(field)


def _has_first(field: FieldDescription) -> bool:
    """Whether a new message has elements of an open end that are not 0."""
    fields = field.struct.fields if field.struct is not None else (field,)
    return field.is_open and field.message.fewest > 0 and any(one.fresh for one in fields)


def _one_fresh(field: FieldDescription) -> str:
    return _valued(field, field.fresh)


def _zero(field: FieldDescription) -> str:
    """An element that is not in the frame."""
    return _valued(field, 0)


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
