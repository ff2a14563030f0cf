"""A message -> everything that its module says, as finished strings."""

from __future__ import annotations

from typing import NamedTuple

from icdgen.backends.rust import comments, constants, fields, names, scales
from icdgen.backends.rust.names import Enums
from icdgen.backends.rust.text import LITERAL_WIDTH, WIDTH, doc, implementation, integer, prose, rhs, signature, string
from icdgen.icd.model import Field, Message, Node


class Scaled(NamedTuple):
    """The physical accessors of a field."""

    getter: str  # name
    setter: str
    doc: str
    set_doc: str
    signature: str
    body: str
    set_signature: str
    set_body: str


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


class Role(NamedTuple):
    """What a client does with the message."""

    id: int
    implementation: str


class FieldRow(NamedTuple):
    """A field of the struct."""

    model: Field
    name: str
    constant: str
    type: str
    doc: str
    declaration: str
    serde: bool  # whether serde needs help with it
    reading: str
    writing: list[str]
    default: str


class MessageRow:
    """What the template of a message is given."""

    def __init__(self, message: Message, node: Node, enums: Enums, id_type: str) -> None:
        self.message, self.node = message, node
        self.type = names.type_name(message, node)
        self.module = names.file_name(message, node)
        self.doc = doc(comments.message(message))
        self.head = doc([f"{prose(message.name)}, a message of node `{node.name}`."], mark="//!")
        self.name = string(message.name)
        self.length = message.length
        self.ids = constants.ids(message, id_type)
        tables = fields.flag_tables(message.fields, node)
        self.tables = sorted(tables)
        self.fields = [_row(field, node, enums, tables) for field in message.fields]
        narrow = [fields.is_narrow(field, enums) for field in message.fields]
        self.fits = [
            line
            for row, thin in zip(self.fields, narrow, strict=True)
            if thin
            for line in fields.fitting(row.model, row.name, row.constant)
        ]
        self.scaled = [_scaled(row) for row in self.fields if row.model.scale is not None]
        self.sent, self.received = _roles(message, self.type)
        self.checked = [
            _checked(row, enums) for row, thin in zip(self.fields, narrow, strict=True) if thin or row.model.scale
        ]
        self.constants = [
            one for field in message.fields if constants.has_some(field) for one in constants.of_field(field, node)
        ]
        self.literal = _literal([(row.name, row.reading) for row in self.fields])
        plain = all(
            row.model.const in (None, 0) and (row.model.type != "bytes" or row.model.bits <= 256) for row in self.fields
        )
        self.default = None if plain else _literal([(row.name, row.default) for row in self.fields])
        floats = any(field.type == "float" for field in message.fields)
        derived = (
            ["Clone", "Copy", "Debug"]
            + (["Default"] if plain else [])
            + ["PartialEq"]
            + ([] if floats else ["Eq", "Hash"])
        )
        self.derives = ", ".join(derived)
        self.floats = floats
        self.imports = _imports(self)
        self.uses_enums = any(
            f"{names.ENUMS_MODULE}::" in row.type and "crate::" not in row.type for row in self.fields
        )


def _roles(message: Message, type_: str) -> tuple[Role | None, Role | None]:
    """The message as one that a client sends, and as one that it requests; None if an id is no byte."""
    found = []
    for trait, id in (("Telecommand", message.telecommand_id), ("Telemetry", message.telemetry_id)):
        there = id is not None and id < 256
        found.append(Role(id, implementation(f"crate::wire::{trait}", type_)) if there else None)
    return found[0], found[1]


def _row(field: Field, node: Node, enums: Enums, tables: set[int]) -> FieldRow:
    name = names.field_name(field, node)
    constant = name.upper()
    kind = fields.raw_type(field, node, enums)
    return FieldRow(
        model=field,
        name=name,
        constant=constant,
        type=kind,
        doc=doc(comments.field(field), "    "),
        declaration=rhs("    ", f"pub {name}:", kind, ","),
        serde=field.type == "bytes",
        reading=fields.reading(field, node, enums, tables),
        writing=fields.writing(field, node, enums, name),
        default=_default(field, kind),
    )


def _default(field: Field, kind: str) -> str:
    if field.type == "bytes":
        return f"[0; {field.bits // 8}]"
    value = field.const or 0
    if field.type == "enum":
        return f"Coded::from_raw({integer(value)})"
    if field.type == "float":
        return "0.0"
    return ("true" if value else "false") if field.type == "bool" else integer(value)


def _literal(rows: list[tuple[str, str]]) -> str:
    """``Self { ... }`` in the body of a function."""
    if not rows:
        return "        Self {}"
    inline = ", ".join(f"{name}: {value}" for name, value in rows)
    if len(inline) <= LITERAL_WIDTH and "\n" not in inline:
        return f"        Self {{ {inline} }}"
    statements, rows = _hoisted(rows)
    lines = [rhs("            ", f"{name}:", value, ",") for name, value in rows]
    return "\n".join((*statements, "        Self {", *lines, "        }"))


def _hoisted(rows: list[tuple[str, str]]) -> tuple[list[str], list[tuple[str, str]]]:
    """Statements that bind what is too long for its line of the literal, and the rows of the literal."""
    statements, kept = [], []
    for index, (name, value) in enumerate(rows):
        if "\n" not in value and len(name) + len(value) + 15 > WIDTH:
            statements.append(f"        let value_{index} = {value};")
            value = f"value_{index}"
        kept.append((name, value))
    return statements, kept


def _scaled(row: FieldRow) -> Scaled:
    field, name = row.model, row.name
    getter = names.physical_name(field, name)
    unit = f" in {prose(field.unit.symbol)}" if field.unit else ", as a physical value"
    span = scales.physical_range(field.scale, field.raw_min, field.raw_max)
    setter = f"set_{getter}"
    source, before = f"self.{name}", ""
    if len(name) > fields.LONG_NAME:
        source, before = "raw", "\n".join((rhs("        ", "let raw =", f"self.{name}", ";"), ""))
    set_body = f"        self.{name} = {row.constant}.raw(value)?;"
    if len(set_body) > WIDTH - 10:
        set_body = f"        let raw = {row.constant}.raw(value)?;\n        self.{name} = raw;"
    return Scaled(
        getter,
        setter,
        doc([f"{prose(field.name)}{unit}: {span}."], "    "),
        doc([f"Sets {prose(field.name)}{unit}, to the nearest raw value, ties to even."], "    "),
        signature(f"pub fn {getter}", ("&self",), "f64"),
        f"{before}        {scales.getter(field, source, row.constant)}",
        signature(f"pub fn {setter}", ("&mut self", "value: f64"), "Result<(), Error>"),
        set_body,
    )


def _checked(row: FieldRow, enums: Enums) -> Checked:
    field = row.model
    line = scales.linear(field.scale)
    kind = f"u{enums.storage(field.enum)}" if field.type == "enum" else names.integer_type(field)
    low, high = integer(field.raw_min), integer(field.raw_max)
    return Checked(row.constant, string(field.name), kind, low, high, *map(integer, line))


def _imports(row: MessageRow) -> str:
    wanted = []
    if any("array(" in one.reading for one in row.fields):
        wanted.append("array")
    if row.tables:
        wanted.append("flags")
    for name, call in (("put", "put!("), ("put_array", "put_array(")):
        if any(call in line for one in row.fields for line in one.writing):
            wanted.append(name)
    if any("take!(" in one.reading for one in row.fields):
        wanted.append("take")
    if any(one.model.type == "enum" for one in row.fields):
        wanted.append("Coded")
    wanted.append("Error")
    if row.checked:
        wanted.append("Scale")
    return f"{{{', '.join(wanted)}}}" if len(wanted) > 1 else wanted[0]
