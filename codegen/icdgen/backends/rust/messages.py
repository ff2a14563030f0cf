"""A message -> everything that its module says, as finished strings."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.rust import bits, constants, names
from icdgen.backends.rust.accessors import Accessors, accessors
from icdgen.backends.rust.text import assigned, doc, integer, prose, string
from icdgen.describe import FieldDescription, MessageDescription
from icdgen.describe.comments import words

DERIVES_DEFAULT = 32  # elements of an array; longer ones do not


class Checked(NamedTuple):
    """The support module's entry of a scaled or narrow field."""

    name: str
    field: str
    type: str
    min: str
    max: str
    factor: str
    offset: str
    divisor: str


class FieldRow(NamedTuple):
    """A field of the struct."""

    doc: str
    declaration: str
    serde: bool  # whether serde needs help with it
    reading: str
    writing: list[str]


class MessageRow:
    """What the template of a message is given."""

    def __init__(self, message: MessageDescription, id_type: str) -> None:
        one, fields = message.model, message.fields
        self.type = names.type_name(message)
        self.doc = doc(map(prose, message.comment.paragraphs))
        self.head = doc([f"{prose(words(one.name))}, a message of node `{message.node.name}`."], mark="//!")
        self.name = string(one.name)
        self.length = one.length
        self.constants = constants.of_message(message, id_type)
        tables = bits.flag_tables(message)
        self.tables = sorted(tables)
        self.fields = [_row(field, tables) for field in fields]
        self.fits = [bits.fitting(field) for field in fields if field.is_narrow]
        self.scaled: list[Accessors] = [accessors(field) for field in fields if field.steps is not None]
        self.checked = [_checked(field) for field in fields if field.steps is not None or field.is_narrow]
        self.telecommand_id, self.telemetry_id = _byte(one.telecommand_id), _byte(one.telemetry_id)
        self.literal = _literal([(field.name, row.reading) for field, row in zip(fields, self.fields, strict=True)])
        zeros = all(f.fresh == 0 and (f.model.type != "bytes" or f.model.bits <= DERIVES_DEFAULT * 8) for f in fields)
        self.default = None if zeros else _literal([(field.name, _fresh(field)) for field in fields])
        derived = ["Clone", "Copy", "Debug", *(["Default"] if zeros else []), "PartialEq"]
        self.derives = ", ".join(derived + ([] if message.has_floats else ["Eq", "Hash"]))
        self.imports = _imports(self, any(field.enum for field in fields))
        self.uses_enums = any(field.enum is not None and field.enum.node is message.node for field in fields)


def _byte(id: int | None) -> int | None:
    """The id under which a client knows the message: one of a byte."""
    return id if id is not None and id < 256 else None


def _row(field: FieldDescription, tables: set[int]) -> FieldRow:
    return FieldRow(
        doc=doc(map(prose, field.comment.paragraphs), "    "),
        declaration=assigned(f"pub {field.name}:", names.raw_type(field), ","),
        serde=field.model.type == "bytes",
        reading=bits.reading(field, tables),
        writing=bits.writing(field),
    )


def _fresh(field: FieldDescription) -> str:
    kind = field.model.type
    if kind == "bytes":
        return f"[0; {field.model.bits // 8}]"
    if kind == "enum":
        return f"Coded::from_raw({integer(field.fresh)})"
    if kind == "float":
        return "0.0"
    return ("true" if field.fresh else "false") if kind == "bool" else integer(field.fresh)


def _literal(rows: list[tuple[str, str]]) -> str:
    """``Self { ... }`` in the body of a function."""
    lines = "".join(f"            {name}: {value},\n" for name, value in rows)
    return f"        Self {{\n{lines}        }}" if rows else "        Self {}"


def _checked(field: FieldDescription) -> Checked:
    one = field.model
    terms = field.steps.terms if field.steps is not None else (1, 0, 1)
    kind, ends = names.integer_type(field), (integer(one.raw_min), integer(one.raw_max))
    return Checked(field.name.upper(), string(one.name), kind, *ends, *map(integer, terms))


def _imports(row: MessageRow, coded: bool) -> str:
    reading = "".join(field.reading for field in row.fields)
    writing = "".join(line for field in row.fields for line in field.writing)
    wanted = [
        ("array", "array(" in reading),
        ("flags", bool(row.tables)),
        ("put", "put!(" in writing),
        ("put_array", "put_array(" in writing),
        ("take", "take!(" in reading),
        ("Coded", coded),
        ("Error", True),
        ("Scale", bool(row.checked)),
    ]
    names = [name for name, is_used in wanted if is_used]
    return f"{{{', '.join(names)}}}" if len(names) > 1 else names[0]
